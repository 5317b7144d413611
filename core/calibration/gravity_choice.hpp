// SPDX-License-Identifier: MIT
// choose_gravity_terms() a bounded step at a time, for those who have a tick to keep.
#pragma once

#include "core/base/links.hpp"
#include "core/calibration/model.hpp"

namespace armsig::calibration {

// Of the levers of one joint: sums over poses of the products of those of two origins.
using LeverSquares = std::array<std::array<double, kMaxFrames>, kMaxFrames>;

class GravityChoice {
 public:
  // Both outlive it; `model` is of `arm`, and loses the terms that it has. At most `most` are set,
  // those of the joints next to the base.
  GravityChoice(const Arm& arm, ArmModel& model, std::size_t most = kMaxGravityTerms);

  // A joint's levers at ten poses: of six joints some 60,000 instructions of a microcontroller.
  // False: all terms are set.
  bool step();

 private:
  void add_pose(const JointTypes& types);

  const Arm& arm_;
  ArmModel& model_;
  std::size_t most_;
  std::size_t joint_ = 0;
  int poses_ = 0;  // of this joint
  LeverSquares squares_{};
};

}  // namespace armsig::calibration
