// SPDX-License-Identifier: MIT
// From what the encoders read to how far the joints have turned: coupled joints, and the errors of
// a reading that repeat with it (docs/model.md, section 5).
#pragma once

#include <array>
#include <cstdint>

#include "core/base/arm.hpp"
#include "core/calibration/parameter.hpp"

namespace armsig::calibration {
struct ArmModel;
}

namespace armsig::calibration {

// Periodic and proportional errors of one joint's reading. The true motion of the joint is
//   q + gain q + cos_1 cos q + sin_1 sin q + cos_2 cos 2q + sin_2 sin 2q,
// q the coupled reading: gain of a wrong gear ratio or pitch, first order of an eccentric encoder
// disc, second order of an elliptic one. Unitless gain, radians for the rest (revolute joints
// only).
struct ReadingCorrection {
  double gain = 0;
  double cos_1 = 0;
  double sin_1 = 0;
  double cos_2 = 0;
  double sin_2 = 0;
};

// Which of these a parameter is, and by how much the joint turns or shifts by one unit of it at its
// coupled reading. Precondition: of_reading(parameter).
[[nodiscard]] double ReadingCorrection::* term_of(const Parameter& parameter);
[[nodiscard]] double turn_by(const Parameter& parameter, double coupled);

struct ReadingModel {
  JointCouplings couplings;
  FixedVector<ReadingCorrection, kMaxJoints> corrections;  // none, or one per joint
  // Gravity and the joint error maps, kept by whoever made this; null: none.
  const ArmModel* deflections = nullptr;
};

// By how much the joints turn beyond their corrected readings at encoder readings `readings`.
using Deflections = std::array<double, kMaxJoints>;
[[nodiscard]] Deflections deflections_at(const ReadingModel& model, const JointVector& readings);

[[nodiscard]] double corrected(const ReadingCorrection& correction, double coupled);

// The motion of joint `joint` that its effective reading `coupled` stands for, corrections applied.
[[nodiscard]] inline double corrected_reading(const ReadingModel& model, std::size_t joint,
                                              double coupled) {
  return model.corrections.empty() ? coupled : corrected(model.corrections[joint], coupled);
}

// The readings by which the axes of a signature turn: coupled and corrected, so that they are
// `configuration` (effective readings) where the encoders read the signature configuration. The
// axes hold what the corrections are there.
[[nodiscard]] JointVector true_readings(const ReadingModel& model, const JointVector& configuration,
                                        const JointVector& readings);

// The readings at which true_readings() gives `turned`; exact for corrections and slopes of
// deflections below 0.1.
[[nodiscard]] JointVector encoder_readings(const ReadingModel& model,
                                           const JointVector& configuration,
                                           const JointVector& turned);

}  // namespace armsig::calibration
