// SPDX-License-Identifier: MIT
// From which sides the joints came to where they stand.
#pragma once

#include "core/base/arm.hpp"
#include "firmware/self_calibration/play.hpp"

namespace armsig::controller {

class Coming {
 public:
  // The next place of the arm. A joint that moves less than its play may take keeps its side only
  // where it does not move at all; before the first move of a joint nobody knows its side.
  void go_to(const JointTypes& types, const JointVector& readings);
  // It has been elsewhere since.
  void forget() { *this = {}; }

  // Bit i of `sided` set: that of joint i is known; of `sides`: its reading grew.
  [[nodiscard]] Sides sides() const { return sides_; }
  [[nodiscard]] Sides sided() const { return sided_; }

 private:
  JointVector last_;
  Sides sides_ = 0;
  Sides sided_ = 0;
};

}  // namespace armsig::controller
