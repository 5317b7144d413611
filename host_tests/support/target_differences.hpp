// SPDX-License-Identifier: MIT
// Speed, acceleration and jerk as the drives are asked for them: differences of targets, a tick
// apart.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <gtest/gtest.h>

#include "firmware/controller/configuration.hpp"

namespace armsig::test {

class TargetDifferences {
 public:
  TargetDifferences(const JointVector& at_rest, double period_s) : period_s_(period_s) {
    former_.fill(at_rest);
    for (JointVector& most : most_) most.resize(at_rest.size());
  }

  void add(const JointVector& q) {
    for (std::size_t i = 0; i < q.size(); ++i) {
      const double first = q[i] - former_[0][i];
      const double second = q[i] - 2 * former_[0][i] + former_[1][i];
      const double third = q[i] - 3 * former_[0][i] + 3 * former_[1][i] - former_[2][i];
      most_[0][i] = std::max(most_[0][i], std::abs(first) / period_s_);
      most_[1][i] = std::max(most_[1][i], std::abs(second) / std::pow(period_s_, 2));
      most_[2][i] = std::max(most_[2][i], std::abs(third) / std::pow(period_s_, 3));
    }
    former_ = {q, former_[0], former_[1]};
  }

  [[nodiscard]] double speed(std::size_t joint) const { return most_[0][joint]; }
  [[nodiscard]] double acceleration(std::size_t joint) const { return most_[1][joint]; }
  [[nodiscard]] double jerk(std::size_t joint) const { return most_[2][joint]; }

  // What a difference of order `order` is uncertain by where each target is by `target`: the sum of
  // the binomial coefficients is 2^order.
  [[nodiscard]] double uncertainty(int order, double target) const {
    return std::ldexp(target, order) / std::pow(period_s_, order);
  }

  // No joint was asked for more than its limits; each target is uncertain by `target`.
  void expect_within(const controller::MotionLimits& limits, double target) const {
    for (std::size_t i = 0; i < most_[0].size(); ++i) {
      EXPECT_LE(speed(i), limits.speed[i] + uncertainty(1, target)) << "joint " << i;
      EXPECT_LE(acceleration(i), limits.acceleration[i] + uncertainty(2, target)) << "joint " << i;
    }
  }

 private:
  double period_s_;
  std::array<JointVector, 3> former_;  // the last one first
  std::array<JointVector, 3> most_;
};

// What a target within a turn is rounded by.
inline constexpr double kTargetRounding = 8 * std::numeric_limits<double>::epsilon();

}  // namespace armsig::test
