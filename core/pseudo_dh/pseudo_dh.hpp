// SPDX-License-Identifier: MIT
// The pseudo Denavit-Hartenberg model: section 3.2.4 of the paper.
//
// Its product (21) is the pose of Denavit-Hartenberg frame n in link frame 0 of the S-Model at any
// readings. Near parallel axes only the product is meaningful: a tilt of a microradian moves d by
// d / sin(alpha) times that, 3 cm in robot 1 of Table 2 and 2 mm in robot 2.
#pragma once

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/s_model/s_model.hpp"

namespace armsig::pseudo_dh {

// One row a joint from the S-Model at the signature configuration: (9)-(12), the offset (19) in
// theta of a revolute joint and in d of a prismatic one, joint 1 by (22)-(23). theta in (-pi, pi].
// Precondition: as many types and readings as parameters.
[[nodiscard]] DhRows from_s_model(const FixedVector<s_model::Parameters, kMaxJoints>& s_model,
                                  const JointTypes& types, const JointVector& configuration);

// Pose of S-Model link frame L of a link in its Denavit-Hartenberg frame F: Rot(z, gamma)
// Trans(0, 0, b), the last two factors of (5). With it, X_SL(n) = X_SL(0) * (21) * X_FL(n).
[[nodiscard]] Pose link_frame_in_dh_frame(const s_model::Parameters& parameters);

}  // namespace armsig::pseudo_dh
