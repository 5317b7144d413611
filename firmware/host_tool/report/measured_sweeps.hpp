// SPDX-License-Identifier: MIT
// The measurements behind a signature, kept for the eye: every point of every sweep, and every row.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/identification/identification_run.hpp"
#include "firmware/host_tool/reading/read_rows.hpp"

namespace armsig::tool {

struct MeasuredPoint {
  double reading = 0;  // of the swept joint
  Vector3 p_S = Vector3::Zero();
  Matrix3 covariance_m2 = Matrix3::Zero();  // zero where not stated
};

// One target followed through the sweep of one joint.
struct MeasuredSweep {
  std::size_t joint = 0;  // from 0
  int target = 0;
  std::vector<MeasuredPoint> points;
};

// A row with a position, whether of a sweep or not.
struct MeasuredPose {
  std::size_t line = 0;   // of the file, from 1
  std::size_t sweep = 0;  // the joint swept, from 1; 0: a free pose
  int target = 0;
  JointVector q;  // as the encoders read
  Vector3 p_S = Vector3::Zero();
  Matrix3 covariance_m2 = Matrix3::Zero();  // zero where not stated
};

struct MeasuredSweeps {
  std::vector<MeasuredSweep> sweeps;       // by joint, then target
  std::vector<MeasuredPose> rows_located;  // in the order of the file
  OriginMatch match;                       // with the rows that the signature was found from
  std::size_t rows = 0;
  std::size_t not_located = 0;                       // no position, or ranges that do not meet
  std::size_t mixed = 0;                             // poses in which any joint may have moved
  FixedVector<JointLimits, kMaxJoints> mixed_reach;  // of every joint's reading over those poses

  std::vector<double> misses_m;  // what the signature misses the rows of its targets by
  Vector3 sum_S = Vector3::Zero();
  double squares_m2 = 0;  // of those rows' positions

  void add(const LocatedRow& row);
  void compare(const LocatedRow& row, const Vector3& predicted_S);

  // The median of the misses, as a share of how far the rows are spread; 0 without rows.
  [[nodiscard]] double missed_share() const;
};

// How far every joint's reading went over all rows; empty without rows.
[[nodiscard]] FixedVector<JointLimits, kMaxJoints> measured_reach(const MeasuredSweeps& measured);

// Reads `rows`, measurements of the arm that `record` describes. Refuses what read_rows() does.
[[nodiscard]] Read<MeasuredSweeps> read_measured_sweeps(const OpenRows& rows,
                                                        const SignatureRecord& record);

}  // namespace armsig::tool
