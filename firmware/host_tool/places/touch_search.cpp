// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/touch_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "core/base/low_discrepancy.hpp"
#include "core/kinematics/forward.hpp"

namespace armsig::tool {
namespace {

// A ball on a stem leaves its socket where the stem leans farther than this from the socket's axis.
constexpr double kSteepestStem_rad = radians(75);
constexpr int kStandsTried = 3000;
constexpr int kTriesEach = 14;  // for each touch that is asked for
constexpr int kMostPasses = 60;
constexpr double kThere_m = 1e-9;
constexpr double kLargestStep = 0.4;  // rad or m
constexpr double kDamping = 1e-5;     // m: of a singular posture
constexpr double kAlike = radians(8);
// Below the middle of a ball in its socket is the socket, and what holds it.
constexpr double kLeastHeight_m = 0.03;
constexpr double kNoStem_m = 1e-3;

// The reading of a whole turn less, or more, that is nearest to the middle of its limits.
double within_a_turn(double reading, const JointLimits& limits) {
  const double middle =
      std::isfinite(limits.lower + limits.upper) ? (limits.lower + limits.upper) / 2 : 0;
  return middle + std::remainder(reading - middle, 2 * kPi);
}

}  // namespace

TouchSearch::TouchSearch(const Arm& arm, const Vector3& tool_F, clearance::Surroundings around)
    : arm_(arm),
      tool_F_(tool_F),
      around_(std::move(around)),
      chain_(kinematics::make_chain(arm.joints)) {
  const std::size_t n = arm_.joints.size();
  for (std::size_t j = 0; j < n; ++j) {
    JointVector one;
    for (std::size_t k = 0; k < n; ++k) one.push_back(k == j ? 1 : 0);
    effective_.push_back(effective_readings(arm_, one));
  }
  const JointTypes types = types_of(arm_.joints);
  for (int k = 1; k <= kStandsTried; ++k) {
    const JointVector q = work_configuration(types, arm_.limits, k);
    const auto X_BF = kinematics::forward(chain_, effective_readings(arm_, q));
    const Vector3 p_B = *X_BF * tool_F_;
    if (has_room(p_B) && is_clear(q)) stands_.push_back({q, p_B});
  }
}

bool TouchSearch::has_room(const Vector3& p_B) const {
  return std::ranges::all_of(around_.planes,
                             [&](const clearance::HalfSpace& plane) {
                               return plane.normal_B.dot(p_B) >= plane.offset_m + kLeastHeight_m;
                             }) &&
         (p_B.array() >= around_.lower_B.array()).all() &&
         (p_B.array() <= around_.upper_B.array()).all();
}

bool TouchSearch::is_clear(const JointVector& q) const {
  return clearance::room_at(arm_.joints, around_, effective_readings(arm_, q)).left_m >=
         clearance::kLeastRoom_m;
}

Vector3 TouchSearch::stem_B(const JointVector& q) const {
  if (tool_F_.norm() < kNoStem_m) return Vector3::Zero();
  return -(kinematics::forward(chain_, effective_readings(arm_, q))->R * tool_F_).normalized();
}

bool TouchSearch::moves_to(const Vector3& p_B, JointVector& q) const {
  const auto n = static_cast<Eigen::Index>(q.size());
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const auto at = kinematics::forward_with_jacobian(chain_, effective_readings(arm_, q));
    const Vector3 arm_B = at->X_0n.R * tool_F_;
    const Vector3 off = p_B - at->X_0n.p - arm_B;
    if (off.norm() < kThere_m) return true;
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxJoints> J(3, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      J.col(j).setZero();
      const JointVector& by = effective_[static_cast<std::size_t>(j)];
      for (Eigen::Index k = 0; k < n; ++k) {
        const Vector3 turn = at->J.block<3, 1>(3, k);
        J.col(j) += by[static_cast<std::size_t>(k)] * (at->J.block<3, 1>(0, k) + turn.cross(arm_B));
      }
    }
    const Matrix3 damped = J * J.transpose() + kDamping * kDamping * Matrix3::Identity();
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoints> step =
        J.transpose() * damped.ldlt().solve(off);
    step *= std::min(1.0, kLargestStep / std::max(step.norm(), 1e-300));
    for (Eigen::Index j = 0; j < n; ++j) q[static_cast<std::size_t>(j)] += step[j];
  }
  return false;
}

std::vector<JointVector> TouchSearch::touches(const Vector3& p_B, const Vector3& axis_B,
                                              std::size_t most, std::size_t sought) const {
  std::vector<JointVector> found;
  const JointTypes types = types_of(arm_.joints);
  const double least_cosine = std::cos(kSteepestStem_rad);
  const int before = kTriesEach * static_cast<int>(sought);
  const int last = before + kTriesEach * static_cast<int>(most);
  for (int k = before + 1; k <= last && found.size() < most; ++k) {
    JointVector q = evenly_spread_configuration(types, arm_.limits, k);
    if (!moves_to(p_B, q)) continue;
    bool kept = true;
    for (std::size_t j = 0; j < q.size(); ++j) {
      const JointLimits& limits = arm_.limits[j];
      if (types[j] == JointType::kRevolute) q[j] = within_a_turn(q[j], limits);
      kept = kept && q[j] >= limits.lower && q[j] <= limits.upper;
    }
    if (!kept) continue;
    const Vector3 stem = stem_B(q);
    if (!stem.isZero() && stem.dot(axis_B) < least_cosine) continue;
    const auto alike = [&](const JointVector& other) { return largest_change(q, other) < kAlike; };
    if (std::ranges::any_of(found, alike) || !is_clear(q)) continue;
    found.push_back(q);
  }
  return found;
}

}  // namespace armsig::tool
