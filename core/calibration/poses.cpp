// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "core/calibration/fit_row.hpp"
#include "core/calibration/reading_hash.hpp"

namespace armsig::calibration {

namespace {

// Encoders repeat a pose this well, and nobody measures poses so near to each other on purpose.
constexpr double kSameAngle = radians(0.01);
constexpr double kSameLength = 0.05e-3;
// Poses of sweep 0 a fold, from which they alone are left out.
constexpr std::size_t kEnoughPosesAFold = 2;

bool earlier(const FitRow& a, const FitRow& b) {
  for (std::size_t i = 0; i < a.readings.size(); ++i) {
    if (a.readings[i] != b.readings[i]) return a.readings[i] < b.readings[i];
  }
  if (a.target != b.target) return a.target < b.target;
  for (Eigen::Index c = 0; c < 3; ++c) {
    if (a.p_S[c] != b.p_S[c]) return a.p_S[c] < b.p_S[c];
  }
  if (a.receiver != b.receiver) return a.receiver < b.receiver;
  if (a.range_m != b.range_m) return a.range_m < b.range_m;
  return a.sweep < b.sweep;
}

double tolerance(JointType type) { return type == JointType::kRevolute ? kSameAngle : kSameLength; }

bool same_pose(const FitRow& a, const FitRow& b, std::span<const JointType> types) {
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (!(std::abs(a.readings[i] - b.readings[i]) <= tolerance(types[i]))) return false;
  }
  return true;
}

// Until joined, a row's pose is the index of an earlier row of the same pose, or its own.
std::uint32_t root(std::span<FitRow> rows, std::uint32_t row) {
  while (rows[row].pose != row) {
    rows[row].pose = rows[rows[row].pose].pose;
    row = rows[row].pose;
  }
  return row;
}

}  // namespace

void group_poses(std::span<FitRow> rows, std::span<const JointType> types) {
  std::sort(rows.begin(), rows.end(), earlier);
  const auto count = static_cast<std::uint32_t>(rows.size());
  for (std::uint32_t i = 0; i < count; ++i) rows[i].pose = i;
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::uint32_t j = i + 1; j < count; ++j) {
      if (rows[j].readings[0] - rows[i].readings[0] > tolerance(types[0])) break;
      if (!same_pose(rows[i], rows[j], types)) continue;
      const std::uint32_t a = root(rows, i);
      const std::uint32_t b = root(rows, j);
      rows[std::max(a, b)].pose = std::min(a, b);
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    rows[i].pose = root(rows, i);
    rows[i].hash = hash_of(rows[rows[i].pose].readings);
  }
  std::sort(rows.begin(), rows.end(), [](const FitRow& a, const FitRow& b) {
    if (a.hash != b.hash) return a.hash < b.hash;
    return a.pose != b.pose ? a.pose < b.pose : earlier(a, b);
  });
  std::uint32_t pose = 0;
  for (std::uint32_t i = 0; i < count;) {
    const std::uint32_t old = rows[i].pose;
    for (; i < count && rows[i].pose == old; ++i) rows[i].pose = pose;
    ++pose;
  }
}

std::size_t deal_folds(std::span<FitRow> rows) {
  const auto deal = [&](bool mixed_only) {
    std::size_t dealt = 0;
    for (std::size_t i = 0; i < rows.size();) {
      const std::uint32_t pose = rows[i].pose;
      const bool left_out = !mixed_only || rows[i].sweep == 0;
      for (; i < rows.size() && rows[i].pose == pose; ++i) {
        rows[i].fold = left_out ? static_cast<std::uint8_t>(dealt % kFolds) : kNoFold;
      }
      if (left_out) ++dealt;
    }
    return dealt;
  };
  const std::size_t mixed = deal(true);
  return mixed >= kEnoughPosesAFold * kFolds ? mixed : deal(false);
}

}  // namespace armsig::calibration
