// SPDX-License-Identifier: MIT
// One row of the measurement log, and what the refinement thinks of it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/arm.hpp"
#include "core/base/flight_time.hpp"
#include "core/base/pose.hpp"

namespace armsig::calibration {

enum class ObservationKind : std::uint8_t {
  kPosition,  // the target's position, three scalars
  kRange,     // the distance from the target to one receiver, one scalar
};

// What a row is for. Its residual is reported in any case.
enum class RowUse : std::uint8_t {
  kFit,
  kIgnore,
};

struct Observation {
  ObservationKind kind = ObservationKind::kPosition;
  RowUse use = RowUse::kFit;
  std::size_t sweep = 0;     // number of the joint that this row sweeps, 1 ... n; 0 for any pose
  std::size_t target = 0;    // index into Signature::targets
  std::size_t receiver = 0;  // index of the receiver, kRange only
  JointVector readings;      // as read: couplings not yet applied; radians or metres
  Vector3 p_S = Vector3::Zero();  // measured position in the sensor frame [m], kPosition only
  double range_m = 0;             // measured distance, kRange only
  double sigma_m = 0;             // 1 sigma (per axis) as stated; 0 where nothing was stated
};

// The verdict on one row, at the same index as the row in the log.
struct RowOutcome {
  double residual_m = 0;  // length of (measured - predicted), never negative
  double weight = 1;      // of the robust fit: 1 full, 0 rejected
  bool rejected = false;  // a gross outlier
};

// Where the receivers stand in the sensor frame.
using Receivers = FixedVector<Vector3, kMaxReceivers>;

}  // namespace armsig::calibration
