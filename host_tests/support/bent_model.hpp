// SPDX-License-Identifier: MIT
// An arm that gives way and whose readings are wrong, at random.
#pragma once

#include <cmath>

#include "core/base/pose.hpp"
#include "core/calibration/model.hpp"
#include "host_tests/support/random.hpp"

namespace armsig::test {

// Waves of up to thirty a turn in every joint, and all levers that the drawing can tell apart.
inline calibration::ArmModel bent_model(const Arm& arm, Random& random) {
  constexpr double kMap = radians(0.02);
  constexpr double kSag = 5e-4;  // rad per m of lever
  calibration::ArmModel model = calibration::model_of(arm, {});
  calibration::choose_gravity_terms(arm, model);
  for (calibration::GravityTerm& term : model.gravity) {
    term.coefficient = random.uniform(-kSag, kSag);
  }
  for (calibration::JointModel& joint : model.joints) {
    const double amplitude = (joint.type == JointType::kRevolute ? kMap : 2e-4);
    for (const double waves : {1.0, 5.0, 30.0}) {
      const double size =
          random.uniform(0.2, 1) * amplitude / 3 / calibration::map_unit(joint.type);
      const double phase = random.uniform(0, 6);
      for (std::size_t k = 0; k < calibration::kKnots; ++k) {
        joint.map[k] +=
            size * std::sin(waves * 2 * kPi * static_cast<double>(k) / calibration::kKnots + phase);
      }
    }
  }
  return model;
}

}  // namespace armsig::test
