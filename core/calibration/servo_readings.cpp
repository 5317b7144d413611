// SPDX-License-Identifier: MIT
#include "core/calibration/servo_readings.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "core/base/check.hpp"
#include "core/kinematics/forward_kernel.hpp"

namespace armsig::calibration {

namespace {

using kinematics::Chain;
using kinematics::Frame;
using kinematics::JointAxes;
using kinematics::JointTerms;

// What the inverse may leave at the end of the longest lever, and how often it may try.
constexpr double kLeft_m = 1e-10;
constexpr int kMostPasses = 40;
// Up to here sines are turned further to the third power.
constexpr double kNear = 2e-3;

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

struct ServoReadings::Work {
  // A map between two knots: (a0 + a1 t + a2 t^2 + a3 t^3) sixths of a step.
  struct Cubic {
    double t;
    std::array<double, 4> a;
  };
  std::array<Cubic, kMaxJoints> cubics;
  JointTerms<double> terms;
};

ServoReadings::ServoReadings(const PackedDeflections& deflections, const Arm& drawing,
                             const JointVector& configuration)
    : joint_count_(deflections.maps.size()),
      couplings_(drawing.couplings),
      drawing_(drawn_chain(drawing, deflections.drawn_zero)),
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
    map.knots_per_length = from.domain.per_length;
    map.sixth = from.step / 6;
    map.sixth_by_length = map.sixth * map.knots_per_length;
    for (std::size_t k = 0; k < map.steps.size(); ++k) {
      map.steps[k] = from.steps[k % kKnots];
      most[i] = std::max(most[i], from.step * std::abs(static_cast<double>(map.steps[k])));
    }
  }
  left_ = kLeft_m / std::max(lever_m, 1.0);
  for (const GravityTerm& term : deflections.gravity) {
    const bool turns = drawing_.revolute[term.joint];
    most[term.joint] += std::abs(term.coefficient) * (turns ? lever_m : 1.0);
    if (turns) {
      gravity_.push_back(term);
    } else {
      slide_gravity_.push_back(term);
    }
  }
  for (const double value : most) largest_ = std::max(largest_, 2 * value);
  Work work;
  Values at_rest{};
  if (!begin(configuration, work)) return;
  this->deflections(work, at_rest);
  at_rest_ = at_rest;
}

// From whole numbers to powers of the way between two knots.
void ServoReadings::find_cubics(const JointVector& q, Work& work) const {
  for (std::size_t i = 0; i < joint_count_; ++i) {
    const Map& map = maps_[i];
    const double turns = (q[i] - map.origin) * map.turns_per_length;
    auto whole = static_cast<std::int32_t>(turns);
    whole -= turns < whole ? 1 : 0;
    const double at = (turns - whole) * static_cast<double>(kKnots);
    // At most kKnots, where rounding has it at the end of the turn.
    const auto k = static_cast<std::int32_t>(at);
    const std::int16_t* c = map.steps.data() + k;
    const std::int32_t c3 = c[3] - c[0] + 3 * (c[1] - c[2]);
    const std::int32_t c2 = 3 * (c[0] - 2 * c[1] + c[2]);
    const std::int32_t c1 = 3 * (c[2] - c[0]);
    const std::int32_t c0 = c[0] + 4 * c[1] + c[2];
    Work::Cubic& cubic = work.cubics[i];
    cubic.t = at - k;
    cubic.a = {static_cast<double>(c0), static_cast<double>(c1), static_cast<double>(c2),
               static_cast<double>(c3)};
  }
}

namespace {

// The axes and origins of the drawing, x and y of them: all that levers about axes that turn need.
// V: as many lanes as the processor has, of which one is a plain double.
template <typename V>
void horizontal_axes(const Chain& drawing, const JointTerms<double>& terms, JointAxes<double>& axes,
                     std::array<double, 4>& tip) {
  if constexpr (std::is_same_v<V, double>) {
    kinematics::FrameRows<double> x{1, 0, 0, 0};
    kinematics::FrameRows<double> y{0, 1, 0, 0};
    for (std::size_t i = 0; i < drawing.joint_count; ++i) {
      axes.axes[i][0] = x.z;
      axes.axes[i][1] = y.z;
      axes.origins[i][0] = x.p;
      axes.origins[i][1] = y.p;
      x.advance(drawing, terms, i);
      y.advance(drawing, terms, i);
    }
    tip[0] = x.p;
    tip[1] = y.p;
  } else {
    kinematics::FrameRows<V> rows{V{1, 0}, V{0, 1}, V{0, 0}, V{0, 0}};
    for (std::size_t i = 0; i < drawing.joint_count; ++i) {
      store(axes.axis(i), rows.z);
      store(axes.origin(i), rows.p);
      rows.advance(drawing, terms, i);
    }
    store(tip.data(), rows.p);
  }
}

// Sines and cosines of angles that have grown by `by`, of which the fourth power is nothing beside
// what gravity does.
void turn_further(std::size_t count, const std::array<double, kMaxJoints>& by,
                  JointTerms<double>& terms) {
  for (std::size_t i = 0; i < count; ++i) {
    const double s = terms.sine[i];
    const double c = terms.cosine[i];
    const double half = 0.5 * by[i] * by[i];
    const double first = by[i] - by[i] * half / 3;
    terms.sine[i] = s + first * c - half * s;
    terms.cosine[i] = c - first * s - half * c;
  }
}

}  // namespace

// Levers in the drawing's base frame, which stands upright: of an axis z and a weight at r from it,
// z . (r x down) = z_y r_x - z_x r_y.
void ServoReadings::add_gravity(const Work& work, Values& by) const {
  alignas(32) std::array<double, 4> tip;
  JointAxes<double> axes;
  horizontal_axes<Pack<double>>(drawing_, work.terms, axes, tip);
  for (const GravityTerm& term : gravity_) {
    const double* z = axes.axis(term.joint);
    const double* from = axes.origin(term.joint);
    const double* to = term.origin == joint_count_ ? tip.data() : axes.origin(term.origin);
    by[term.joint] += term.coefficient * (z[1] * (to[0] - from[0]) - z[0] * (to[1] - from[1]));
  }
}

// A slide gives way along its axis: z . down.
void ServoReadings::add_slides(const Work& work, Values& by) const {
  JointAxes<double> axes;
  Frame<double> frame;
  frame.advance_all(drawing_, work.terms, axes);
  for (const GravityTerm& term : slide_gravity_) {
    by[term.joint] -= term.coefficient * axes.axis(term.joint)[2];
  }
}

bool ServoReadings::begin(const JointVector& q, Work& work) const {
  for (std::size_t i = 0; i < joint_count_; ++i) {
    // Beyond, a reading has no micrometres left, and its turns no whole number.
    if (!(std::abs(q[i]) <= 1e6)) return false;
  }
  if (couplings_.empty()) {
    find_cubics(q, work);
  } else {
    find_cubics(readings_for(couplings_, q), work);
  }
  return !has_gravity() || kinematics::joint_terms(drawing_, q.data(), work.terms);
}

void ServoReadings::deflections(const Work& work, Values& by) const {
  for (std::size_t i = 0; i < joint_count_; ++i) {
    const auto& [a0, a1, a2, a3] = work.cubics[i].a;
    const double t = work.cubics[i].t;
    by[i] = maps_[i].sixth * (((a3 * t + a2) * t + a1) * t + a0) - at_rest_[i];
  }
  if (!gravity_.empty()) add_gravity(work, by);
  if (!slide_gravity_.empty()) [[unlikely]]
    add_slides(work, by);
}

Result<JointVector> ServoReadings::turned(const JointVector& q) const {
  if (exact()) return q;
  ARMSIG_CHECK(q.size() == joint_count_);
  Work work;
  Values by;
  if (!begin(q, work)) return std::unexpected(Error::kNotFinite);
  deflections(work, by);
  JointVector turned = q;
  for (std::size_t i = 0; i < joint_count_; ++i) turned[i] += by[i];
  return turned;
}

// Puts the work at `q`, which is `moved` from where it was: on the same cubics and by the same
// sines as long as no reading has passed a knot. Coupled readings, slides: anew.
bool ServoReadings::move(const JointVector& q, const Values& moved, Work& work) const {
  bool near = couplings_.empty() && !drawing_.has_prismatic;
  for (std::size_t i = 0; i < joint_count_; ++i) {
    double& t = work.cubics[i].t;
    t += moved[i] * maps_[i].knots_per_length;
    near = near && t >= 0 && t <= 1 && std::abs(moved[i]) < kNear;
  }
  if (!near) [[unlikely]]
    return begin(q, work);
  if (has_gravity()) turn_further(joint_count_, moved, work.terms);
  return true;
}

Result<JointVector> ServoReadings::readings(const JointVector& turned) const {
  if (exact()) return turned;
  ARMSIG_CHECK(turned.size() == joint_count_);
  Work work;
  Values by;
  JointVector q = turned;
  if (!begin(q, work)) return std::unexpected(Error::kNotFinite);
  Values gain;  // one over the slope of what a joint has turned
  for (std::size_t i = 0; i < joint_count_; ++i) {
    const auto& [a0, a1, a2, a3] = work.cubics[i].a;
    const double t = work.cubics[i].t;
    gain[i] = 1 / (1 + maps_[i].sixth_by_length * ((3 * a3 * t + 2 * a2) * t + a1));
  }
  double before = 0;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    deflections(work, by);
    double largest = 0;
    Values moved;
    for (std::size_t i = 0; i < joint_count_; ++i) {
      const double missing = turned[i] - q[i] - by[i];
      moved[i] = gain[i] * missing;
      q[i] += moved[i];
      largest = std::max(largest, std::abs(missing));
    }
    // What is left after this pass is to what it found as that is to what the one before found.
    if (largest <= left_ || (pass > 0 && largest * largest <= left_ * before)) return q;
    before = largest;
    if (!move(q, moved, work)) return std::unexpected(Error::kNotFinite);
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

Result<kinematics::InverseSolution> inverse_with_room(const Chain& chain,
                                                      const ServoReadings& joints, const Pose& X_0n,
                                                      const JointVector& seed,
                                                      kinematics::InverseOptions options) {
  for (double& step : options.max_step) step += joints.largest();
  return kinematics::inverse(chain, X_0n, seed, options);
}

}  // namespace

Result<kinematics::InverseSolution> inverse(const Chain& chain, const ServoReadings& joints,
                                            const Pose& X_0n, const JointVector& seed,
                                            const kinematics::InverseOptions& options) {
  if (joints.exact()) return kinematics::inverse(chain, X_0n, seed, options);
  auto solution = options.max_step.empty() ? kinematics::inverse(chain, X_0n, seed, options)
                                           : inverse_with_room(chain, joints, X_0n, seed, options);
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
