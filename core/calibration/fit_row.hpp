// SPDX-License-Identifier: MIT
// One measured position or range as the engine keeps it, and the poses that rows belong to.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::calibration {

inline constexpr std::uint8_t kNoReceiver = 255;

// The measured rows that one row of a fit stands for: neighbours of a long log. Where there is no
// memory for long logs, each row stands for itself.
#ifdef ARMSIG_SINGLE_ROWS
inline constexpr bool kMergesRows = false;
struct MergedRows {
  static constexpr std::uint32_t count = 1;
  static constexpr double scatter_m2 = 0;
};
#else
inline constexpr bool kMergesRows = true;
struct MergedRows {
  std::uint32_t count = 1;
  double scatter_m2 = 0;  // the sum of their squared distances from where the row puts them
};
#endif

struct FitRow {
  JointVector readings;           // as read
  Vector3 p_S = Vector3::Zero();  // measured; of a range: the way from the receiver, of length one
  double range_m = 0;             // measured, of a range
  // Measured minus predicted [m]; of a range, that many along its way.
  Vector3 residual = Vector3::Zero();
  // The covariance stated for this row over the mean of all: xx, xy, xz, yy, yz, zz; of a range xx.
  std::array<float, 6> relative{1, 0, 0, 1, 0, 1};
  double weight = 1;                    // of the robust fit; 0: rejected
  std::uint8_t target = 0;              // index
  std::uint8_t sweep = 0;               // as in Observation
  std::uint8_t fold = 0;                // kNoFold: always fitted
  std::uint8_t receiver = kNoReceiver;  // of a range
  bool held_out = false;                // of the present fit
  // From which sides the joints came to the pose: bit j of `sides` set, the reading of joint j
  // grew; only where bit j of `sided` is set.
  std::uint8_t sides = 0;
  std::uint8_t sided = 0;
  std::uint32_t index = 0;  // in the caller's log
  std::uint32_t pose = 0;   // rows with one number repeat one pose
  std::uint64_t hash = 0;   // of the pose's readings
  // More than one only where all rows of the fit are positions of one stated covariance, or none.
  [[no_unique_address]] MergedRows merged;

  [[nodiscard]] bool is_range() const { return receiver != kNoReceiver; }
  // Measured numbers.
  [[nodiscard]] std::size_t scalars() const {
    return std::size_t{merged.count} * (is_range() ? 1 : 3);
  }
};

inline constexpr std::uint8_t kNoFold = 255;
inline constexpr std::size_t kFolds = 5;

// Finds the rows that repeat one pose (readings within 0.01 degrees or 0.05 mm), numbers the poses,
// and sorts the rows by pose: the result does not depend on the order in which the rows came.
void group_poses(std::span<FitRow> rows, std::span<const JointType> types);

// Deals the poses to kFolds folds, as even as can be, by the hash of their readings. Where there
// are poses of sweep 0 enough, only those; otherwise every pose. Precondition: group_poses().
// Returns the number of poses dealt.
std::size_t deal_folds(std::span<FitRow> rows);

}  // namespace armsig::calibration
