// SPDX-License-Identifier: MIT
#include "core/calibration/servo_readings.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"
#include "core/base/lanes.hpp"

namespace armsig::calibration {

namespace {

// What the inverse may leave at the end of the longest lever, and how often it may try.
constexpr double kLeft_m = 1e-10;
constexpr int kMostPasses = 40;

using V = Pack<double>;
constexpr std::size_t kLanes = Lanes<double>::kCount;

}  // namespace

void ServoReadings::set(const PackedDeflections& deflections, const Arm& drawing,
                        const JointVector& configuration) {
  set_exact();
  couplings_ = drawing.couplings;
  limits_ = drawing.limits;
  if (deflections.maps.empty()) return;
  joint_count_ = deflections.maps.size();
  ARMSIG_CHECK(joint_count_ == drawing.joints.size() && configuration.size() == joint_count_);
  maps_.set(deflections);
  gravity_.set(deflections, drawing);
  const double left = kLeft_m / std::max(gravity_.lever_m(), 1.0);
  double largest = 0;
  for (std::size_t i = 0; i < joint_count_; ++i) {
    largest = std::max(largest, maps_.largest(i));
    // A step of Newton's method leaves half the second derivative times its square, over a slope of
    // at least 0.9. A coupled map sees the steps of other joints as well.
    map_weight_[i] = couplings_.empty() ? std::sqrt(maps_.most_bent(i) / left) : 1 / left;
    // Gravity changes with the steps of all joints.
    const double pulled = gravity_.steepest() * std::sqrt(static_cast<double>(joint_count_)) / left;
    weight_[i] = std::max(map_weight_[i], pulled);
  }
  largest_ = 2 * (largest + gravity_.largest());
  Values at_rest;
  if (deflections_at(filled(configuration), at_rest)) rest_deflection_ = at_rest;
}

void ServoReadings::set_exact() {
  joint_count_ = 0;
  couplings_.clear();
  limits_.clear();
  map_weight_.fill(0);
  weight_.fill(0);
  rest_deflection_.fill(0);
  largest_ = 0;
}

// Zero beyond the last joint.
ServoReadings::Values ServoReadings::filled(const JointVector& q) const {
  ARMSIG_CHECK(q.size() == joint_count_);
  Values values{};
  std::copy_n(q.data(), joint_count_, values.data());
  return values;
}

const ServoReadings::Values& ServoReadings::encoders(const Values& q, Values& coupled) const {
  if (couplings_.empty()) [[likely]]
    return q;  // NOLINT(bugprone-return-const-ref-from-parameter): no caller's is a temporary
  JointVector effective;
  for (std::size_t i = 0; i < joint_count_; ++i) effective.push_back(q[i]);
  coupled = filled(readings_for(couplings_, effective));
  return coupled;
}

// By gravity and map alone, whatever the arm is at rest. False if the readings are not finite.
bool ServoReadings::deflections_at(const Values& readings, Values& by) const {
  Values coupled;
  Values by_map;
  if (!maps_.at(encoders(readings, coupled), by_map)) return false;
  gravity_.at(readings, by);
  for (std::size_t i = 0; i < joint_count_; ++i) by[i] += by_map[i];
  return true;
}

Result<JointVector> ServoReadings::turned(const JointVector& q) const {
  if (exact()) return q;
  Values by;
  if (!deflections_at(filled(q), by)) return std::unexpected(Error::kNotFinite);
  Result<JointVector> turned(q);
  double* const to = turned->data();
  for (std::size_t i = 0; i < joint_count_; ++i) to[i] += by[i] - rest_deflection_[i];
  return turned;
}

Result<JointVector> ServoReadings::readings(const JointVector& turned) const {
  LatelyTurned nothing;
  return readings(turned, nothing);
}

// Finds q with q + map(q) = wanted, from a q near it; `gain` is by how much q changes for `wanted`
// to change by one. Errors: kNotFinite, kNotConverged.
Result<void> ServoReadings::undo_maps(const Values& wanted, Values& q, Values& gain) const {
  Values coupled;
  Values by;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    if (!maps_.at(encoders(q, coupled), by, gain)) return std::unexpected(Error::kNotFinite);
    V missed{};
    for (std::size_t j = 0; j < joint_count_; j += kLanes) {
      const V q_j = load<V>(q.data() + j);
      const V gain_j = 1.0 / (1.0 + load<V>(gain.data() + j));
      const V step = (load<V>(wanted.data() + j) - q_j - load<V>(by.data() + j)) * gain_j;
      store(gain.data() + j, gain_j);
      store(q.data() + j, q_j + step);
      const V weighed = step * load<V>(map_weight_.data() + j);
      missed += weighed * weighed;
    }
    if (sum_of_lanes<double>(missed) <= 1) return {};
  }
  return std::unexpected(Error::kNotConverged);
}

Result<JointVector> ServoReadings::readings(const JointVector& turned, LatelyTurned& lately) const {
  if (exact()) return turned;
  const Values goal = filled(turned);
  Values q;
  Values pull;  // of gravity, first as it went on from the inverse before to the last
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    q[i] = goal[i] - lately.by[i];
    pull[i] = 2 * lately.gravity[i] - lately.gravity_before[i];
  }
  for (int pass = 0; pass < kMostPasses; ++pass) {
    Values wanted;
    Values gain;
    for (std::size_t i = 0; i < kMaxJoints; ++i)
      wanted[i] = goal[i] + rest_deflection_[i] - pull[i];
    if (auto done = undo_maps(wanted, q, gain); !done) return std::unexpected(done.error());
    Values found;
    gravity_.at(q, found);
    V missed{};
    for (std::size_t j = 0; j < joint_count_; j += kLanes) {
      const V step =
          load<V>(gain.data() + j) * (load<V>(pull.data() + j) - load<V>(found.data() + j));
      store(q.data() + j, load<V>(q.data() + j) + step);
      const V weighed = step * load<V>(weight_.data() + j);
      missed += weighed * weighed;
    }
    pull = found;
    if (!(sum_of_lanes<double>(missed) <= 1)) continue;
    lately.gravity_before = pass == 0 ? lately.gravity : found;
    lately.gravity = found;
    for (std::size_t i = 0; i < kMaxJoints; ++i) lately.by[i] = goal[i] - q[i];
    Result<JointVector> readings(turned);
    std::copy_n(q.data(), joint_count_, readings->data());
    return readings;
  }
  return std::unexpected(Error::kNotConverged);
}

FixedVector<JointLimits, kMaxJoints> ServoReadings::turned_limits() const {
  FixedVector<JointLimits, kMaxJoints> wider = limits_;
  for (JointLimits& limits : wider) {
    limits.lower -= largest_;
    limits.upper += largest_;
  }
  return wider;
}

}  // namespace armsig::calibration
