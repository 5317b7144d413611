// SPDX-License-Identifier: MIT
// Gravity and joint error maps of a Puma: waves of one, five and thirty a turn in every joint,
// 0.02 degrees together, and weights that let shoulder and elbow sag by half a millimetre.
#pragma once

#include <cmath>

#include "core/calibration/packed_deflections.hpp"
#include "firmware/paper_arms/paper_arms.hpp"

namespace armsig::test {

inline calibration::ArmModel bent_puma_model() {
  const Arm drawing = tool::puma560();
  calibration::ArmModel model = calibration::model_of(drawing, {});
  model.gravity.push_back({1, 4, 8e-4});
  model.gravity.push_back({2, 4, 6e-4});
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    calibration::JointModel& joint = model.joints[i];
    joint.domain = calibration::map_domain(joint.type, drawing.limits[i]);
    for (const double waves : {1.0, 5.0, 30.0}) {
      for (std::size_t k = 0; k < calibration::kKnots; ++k) {
        const double turns = static_cast<double>(k) / calibration::kKnots;
        joint.map[k] += radians(0.02) / 3 / calibration::map_unit(joint.type) *
                        std::sin(2 * kPi * waves * turns + static_cast<double>(i));
      }
    }
  }
  return model;
}

inline calibration::PackedDeflections bent_puma() { return packed(bent_puma_model()); }

}  // namespace armsig::test
