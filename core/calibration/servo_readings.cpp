// SPDX-License-Identifier: MIT
#include "core/calibration/servo_readings.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"
#include "core/kinematics/forward_kernel.hpp"

namespace armsig::calibration {

namespace {

using kinematics::Chain;
using kinematics::Frame;
using kinematics::JointAxes;
using kinematics::JointTerms;

// What the inverse may leave, and how often it may try.
constexpr double kLeft = 2e-10;  // rad or m
constexpr int kMostPasses = 40;

// make_chain() lets frames slide along their axes, which the levers would notice.
Chain drawn_chain(const Arm& drawing, const std::array<double, kMaxJoints>& zero) {
  Chain chain;
  chain.joint_count = drawing.joints.size();
  for (std::size_t i = 0; i < drawing.joints.size(); ++i) {
    const DhJoint& row = drawing.joints[i];
    const bool revolute = row.type == JointType::kRevolute;
    chain.theta[i] = revolute ? zero[i] : row.theta_rad;
    chain.x[i] = row.a_m;
    chain.y[i] = 0;
    chain.z[i] = revolute ? row.d_m : zero[i];
    chain.cos_alpha[i] = std::cos(row.alpha_rad);
    chain.sin_alpha[i] = std::sin(row.alpha_rad);
    chain.revolute[i] = revolute;
    chain.revolute_bits[i] = revolute ? -1 : 0;
    chain.has_prismatic = chain.has_prismatic || !revolute;
  }
  return chain;
}

// No more than the arm's links laid end to end, its slides as long as their limits let them.
double longest_lever_m(const Arm& drawing) {
  double length = 0;
  for (std::size_t i = 0; i < drawing.joints.size(); ++i) {
    const DhJoint& row = drawing.joints[i];
    length += std::hypot(row.a_m, row.d_m);
    if (row.type == JointType::kPrismatic && !drawing.limits.empty()) {
      length += std::max(std::abs(drawing.limits[i].lower), std::abs(drawing.limits[i].upper));
    }
  }
  return std::min(length, kLongestLever_m);
}

}  // namespace

ServoReadings::ServoReadings(const PackedDeflections& deflections, const Arm& drawing,
                             const JointVector& configuration)
    : joint_count_(deflections.maps.size()),
      couplings_(drawing.couplings),
      drawing_(drawn_chain(drawing, deflections.drawn_zero)),
      gravity_(deflections.gravity),
      limits_(drawing.limits) {
  if (joint_count_ == 0) return;
  ARMSIG_CHECK(joint_count_ == drawing.joints.size() && configuration.size() == joint_count_);
  const double lever_m = longest_lever_m(drawing);
  Values most{};
  for (std::size_t i = 0; i < joint_count_; ++i) {
    const PackedMap& from = deflections.maps[i];
    Map& map = maps_[i];
    map.origin = from.domain.origin;
    map.turns_per_length = from.domain.per_length / kKnots;
    map.step = from.step;
    for (std::size_t k = 0; k < map.steps.size(); ++k) {
      map.steps[k] = from.steps[k % kKnots];
      most[i] = std::max(most[i], map.step * std::abs(static_cast<double>(map.steps[k])));
    }
  }
  for (const GravityTerm& term : gravity_) {
    most[term.joint] +=
        std::abs(term.coefficient) * (drawing_.revolute[term.joint] ? lever_m : 1.0);
  }
  for (const double value : most) largest_ = std::max(largest_, 2 * value);
  Values slope;
  Values at_rest{};
  if (this->deflections(configuration, at_rest, slope)) at_rest_ = at_rest;
}

// The cubic between two knots by its powers of t, from whole numbers.
void ServoReadings::add_maps(const JointVector& q, Values& by, Values& slope) const {
  for (std::size_t i = 0; i < joint_count_; ++i) {
    const Map& map = maps_[i];
    const double turns = (q[i] - map.origin) * map.turns_per_length;
    auto whole = static_cast<std::int32_t>(turns);
    whole -= turns < whole ? 1 : 0;
    const double at = (turns - whole) * static_cast<double>(kKnots);
    // At most kKnots, where rounding has it at the end of the turn.
    const auto k = static_cast<std::size_t>(at);
    const double t = at - static_cast<double>(k);
    const std::int32_t c0 = map.steps[k];
    const std::int32_t c1 = map.steps[k + 1];
    const std::int32_t c2 = map.steps[k + 2];
    const std::int32_t c3 = map.steps[k + 3];
    const double a0 = c0 + 4 * c1 + c2;
    const double a1 = 3 * (c2 - c0);
    const double a2 = 3 * (c0 - 2 * c1 + c2);
    const double a3 = c3 - c0 + 3 * (c1 - c2);
    const double sixth = map.step / 6;
    by[i] += sixth * (((a3 * t + a2) * t + a1) * t + a0);
    slope[i] = sixth * ((3 * a3 * t + 2 * a2) * t + a1) * map.turns_per_length *
               static_cast<double>(kKnots);
  }
}

// Levers in the drawing's base frame, which stands upright: of an axis z and a weight at r from it,
// z . (r x down) = z_y r_x - z_x r_y.
bool ServoReadings::add_gravity(const JointVector& q, Values& by) const {
  JointTerms<double> terms;
  if (!kinematics::joint_terms(drawing_, q.data(), terms)) return false;
  JointAxes<double> axes;
  Frame<double> frame;
  frame.advance_all(drawing_, terms, axes);
  Pose X_0n;
  frame.store_pose(X_0n);
  for (const GravityTerm& term : gravity_) {
    const double* z = axes.axis(term.joint);
    if (!drawing_.revolute[term.joint]) [[unlikely]] {
      by[term.joint] -= term.coefficient * z[2];
      continue;
    }
    const double* from = axes.origin(term.joint);
    const double* to = term.origin == joint_count_ ? X_0n.p.data() : axes.origin(term.origin);
    by[term.joint] += term.coefficient * (z[1] * (to[0] - from[0]) - z[0] * (to[1] - from[1]));
  }
  return true;
}

bool ServoReadings::deflections(const JointVector& q, Values& by, Values& slope) const {
  for (std::size_t i = 0; i < joint_count_; ++i) {
    // Beyond, a reading has no micrometres left, and its turns no whole number.
    if (!(std::abs(q[i]) <= 1e6)) return false;
    by[i] = -at_rest_[i];
  }
  if (couplings_.empty()) {
    add_maps(q, by, slope);
  } else {
    add_maps(readings_for(couplings_, q), by, slope);
  }
  return gravity_.empty() || add_gravity(q, by);
}

Result<JointVector> ServoReadings::turned(const JointVector& q) const {
  if (exact()) return q;
  ARMSIG_CHECK(q.size() == joint_count_);
  Values by;
  Values slope;
  if (!deflections(q, by, slope)) return std::unexpected(Error::kNotFinite);
  JointVector turned = q;
  for (std::size_t i = 0; i < joint_count_; ++i) turned[i] += by[i];
  return turned;
}

Result<JointVector> ServoReadings::readings(const JointVector& turned) const {
  if (exact()) return turned;
  ARMSIG_CHECK(turned.size() == joint_count_);
  Values by;
  Values slope;
  JointVector q = turned;
  double before = 0;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    if (!deflections(q, by, slope)) return std::unexpected(Error::kNotFinite);
    double largest = 0;
    for (std::size_t i = 0; i < joint_count_; ++i) {
      const double missing = turned[i] - q[i] - by[i];
      q[i] += missing / (1 + slope[i]);
      largest = std::max(largest, std::abs(missing));
    }
    // What is left after this pass is to what it found as that is to what the one before found.
    if (largest <= kLeft || (pass > 0 && largest * largest <= 0.5 * kLeft * before)) return q;
    before = largest;
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

namespace {

// Whether the readings `q` themselves keep what was asked: what the joints turn was given more
// room.
kinematics::Verdict verdict_of_readings(const ServoReadings& joints, const JointVector& q,
                                        const JointVector& seed,
                                        const kinematics::InverseOptions& options,
                                        kinematics::Verdict verdict) {
  for (std::size_t i = 0; i < q.size(); ++i) {
    const bool limited = options.respect_limits && !joints.limits().empty();
    if (limited && (q[i] < joints.limits()[i].lower || q[i] > joints.limits()[i].upper)) {
      return kinematics::Verdict::kJointLimit;
    }
    if (!options.max_step.empty() && !(std::abs(q[i] - seed[i]) <= options.max_step[i])) {
      return kinematics::Verdict::kStepLimit;
    }
  }
  return verdict;
}

}  // namespace

Result<kinematics::InverseSolution> inverse(const Chain& chain, const ServoReadings& joints,
                                            const Pose& X_0n, const JointVector& seed,
                                            const kinematics::InverseOptions& options) {
  if (joints.exact()) return kinematics::inverse(chain, X_0n, seed, options);
  kinematics::InverseOptions wider = options;
  for (double& step : wider.max_step) step += joints.largest();
  auto solution = kinematics::inverse(chain, X_0n, seed, wider);
  if (!solution) return solution;
  auto q = joints.readings(solution->q);
  if (!q) return std::unexpected(q.error());
  solution->q = *q;
  using kinematics::Verdict;
  if (solution->verdict == Verdict::kConverged || solution->verdict == Verdict::kDegraded) {
    solution->verdict = verdict_of_readings(joints, *q, seed, options, solution->verdict);
  }
  return solution;
}

}  // namespace armsig::calibration
