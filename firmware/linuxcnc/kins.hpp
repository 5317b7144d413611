// SPDX-License-Identifier: MIT
// Forward and inverse kinematics in LinuxCNC's words: joints in degrees or millimetres as the
// encoders read, world coordinates in millimetres and fixed-axis angles in degrees, of a point of
// the last link in the arm's base frame.
//
// Nothing is kept between calls: LinuxCNC asks for end points of moves in between.
#pragma once

#include <span>
#include <string_view>

#include "core/calibration/servo_inverse.hpp"
#include "firmware/linuxcnc/kins_model.hpp"

namespace armsig::linuxcnc {

struct WorldPose {
  Vector3 p_mm = Vector3::Zero();
  Vector3 abc_deg = Vector3::Zero();  // R = Rot(z, C) Rot(y, B) Rot(x, A)
};

struct KinsAnswer {
  // Why the pose is not met; empty where it is. An arm of fewer than six joints meets a pose whose
  // place it meets, with the orientation as near as its joints allow (core/kinematics/inverse.hpp).
  std::string_view refusal;
  // The manipulability without units (core/kinematics/regularity.hpp): about 1 at best, 0 at a
  // singularity.
  double regularity = 0;
  // The angle by which an arm of fewer than six joints misses the orientation; 0 where it is
  // refused.
  double missed_rad = 0;
};

class Kins {
 public:
  // `p_nT`: the point of the last link that the poses are of, in frame n of the model's rows; its
  // orientation is that of the last link's frame. Precondition: a model that parse_kins() gave.
  Kins(const KinsModel& model, const Vector3& p_nT);

  [[nodiscard]] std::size_t joint_count() const { return count_; }

  // False, with `pose` untouched, where a joint's value is not finite.
  // Precondition: `joints` has joint_count() entries or more (also below).
  [[nodiscard]] bool forward(std::span<const double> joints, WorldPose& pose) const;

  // `joints`: where the arm is; set to the solution near it where the pose is met, else untouched.
  [[nodiscard]] KinsAnswer inverse(const WorldPose& pose, std::span<double> joints) const;

 private:
  [[nodiscard]] JointVector effective_of(std::span<const double> joints) const;
  [[nodiscard]] bool inside_limits(const JointVector& readings) const;

  std::size_t count_;
  Arm arm_;
  calibration::ServoReadings readings_;
  kinematics::Chain chain_;
  Pose X_nT_;
  Pose X_Tn_;
};

}  // namespace armsig::linuxcnc
