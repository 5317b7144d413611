// SPDX-License-Identifier: MIT
// A signature file says some things twice, for the people and programs that read it. This is where
// the two must agree.
#pragma once

#include <string_view>

#include "core/signature.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

// The base pose against link frame 0 (1e-9 m, 1e-9 rad), and the pseudo-DH model (21) at the
// signature configuration against the last link frame:
//   X_Sn = X_S0 A_1 ... A_n Rot(z, gamma_n) Trans(0, 0, b_n)
// within 1e-5 m and 1e-5 rad: snapping an axis that is parallel within 1e-7 rad moves the end of a
// long arm by a micrometre.
[[nodiscard]] Read<void> check_agreement(const Signature& signature, const Pose& X_S0);

// Does `text` read YYYY-MM-DDThh:mm:ssZ?
[[nodiscard]] bool is_utc_time(std::string_view text);

}  // namespace armsig::tool
