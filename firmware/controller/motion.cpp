// SPDX-License-Identifier: MIT
#include "firmware/controller/motion.hpp"

#include <algorithm>
#include <cmath>

#include "core/kinematics/inverse.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::controller {
namespace {

using kinematics::Verdict;

// The bound of the warm-started Newton iteration in a tick; 2 or 3 are the rule.
constexpr int kTickIterations = 12;
constexpr double kShortest_s = 0.02;
// Of the time that a line lasts: its samples see slopes between two of them only on average.
constexpr double kMargin = 1.05;

std::unexpected<MoveRefusal> refused(Error error, std::optional<std::size_t> joint = {}) {
  return std::unexpected(MoveRefusal{error, joint});
}

// Time for which course s must last so that |dq/ds| s' and |dq/ds| s'' + |d2q/ds2| s'^2 keep their
// limits.
double duration_for(double slope, double curvature, double speed, double acceleration) {
  const double by_speed = kPeakSpeed * slope / speed;
  const double by_acceleration =
      std::sqrt((kPeakAcceleration * slope + kPeakSpeed * kPeakSpeed * curvature) / acceleration);
  return std::max(by_speed, by_acceleration);
}

// The readings that `solution` found. Errors: as LinePlanning::result().
Result<JointVector> readings_of(const Configuration& configuration,
                                const kinematics::InverseSolution& solution) {
  switch (solution.verdict) {
    case Verdict::kConverged:
    case Verdict::kDegraded:
      if (solution.regularity < configuration.limits.least_regularity) {
        return std::unexpected(Error::kSingularPath);
      }
      return solution.q;
    case Verdict::kOutOfReach:
      return std::unexpected(Error::kOutOfReach);
    case Verdict::kJointLimit:
      return std::unexpected(Error::kJointLimit);
    case Verdict::kStepLimit:
      return std::unexpected(Error::kSpeedLimit);
    case Verdict::kNotConverged:
      break;
  }
  const bool singular = solution.regularity < configuration.limits.least_regularity;
  return std::unexpected(singular ? Error::kSingularPath : Error::kNotConverged);
}

// The inverse stands still where the arm has no solution: at the end of its reach, or against the
// limit of a joint.
Error obstacle_at(const Arm& arm, const JointVector& q) {
  constexpr double kAtLimit = 1e-9;
  for (std::size_t i = 0; i < arm.limits.size(); ++i) {
    const JointLimits& limits = arm.limits[i];
    if (q[i] < limits.lower + kAtLimit || q[i] > limits.upper - kAtLimit) return Error::kJointLimit;
  }
  return Error::kOutOfReach;
}

// Whether the flange can be at both tool poses, as far as twice the length of the stretched arm
// tells: no two places of it are further apart. Where the orientations are not met, the tool
// itself, which is so much further out.
[[gnu::noinline]] bool is_within_span(const Model& model, const Arm& arm, const Pose& X_RT_from,
                                      const Pose& X_RT_to) {
  double length = 0;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const DhJoint& row = arm.joints[i];
    const auto [lower, upper] = arm.limits[i];
    const double slide = row.type == JointType::kPrismatic ? std::max(-lower, upper) : 0;
    length += std::hypot(row.a_m, std::abs(row.d_m) + std::max(0.0, slide));
  }
  constexpr double kManufacturing = 1.05;
  if (may_miss_orientation(model)) {
    return (X_RT_to.p - X_RT_from.p).norm() <= 2 * (kManufacturing * length + model.p_nT.norm());
  }
  return (flange_pose(model, X_RT_to).p - flange_pose(model, X_RT_from).p).norm() <=
         2 * kManufacturing * length;
}

// Whether fewer than six joints have met the position of the next sample in another posture: there
// is no way between.
bool leaps(const Model& model, const JointVector& from, const JointVector& to) {
  constexpr double kLeap = 0.25;  // rad or m in a hundredth of the line
  return may_miss_orientation(model) && largest_change(from, to) > kLeap;
}

// What the motors turn for the joints to be at q.
JointVector motor_readings(const Configuration& configuration, const JointVector& q) {
  return readings_for(configuration.drawing.couplings, q);
}

// The first joint whose motor would leave its limits.
std::optional<std::size_t> motor_beyond(const Configuration& configuration,
                                        const JointVector& motors) {
  for (std::size_t i = 0; i < motors.size(); ++i) {
    const JointLimits& limits = configuration.drawing.limits[i];
    if (motors[i] < limits.lower || motors[i] > limits.upper) return i;
  }
  return std::nullopt;
}

bool finite(const JointVector& q) {
  return std::ranges::all_of(q, [](double value) { return std::isfinite(value); });
}

}  // namespace

Planned plan_joint_move(const Configuration& configuration, const JointVector& from,
                        const JointVector& to, double pace) {
  if (to.size() != from.size() || !(pace > 0) || pace > 1) return refused(Error::kOutOfRange);
  if (!finite(to)) return refused(Error::kNotFinite);
  Move move;
  move.from = from;
  move.to = to;
  move.duration_s = kShortest_s;
  PathShares shares;
  const JointVector motors_to = motor_readings(configuration, to);
  const JointVector motors_from = motor_readings(configuration, from);
  if (const auto beyond = motor_beyond(configuration, motors_to)) {
    return refused(Error::kJointLimit, beyond);
  }
  for (std::size_t i = 0; i < to.size(); ++i) {
    const JointLimits& limits = configuration.drawing.limits[i];
    if (to[i] < limits.lower || to[i] > limits.upper) return refused(Error::kJointLimit, i);
    const double slope =
        std::max(std::abs(to[i] - from[i]), std::abs(motors_to[i] - motors_from[i]));
    const double speed = configuration.limits.speed[i];
    const double acceleration = configuration.limits.acceleration[i];
    move.duration_s = std::max(move.duration_s, duration_for(slope, 0, speed, acceleration));
    shares.add(0, 1, slope, 0, speed, acceleration);
  }
  move.braking = braking_limits(shares, move.duration_s);
  move.duration_s /= pace;
  return move;
}

Pose line_pose(const Move& line, double s) {
  const Vector3 turn = rotation_vector(line.X_RT_from.R.transpose() * line.X_RT_to.R);
  return {line.X_RT_from.R * numerics::rotation_by(s * turn),
          line.X_RT_from.p + s * (line.X_RT_to.p - line.X_RT_from.p)};
}

LinePlanning::LinePlanning(const Configuration& configuration, const Model& model,
                           const JointVector& from, const Pose& X_RT_to, double pace)
    : configuration_(configuration), model_(model), pace_(pace) {
  planned_->kind = MoveKind::kLine;
  planned_->from = planned_->to = search_ = from;
  slope_before_.resize(from.size());
  if constexpr (kMayBound) asked_room_m_ = asked_room_m(configuration, from);
  begin(X_RT_to);
}

void LinePlanning::begin(const Pose& X_RT_to) {
  if (!(pace_ > 0) || pace_ > 1) {
    planned_ = refused(Error::kOutOfRange);
    return;
  }
  if (!X_RT_to.p.allFinite() || !X_RT_to.R.allFinite()) {
    planned_ = refused(Error::kNotFinite);
    return;
  }
  Move& move = *planned_;
  move.X_RT_to = X_RT_to;
  const auto X_RT_from = tool_pose(model_, move.from);
  if (!X_RT_from) {
    planned_ = refused(X_RT_from.error());
    return;
  }
  move.X_RT_from = *X_RT_from;
  if (!is_within_span(model_, configuration_.drawing, move.X_RT_from, X_RT_to)) {
    planned_ = refused(Error::kOutOfReach);
    return;
  }
  const double turn = rotation_vector(move.X_RT_from.R.transpose() * move.X_RT_to.R).norm();
  const double way = (move.X_RT_to.p - move.X_RT_from.p).norm();
  move.duration_s = std::max({kShortest_s, kPeakSpeed * way / configuration_.limits.tool_speed,
                              kPeakSpeed * turn / configuration_.limits.tool_turn_rate});
}

bool LinePlanning::step() {
  constexpr int kSamplesAStep = 5;
  constexpr int kPassesOfASample = 5;  // more than the rule is
  const int passes_before = passes_;
  for (int i = 0; i < kSamplesAStep && planned_ && done_ <= kLineSamples; ++i) {
    const int left = kPassesAStep - (passes_ - passes_before);
    if (left < kPassesOfASample) break;
    sample(left);
  }
  if (!planned_) return false;
  if (done_ <= kLineSamples) return true;
  planned_->duration_s *= kMargin;
  planned_->braking = braking_limits(shares_, planned_->duration_s);
  planned_->duration_s /= pace_;
  return false;
}

// One pose of the line through the inverse, in `passes` of it at most; where they do not suffice,
// the next step goes on from where they led.
void LinePlanning::sample(int passes) {
  const double course = static_cast<double>(done_) / kLineSamples;
  kinematics::InverseOptions options;
  const int most = options.max_iterations;
  options.max_iterations = passes;
  const auto solution = joints_for(model_, line_pose(*planned_, course), search_, options, lately_);
  if (!solution) {
    planned_ = refused(solution.error());
    return;
  }
  passes_ += solution->iterations;
  passes_of_sample_ += solution->iterations;
  if (solution->verdict == Verdict::kNotConverged) {
    constexpr double kHeadway = 1e-9;  // m and rad
    const double left = solution->position_error_m + solution->rotation_error_rad;
    const bool stands = std::abs(left - left_m_) <= kHeadway;
    search_ = solution->q;
    left_m_ = left;
    if (passes_of_sample_ < most) return;
    if (stands) {
      planned_ = refused(obstacle_at(configuration_.drawing, search_));
      return;
    }
  }
  auto q = readings_of(configuration_, *solution);
  if (q && leaps(model_, planned_->to, *q)) q = std::unexpected(Error::kSingularPath);
  if (!q) {
    planned_ = refused(q.error());
    return;
  }
  passes_of_sample_ = 0;
  left_m_ = 0;
  missed_rad_ = std::max(missed_rad_, solution->rotation_error_rad);
  search_ = *q;
  take(*q);
}

// The readings at the next sample; the move's end keeps how far the line came. Where the line
// begins counts as well.
void LinePlanning::take(const JointVector& q) {
  Move& move = *planned_;
  const int k = done_++;
  if (k == 0) return;
  if (const auto beyond = motor_beyond(configuration_, motor_readings(configuration_, q))) {
    planned_ = refused(Error::kJointLimit, beyond);
    return;
  }
  JointVector slope = q;
  for (std::size_t i = 0; i < q.size(); ++i) slope[i] = (q[i] - move.to[i]) * kLineSamples;
  const JointVector& before = k == 1 ? slope : slope_before_;
  keep_limits(slope, before);
  if (!configuration_.drawing.couplings.empty()) {
    keep_limits(motor_readings(configuration_, slope), motor_readings(configuration_, before));
  }
  slope_before_ = slope;
  if constexpr (kMayBound) {
    if (!keeps_clear(q)) return;
  }
  move.to = q;
}

// The line lasts long enough for joints, or their motors, that have `slope` up to the sample and
// `before` up to the one before.
void LinePlanning::keep_limits(const JointVector& slope, const JointVector& before) {
  const MotionLimits& limits = configuration_.limits;
  const double s_to = static_cast<double>(done_ - 1) / kLineSamples;
  const double s_from = s_to - 2.0 / kLineSamples;
  for (std::size_t i = 0; i < slope.size(); ++i) {
    const double steep = std::abs(slope[i]);
    const double curvature = std::abs(slope[i] - before[i]) * kLineSamples;
    planned_->duration_s =
        std::max(planned_->duration_s,
                 duration_for(steep, curvature, limits.speed[i], limits.acceleration[i]));
    shares_.add(s_from, s_to, kMargin * kMargin * steep, kMargin * kMargin * curvature,
                limits.speed[i], limits.acceleration[i]);
  }
}

// The arm goes from sample to sample about as it would straight in the readings. So short a way is
// looked at in a few places.
bool LinePlanning::keeps_clear(const JointVector& q) {
  WayLook look(asked_room_m_);
  const auto says =
      look.whole(configuration_.drawing.joints, configuration_.around, planned_->to, q);
  if (says == WayLook::Says::kClear) return true;
  room_ = look.room();
  planned_ = refused(Error::kOutsideWorkspace, moving_joint(configuration_, room_));
  return false;
}

bool MoveLook::step() {
  const auto says = look_on(look_, configuration_, planned_->from, planned_->to);
  if (says == WayLook::Says::kLeaves) {
    planned_ = refused(Error::kOutsideWorkspace, moving_joint(configuration_, look_.room()));
  }
  return says == WayLook::Says::kMore;
}

Planned plan_line(const Configuration& configuration, const Model& model, const JointVector& from,
                  const Pose& X_RT_to, double pace) {
  LinePlanning planning(configuration, model, from, X_RT_to, pace);
  while (planning.step()) {
  }
  return planning.result();
}

Result<JointVector> readings_at(const Move& move, const Configuration& configuration,
                                const Model& model, const JointVector& former, double s,
                                calibration::LatelyTurned& lately) {
  if (move.kind == MoveKind::kJoint) {
    JointVector q = move.from;
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += s * (move.to[i] - move.from[i]);
    return q;
  }
  kinematics::InverseOptions options;
  options.max_iterations = kTickIterations;
  for (const double speed : configuration.limits.speed) {
    options.max_step.push_back(speed * hal::seconds(configuration.period));
  }
  ARMSIG_TRY(solution, joints_for(model, line_pose(move, s), former, options, lately));
  // A position that is met is on the line; the next ticks go on to turn the tool.
  if (solution.verdict == Verdict::kNotConverged && may_miss_orientation(model) &&
      solution.position_error_m <= options.position_tolerance_m) {
    solution.verdict = Verdict::kConverged;
  }
  return readings_of(configuration, solution);
}

}  // namespace armsig::controller
