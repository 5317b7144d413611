// SPDX-License-Identifier: MIT
// A signature file as a model of an arm: its targets, its servo chain.
#pragma once

#include <optional>
#include <string>

#include "core/kinematics/chain.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

// The target of that number, nothing where no number is asked for, or which numbers there are.
[[nodiscard]] Read<std::optional<Target>> find_target(const SignatureRecord& record,
                                                      const std::string& file,
                                                      std::optional<int> number);

// The pseudo Denavit-Hartenberg chain of a signature, with the joint limits of the drawing: those
// of a coupled joint as wide as its effective reading gets.
[[nodiscard]] kinematics::Chain chain_of_record(const SignatureRecord& record);

// Pose of the point asked for in Denavit-Hartenberg frame n of `chain`: the target with the
// orientation of the last link's frame, or that frame. Precondition: the target is on the last
// link.
[[nodiscard]] Pose point_in_last_frame(const SignatureRecord& record,
                                       const kinematics::Chain& chain,
                                       const std::optional<Target>& target);

}  // namespace armsig::tool
