// SPDX-License-Identifier: MIT
// How far the joints of a simulated arm turn that has maps, gravity and play.
#pragma once

#include <memory>

#include "firmware/formats/problem.hpp"
#include "firmware/virtual_cabinet/bent_arm.hpp"

namespace armsig::tool {

// cabinet::bent_model(); null where nothing bends. Refuses what no signature file could tell.
[[nodiscard]] Read<std::shared_ptr<const calibration::ArmModel>> bounded_bends(
    const Arm& drawing, const cabinet::Bends& bends, simulated::Random& random);

// Play leaves each joint on the side that it came from.
class BentJoints {
 public:
  BentJoints() = default;  // as the readings say
  BentJoints(std::shared_ptr<const calibration::ArmModel> model, double play_rad)
      : model_(std::move(model)), play_rad_(play_rad) {}

  // Readings that have the arm where it is when its encoders read `readings`, after where the call
  // before had it.
  [[nodiscard]] JointVector turned(const JointVector& readings);

 private:
  std::shared_ptr<const calibration::ArmModel> model_;
  double play_rad_ = 0;
  JointVector before_;
  std::array<double, kMaxJoints> side_{};  // 1: reached upwards, -1: downwards
};

}  // namespace armsig::tool
