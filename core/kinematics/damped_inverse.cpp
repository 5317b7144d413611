// SPDX-License-Identifier: MIT
#include "core/kinematics/damped_inverse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.hpp"
#include "core/kinematics/forward_kernel.hpp"
#include "core/kinematics/joint_box.hpp"
#include "core/kinematics/motion_directions.hpp"
#include "core/kinematics/position_first.hpp"
#include "core/kinematics/regularity.hpp"
#include "core/kinematics/verdict.hpp"
#include "core/numerics/cholesky.hpp"

namespace armsig::kinematics {
namespace {

using Vector6 = PoseError;

// Orientation weighs this much against position once both cannot be met: small enough that what it
// leaves of the position is mended beside it.
constexpr double kLowRotationWeight = 1e-4;
constexpr double kLargestStep = 0.4;        // rad or m in one iteration, to stay near the seed
constexpr double kNudge = 0.2;              // rad or m off a saddle
constexpr double kFoldError = 0.03;         // m or rad: what a nudge on a fold can make up for
constexpr int kMostSaddles = 4;             // left one after the other
constexpr double kNearHalfTurn = 3;         // rad
constexpr double kLower = 0.999;            // of the merit: below, a saddle was left
constexpr double kStationaryStep = 1e-11;   // rad or m
constexpr double kNearestTolerance = 1e-9;  // rad or m, of arms with more than six joints
// Of the task that meets the position first. From further than this part of the arm, or nearly
// turned round, it may lead to another posture than the descent.
constexpr double kNearPosition = 0.25;
constexpr double kPositionWeight = 10;      // rad per length of the arm
constexpr double kSmallStep = 1e-8;         // rad or m: the orientation is as near as it can be
constexpr double kSameMerit = 1 + 1e-9;     // what rounding may add to it by a step, in part
constexpr double kNoMerit = 1e-20;          // and as such: the square of 1e-10 rad
constexpr double kShortestPart = 1.0 / 16;  // of a step, before it is given up

class DampedSolver {
 public:
  DampedSolver(const Chain& chain, const Pose& X_0n, const JointVector& seed,
               const InverseOptions& options, int passes)
      : chain_(chain),
        X_target_(X_0n),
        options_(options),
        box_(joint_box(chain, seed, options)),
        n_(static_cast<Eigen::Index>(chain.joint_count)),
        passes_(passes) {
    seed_.head(n_) = Eigen::Map<const Eigen::VectorXd>(seed.data(), n_);
    q_ = box_.clamped(seed_);
  }

  InverseSolution solve() {
    ++passes_;
    evaluate(q_, at_);
    if (chain_.position_first && is_near()) {
      const TaskStep led = turn_in_place();
      if (led == TaskStep::kBounded && bounds_bar_position()) return finish(true);
      if (led == TaskStep::kFound || !begin_anew()) return finish(led == TaskStep::kFound);
    }
    bool stationary = descend();
    if (!met() && stationary && may_be_saddle()) stationary = leave_saddle();
    if (!met() && n_ < 6) stationary = meet_position();
    if (!met() && chain_.position_first && position_met()) stationary = turn_at_position();
    if (met() && n_ > 6) approach_seed();
    return finish(stationary);
  }

 private:
  struct State {
    PoseAndJacobian kinematics;
    Vector6 error = Vector6::Zero();  // position [m], rotation vector [rad], in frame 0
  };

  // Written in place: a state is half a kilobyte of stack. Functions of their own, here and below,
  // for the same reason.
  [[gnu::noinline]] void evaluate(const Joints& q, State& state) const {
    // The readings stay within a bounded box of finite ones.
    ARMSIG_CHECK(joint_columns(chain_, q.data(), state.kinematics));
    const Pose& X = state.kinematics.X_0n;
    // From here on p, and the rows of J for it, are of the point that the position is met at.
    const Vector3 lever = X.R * options_.p_nP;
    for (Eigen::Index i = 0; i < n_; ++i) {
      const Vector3 turning = state.kinematics.J.col(i).tail<3>();
      state.kinematics.J.col(i).head<3>() += turning.cross(lever);
    }
    state.error.head<3>() = X_target_ * options_.p_nP - (X.p + lever);
    state.error.tail<3>() = rotation_vector(X_target_.R * X.R.transpose());
  }

  [[nodiscard]] double merit(const State& state) const {
    return state.error.head<3>().squaredNorm() +
           rotation_weight_ * rotation_weight_ * state.error.tail<3>().squaredNorm();
  }
  [[nodiscard]] bool position_met() const {
    return at_.error.head<3>().norm() <= options_.position_tolerance_m;
  }
  [[nodiscard]] bool met() const {
    return position_met() && at_.error.tail<3>().norm() <= options_.rotation_tolerance_rad;
  }
  // Counts a pass of any loop, whether it leads anywhere or not; false if none is left.
  [[nodiscard]] bool another_pass() {
    if (passes_ >= options_.max_iterations) return false;
    ++passes_;
    return true;
  }

  // The weighted Jacobian, without the columns of joints that the gradient pushes against their
  // bound.
  [[nodiscard]] Jacobian free_jacobian() const {
    Jacobian J = at_.kinematics.J;
    J.bottomRows<3>() *= rotation_weight_;
    for (Eigen::Index i = 0; i < n_; ++i) {
      if (box_.stops(i, q_[i], push(i))) J.col(i).setZero();
    }
    return J;
  }
  // Which way the gradient pushes reading i.
  [[nodiscard]] double push(Eigen::Index i) const {
    const auto column = at_.kinematics.J.col(i);
    return column.head<3>().dot(at_.error.head<3>()) +
           rotation_weight_ * rotation_weight_ * column.tail<3>().dot(at_.error.tail<3>());
  }
  [[nodiscard]] Vector6 weighted_error() const {
    Vector6 e = at_.error;
    e.tail<3>() *= rotation_weight_;
    return e;
  }

  // argmin |J dq - e|^2 + damping |dq|^2.
  [[nodiscard]] static bool damped_step(const Jacobian& J, const Vector6& e, double damping,
                                        Eigen::Index n, Joints& dq) {
    Square normal = J.transpose().lazyProduct(J);
    normal.diagonal().array() += damping;
    dq = J.transpose().lazyProduct(e);
    return numerics::solve_positive(normal, dq, n);
  }

  static void shorten(Joints& dq) {
    const double largest = dq.cwiseAbs().maxCoeff();
    if (largest > kLargestStep) dq *= kLargestStep / largest;
  }

  // Levenberg-Marquardt to the nearest stationary point. False if the iterations were used up.
  [[gnu::noinline]] bool descend() {
    double damping = 0.1 * merit(at_);
    double growth = 2;
    while (!met()) {
      const Jacobian J = free_jacobian();
      const double scale = std::max(J.squaredNorm(), 1e-30);
      const Vector6 e = weighted_error();
      while (true) {
        if (!another_pass()) return false;
        Joints dq = Joints::Zero();
        damping = std::max(damping, 1e-16 * scale);
        if (damped_step(J, e, damping, n_, dq)) {
          shorten(dq);
          const Joints q = box_.clamped(q_ + dq);
          if ((q - q_).cwiseAbs().maxCoeff() < kStationaryStep) return true;
          State next;
          evaluate(q, next);
          const double before = merit(at_);
          const double after = merit(next);
          const double predicted = before - (e - J * (q - q_)).squaredNorm();
          if (after < before) {
            const double ratio = predicted > 0 ? (before - after) / predicted : 1;
            const double gain = 2 * ratio - 1;
            damping *= std::max(0.02, 1 - gain * gain * gain);
            growth = 2;
            q_ = q;
            at_ = next;
            break;
          }
        }
        damping *= growth;
        growth *= 2;
      }
    }
    return true;
  }

  // A descent also stops where the error is at right angles to all that the joints can do: on the
  // fold between two solutions (elbow or wrist straight), at half a turn. Only a step that was
  // limited, or an orientation that a short arm cannot choose, needs no such reason.
  [[nodiscard]] bool may_be_saddle() const {
    if (merit(at_) <= kFoldError * kFoldError) return true;
    if (n_ < 6) return at_.error.tail<3>().norm() > kNearHalfTurn;
    return obstacle() != Verdict::kStepLimit;
  }

  // A nudge along the direction in which the arm hardly moves frame n leads on, if there is
  // anything to be found. Returns what descend does.
  [[gnu::noinline]] bool leave_saddle() {
    for (int k = 0; k < kMostSaddles; ++k) {
      const double before = merit(at_);
      const bool stationary = nudge();
      if (!stationary || met()) return stationary;
      if (!(merit(at_) < kLower * before)) return true;
    }
    return true;
  }

  // The best of the minima beside this point, or this point. False if the iterations were used up.
  [[gnu::noinline]] bool nudge() {
    const Joints q_best = q_;
    const State best = at_;
    const double before = merit(best);
    const Joints weak = weakest_direction(at_.kinematics.J, n_);
    for (const double by : {kNudge, -kNudge}) {
      if (!another_pass()) return false;
      q_ = box_.clamped(q_best + by * weak);
      evaluate(q_, at_);
      const bool stationary = descend();
      if (met() || merit(at_) < kLower * before) return stationary;
      q_ = q_best;
      at_ = best;
      if (!stationary) return false;
    }
    return true;
  }

  // The position, and with it the orientation as well as it goes. False if the iterations were used
  // up.
  bool meet_position() {
    rotation_weight_ = kLowRotationWeight;
    if (!descend()) return false;
    rotation_weight_ = 0;
    if (!descend() || position_met()) return position_met();
    rotation_weight_ = kLowRotationWeight;
    if (!leave_saddle()) return false;
    rotation_weight_ = 0;
    return descend() || position_met();
  }

  [[nodiscard]] bool is_near() const {
    return at_.error.head<3>().norm() <= kNearPosition * chain_.length &&
           at_.error.tail<3>().norm() <= kNearHalfTurn;
  }
  [[nodiscard]] bool begin_anew() {
    if (!another_pass()) return false;
    q_ = box_.clamped(seed_);
    evaluate(q_, at_);
    return true;
  }

  // What the task has left at a state: its position, and the rotation once that is met. A step that
  // meets the position changes that rotation, to second order, by less than the position weighs.
  [[nodiscard]] double task_merit(const State& state) const {
    const PositionFirst task(state.kinematics.J);
    if (!task.is_regular()) return std::numeric_limits<double>::infinity();
    const double position = kPositionWeight / chain_.length * state.error.head<3>().norm();
    return position * position + task.rotation_left(state.error).squaredNorm();
  }

  // Gauss-Newton on the task of position_first.hpp, which meets the position and turns as near to
  // the orientation as it can: kFound where it has. kSingular also where it leads nowhere, or the
  // iterations were used up.
  [[gnu::noinline]] TaskStep turn_in_place() {
    while (!met()) {
      Joints dq;
      const TaskStep found = position_first_step(chain_, at_.kinematics.J, at_.error, box_, q_, dq);
      if (found != TaskStep::kFound) return found;
      shorten(dq);
      const bool small = dq.cwiseAbs().maxCoeff() < kSmallStep;
      if (!take_part(dq)) return TaskStep::kSingular;
      if (small && position_met()) break;
    }
    return TaskStep::kFound;
  }

  // Whether joints at their bounds keep the arm from the position, whatever the orientation: then
  // the weight stays at that for the verdict.
  [[nodiscard]] bool bounds_bar_position() {
    rotation_weight_ = 0;
    const bool bar = obstacle() != Verdict::kOutOfReach;
    if (!bar) rotation_weight_ = 1;
    return bar;
  }

  // The largest part of a step that leads no further away. False if there is none, or no pass left.
  [[gnu::noinline]] bool take_part(const Joints& dq) {
    const double before = task_merit(at_);
    State next;
    double part = 1;
    while (part >= kShortestPart && another_pass()) {
      const Joints q = box_.clamped(q_ + part * dq);
      evaluate(q, next);
      part *= 0.5;
      if (!(task_merit(next) <= kSameMerit * before + kNoMerit)) continue;
      q_ = q;
      at_ = next;
      return true;
    }
    return false;
  }

  // The same from a position that is met, which it stays: the place where it leads nowhere is the
  // nearest. False if the iterations were used up.
  [[gnu::noinline]] bool turn_at_position() {
    const Joints q_met = q_;
    if (turn_in_place() == TaskStep::kFound) return true;
    if (!position_met()) {
      q_ = q_met;
      evaluate(q_, at_);
    }
    return passes_ < options_.max_iterations;
  }

  // Moves along the self-motion of the arm to the solution nearest to the seed.
  [[gnu::noinline]] void approach_seed() {
    double fraction = 1;
    while (fraction > 1e-3 && another_pass()) {
      const Joints pull = seed_ - q_;
      const Joints along = self_motion(at_.kinematics.J, pull);
      if (along.cwiseAbs().maxCoeff() < kNearestTolerance) return;
      const Joints q_before = q_;
      const State before = at_;
      q_ = box_.clamped(q_ + fraction * along);
      evaluate(q_, at_);
      (void)descend();
      if (!met() || (seed_ - q_).squaredNorm() >= pull.squaredNorm()) {
        q_ = q_before;
        at_ = before;
        fraction *= 0.5;
      }
    }
  }

  [[nodiscard]] [[gnu::noinline]] InverseSolution finish(bool stationary) const {
    InverseSolution solution;
    solution.q.resize(chain_.joint_count);
    std::copy_n(q_.data(), solution.q.size(), solution.q.data());
    solution.iterations = passes_;
    solution.position_error_m = at_.error.head<3>().norm();
    solution.rotation_error_rad = at_.error.tail<3>().norm();
    solution.regularity = regularity(chain_, at_.kinematics);
    if (met() || (n_ < 6 && stationary && position_met())) {
      solution.verdict =
          solution.regularity < options_.degraded_below ? Verdict::kDegraded : Verdict::kConverged;
    } else {
      solution.verdict = stationary ? obstacle() : Verdict::kNotConverged;
    }
    return solution;
  }

  // What keeps a stationary point from the pose.
  [[nodiscard]] Verdict obstacle() const {
    Verdict verdict = Verdict::kOutOfReach;
    for (Eigen::Index i = 0; i < n_; ++i) {
      if (!box_.stops(i, q_[i], push(i))) continue;
      if (box_.stops_by_step(i, push(i))) return Verdict::kStepLimit;
      verdict = Verdict::kJointLimit;
    }
    return verdict;
  }

  const Chain& chain_;
  const Pose& X_target_;
  const InverseOptions& options_;
  JointBox box_;
  Eigen::Index n_;
  Joints seed_ = Joints::Zero();
  Joints q_ = Joints::Zero();
  State at_;
  double rotation_weight_ = 1;
  int passes_;
};

}  // namespace

InverseSolution damped_inverse(const Chain& chain, const Pose& X_0n, const JointVector& seed,
                               const InverseOptions& options, int passes) {
  return DampedSolver(chain, X_0n, seed, options, passes).solve();
}

}  // namespace armsig::kinematics
