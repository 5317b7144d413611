// SPDX-License-Identifier: MIT
// The pseudo Denavit-Hartenberg rows of a signature for formats that hold nothing else, with what
// stands before and after them, checked against the axes.
#pragma once

#include "core/base/arm.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

// Pose of the last link's frame in the sensor frame: X_S0 prod A_i(q_i) X_FL.
struct StandardRows {
  DhRows rows;
  Pose X_S0;  // frame 0 in the sensor frame
  Pose X_FL;  // the frame that `armsig predict` answers for, in Denavit-Hartenberg frame n
};

// Refuses where the product differs from the axes by more than kExportTolerance_m: axes so nearly
// parallel that no Denavit-Hartenberg row in double precision holds them.
[[nodiscard]] Read<StandardRows> standard_rows(std::string_view format,
                                               const SignatureRecord& record);

// One row of the modified convention of Craig (Introduction to Robotics, 3.4):
//   A = Rot(x, alpha_prev) Trans(a_prev, 0, 0) Rot(z, theta) Trans(0, 0, d).
struct ModifiedRow {
  JointType type = JointType::kRevolute;
  double alpha_prev_rad = 0;
  double a_prev_m = 0;
  double theta_rad = 0;
  double d_m = 0;
};

// The same product with its factors grouped the other way: alpha and a of a standard row belong to
// the modified row after it, those of the last one to what follows.
struct ModifiedRows {
  FixedVector<ModifiedRow, kMaxJoints> rows;
  Pose X_S0;
  Pose X_FL;
};
[[nodiscard]] ModifiedRows modified_rows(const StandardRows& standard);

}  // namespace armsig::tool
