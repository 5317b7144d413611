// SPDX-License-Identifier: MIT
// What the refinement may find, and which corrections are asked for.
#pragma once

#include <cstdint>

#include "core/base/arm.hpp"

namespace armsig::calibration {

enum class ParameterKind : std::uint8_t {
  kAxisDirection,   // rotation of the axis about x, y of its link frame [rad]
  kAxisPosition,    // shift of the axis along x, y of its link frame [m]; revolute only
  kReadingGain,     // ReadingCorrection::gain
  kReadingFirst,    // ReadingCorrection::cos_1, sin_1 [rad]
  kReadingSecond,   // ReadingCorrection::cos_2, sin_2 [rad]
  kTarget,          // target point along x, y, z of the sensor frame [m]
  kReceiverOffset,  // constant added to every range of a receiver [m]
  kScale,           // relative error of every length measured
};

struct Parameter {
  ParameterKind kind = ParameterKind::kAxisDirection;
  std::uint8_t index = 0;      // of the joint, target or receiver; 0 for kScale
  std::uint8_t component = 0;  // x, y, z; or cosine, sine
};

// Whether it is a ReadingCorrection's.
[[nodiscard]] inline bool of_reading(const Parameter& parameter) {
  return parameter.kind == ParameterKind::kReadingGain ||
         parameter.kind == ParameterKind::kReadingFirst ||
         parameter.kind == ParameterKind::kReadingSecond;
}

// Which corrections of the readings are asked for, per joint.
struct ReadingTerms {
  bool gain = false;
  bool first = false;   // revolute only; ignored otherwise
  bool second = false;  // revolute only; ignored otherwise
};

struct ParameterRequest {
  FixedVector<ReadingTerms, kMaxJoints> readings;  // none, or one per joint
  bool receiver_offsets = false;
  bool scale = false;
};

}  // namespace armsig::calibration
