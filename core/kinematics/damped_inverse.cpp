// SPDX-License-Identifier: MIT
#include "core/kinematics/damped_inverse.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"
#include "core/kinematics/forward_kernel.hpp"
#include "core/kinematics/joint_box.hpp"
#include "core/kinematics/regularity.hpp"

namespace armsig::kinematics {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Square = Eigen::Matrix<double, kMaxJoints, kMaxJoints>;

// Orientation weighs this much against position once both cannot be met: small enough that the
// position error it leaves is taken away by two Newton steps on the position alone.
constexpr double kLowRotationWeight = 1e-4;
constexpr double kLargestStep = 0.4;  // rad or m in one iteration, to stay near the seed
constexpr double kFoldError = 0.03;   // m or rad: what a nudge of 0.2 rad on a fold can make up for
constexpr double kStationaryStep = 1e-11;   // rad or m
constexpr double kNearestTolerance = 1e-9;  // rad or m, of arms with more than six joints

// Solves a x = b for the symmetric positive definite n x n `a` (Cholesky, in place; x over b).
bool solve_positive(Square& a, Joints& b, Eigen::Index n) {
  for (Eigen::Index j = 0; j < n; ++j) {
    double pivot = a(j, j);
    for (Eigen::Index k = 0; k < j; ++k) pivot -= a(j, k) * a(j, k);
    if (!(pivot > 0)) return false;
    a(j, j) = std::sqrt(pivot);
    for (Eigen::Index i = j + 1; i < n; ++i) {
      double sum = a(i, j);
      for (Eigen::Index k = 0; k < j; ++k) sum -= a(i, k) * a(j, k);
      a(i, j) = sum / a(j, j);
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < i; ++k) b[i] -= a(i, k) * b[k];
    b[i] /= a(i, i);
  }
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    for (Eigen::Index k = i + 1; k < n; ++k) b[i] -= a(k, i) * b[k];
    b[i] /= a(i, i);
  }
  return true;
}

class DampedSolver {
 public:
  DampedSolver(const Chain& chain, const Pose& X_0n, const JointVector& start,
               const JointVector& seed, const InverseOptions& options)
      : chain_(chain),
        X_target_(X_0n),
        options_(options),
        box_(joint_box(chain, seed, options)),
        n_(static_cast<Eigen::Index>(chain.joint_count)) {
    for (Eigen::Index i = 0; i < n_; ++i) {
      seed_[i] = seed[static_cast<std::size_t>(i)];
      q_[i] = start[static_cast<std::size_t>(i)];
    }
    q_ = box_.clamped(q_);
  }

  InverseSolution solve() {
    evaluate(q_, at_);
    bool stationary = descend();
    if (!met() && stationary) stationary = escape_fold();
    if (!met() && n_ < 6) {
      rotation_weight_ = kLowRotationWeight;
      stationary = descend();
      meet_position();
    }
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
  [[gnu::noinline]] void evaluate(const Joints& q, State& state) {
    ++evaluations_;
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
  [[nodiscard]] bool exhausted() const { return evaluations_ >= options_.max_iterations; }

  // The weighted Jacobian, without the columns of joints that the gradient pushes against their
  // bound.
  [[nodiscard]] Jacobian free_jacobian() const {
    Jacobian J = at_.kinematics.J;
    J.bottomRows<3>() *= rotation_weight_;
    const Vector6 e = weighted_error();
    for (Eigen::Index i = 0; i < n_; ++i) {
      if (box_.stops(i, q_[i], J.col(i).dot(e))) J.col(i).setZero();
    }
    return J;
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
    return solve_positive(normal, dq, n);
  }

  // Levenberg-Marquardt to the nearest minimum. False if the iterations were used up.
  [[gnu::noinline]] bool descend() {
    double damping = 0.1 * merit(at_);
    double growth = 2;
    while (!met()) {
      const Jacobian J = free_jacobian();
      const double scale = std::max(J.squaredNorm(), 1e-30);
      const Vector6 e = weighted_error();
      while (true) {
        if (exhausted()) return false;
        Joints dq = Joints::Zero();
        damping = std::max(damping, 1e-16 * scale);
        if (damped_step(J, e, damping, n_, dq)) {
          const double largest = dq.cwiseAbs().maxCoeff();
          if (largest > kLargestStep) dq *= kLargestStep / largest;
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

  // Where two solutions meet (elbow or wrist straight) the descent can stop on the fold between
  // them, or at a limit beside it. A nudge along the direction in which the arm hardly moves frame
  // n leads on, if there is anything to be found. Returns what descend does.
  [[gnu::noinline]] bool escape_fold() {
    if (merit(at_) > kFoldError * kFoldError) return true;
    const Joints q_best = q_;
    const State best = at_;
    const Joints weak = weakest_direction();
    bool stationary = true;
    for (const double nudge : {0.03, -0.03, 0.2, -0.2}) {
      q_ = box_.clamped(q_best + nudge * weak);
      evaluate(q_, at_);
      stationary = descend();
      if (met()) return true;
      if (!stationary) break;
    }
    q_ = q_best;
    at_ = best;
    return stationary;
  }

  // The unit direction (largest entry 1) along which frame n moves least.
  [[nodiscard]] [[gnu::noinline]] Joints weakest_direction() const {
    const Jacobian& J = at_.kinematics.J;
    Joints direction = Joints::Zero();
    direction.head(n_).setOnes();
    for (int k = 0; k < 3; ++k) {
      Square normal = J.transpose().lazyProduct(J);
      normal.diagonal().array() += 1e-9 * J.squaredNorm();
      if (!solve_positive(normal, direction, n_)) return Joints::Zero();
      direction /= direction.cwiseAbs().maxCoeff();
    }
    return direction;
  }

  // Least-norm Newton steps on the position alone.
  [[gnu::noinline]] void meet_position() {
    for (int k = 0; k < 3 && !position_met() && !exhausted(); ++k) {
      Jacobian J = at_.kinematics.J;
      J.bottomRows<3>().setZero();
      Vector6 e = at_.error;
      e.tail<3>().setZero();
      Joints dq = Joints::Zero();
      if (!damped_step(J, e, 1e-13 * J.squaredNorm(), n_, dq)) return;
      const Joints q = box_.clamped(q_ + dq);
      State next;
      evaluate(q, next);
      if (next.error.head<3>().norm() >= at_.error.head<3>().norm()) return;
      q_ = q;
      at_ = next;
    }
  }

  // Moves along the self-motion of the arm to the solution nearest to the seed.
  [[gnu::noinline]] void approach_seed() {
    double fraction = 1;
    while (!exhausted() && fraction > 1e-3) {
      const Joints pull = seed_ - q_;
      const Joints along = self_motion(pull);
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

  // The part of `v` that leaves the pose where it is.
  [[nodiscard]] [[gnu::noinline]] Joints self_motion(const Joints& v) const {
    const Jacobian& J = at_.kinematics.J;
    Square normal = Square::Zero();
    normal.topLeftCorner<6, 6>() = J.lazyProduct(J.transpose());
    normal.diagonal().array() += 1e-12 * J.squaredNorm();
    Joints x = Joints::Zero();
    x.head<6>() = J.lazyProduct(v);
    if (!solve_positive(normal, x, 6)) return Joints::Zero();
    return v - J.transpose().lazyProduct(x.head<6>());
  }

  [[nodiscard]] [[gnu::noinline]] InverseSolution finish(bool stationary) const {
    InverseSolution solution;
    solution.q.resize(chain_.joint_count);
    for (Eigen::Index i = 0; i < n_; ++i) solution.q[static_cast<std::size_t>(i)] = q_[i];
    solution.iterations = evaluations_;
    solution.position_error_m = at_.error.head<3>().norm();
    solution.rotation_error_rad = at_.error.tail<3>().norm();
    const Regularity r = regularity(at_.kinematics, options_.degraded_below);
    solution.regularity = r.value;
    solution.position_dimensions = r.position_dimensions;
    solution.rotation_dimensions = r.rotation_dimensions;
    if (met() || (n_ < 6 && stationary && position_met())) {
      solution.verdict =
          r.value < options_.degraded_below ? Verdict::kDegraded : Verdict::kConverged;
    } else {
      solution.verdict = stationary ? obstacle() : Verdict::kNotConverged;
    }
    return solution;
  }

  // What keeps a stationary point from the pose.
  [[nodiscard]] Verdict obstacle() const {
    Verdict verdict = Verdict::kOutOfReach;
    for (Eigen::Index i = 0; i < n_; ++i) {
      const double push = at_.kinematics.J.col(i).dot(at_.error);
      if (!box_.stops(i, q_[i], push)) continue;
      if (box_.stops_by_step(i, push)) return Verdict::kStepLimit;
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
  int evaluations_ = 0;
};

}  // namespace

InverseSolution damped_inverse(const Chain& chain, const Pose& X_0n, const JointVector& start,
                               const JointVector& seed, const InverseOptions& options) {
  return DampedSolver(chain, X_0n, start, seed, options).solve();
}

}  // namespace armsig::kinematics
