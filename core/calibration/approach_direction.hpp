// SPDX-License-Identifier: MIT
// From which side each joint came to where it stands: what its backlash depends on.
#pragma once

#include <cstdint>

#include "core/base/arm.hpp"

namespace armsig::calibration {

class ApproachDirection {
 public:
  // The next place of the arm. A joint that moves less than its backlash may take keeps its side
  // only where it does not move at all; before the first move of a joint its side is not known.
  void go_to(const JointTypes& types, const JointVector& readings);
  // It has been elsewhere since.
  void forget() { *this = {}; }

  // Bit i of sided() is set where the side of joint i is known; of sides(), where its reading grew.
  [[nodiscard]] std::uint8_t sides() const { return sides_; }
  [[nodiscard]] std::uint8_t sided() const { return sided_; }

 private:
  JointVector last_;
  std::uint8_t sides_ = 0;
  std::uint8_t sided_ = 0;
};

}  // namespace armsig::calibration
