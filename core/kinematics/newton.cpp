// SPDX-License-Identifier: MIT
#include "core/kinematics/newton.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/kinematics/forward_kernel.hpp"
#include "core/kinematics/verdict.hpp"

namespace armsig::kinematics {
namespace {

constexpr int kLargestIterations = 8;
// Least relative volume of the two 3 x 3 blocks. Newton from half a degree away converges well
// above it; nearer to a singularity damping takes over.
constexpr double kLeastVolume = 0.01;
constexpr double kLargestError = 0.5;  // rad or m: beyond, the step may lead to another branch
// Below this regularity the factors of the step before would misstate it by more than a hundredth.
constexpr double kStaleBelow = 0.05;
// Square of the sine up to which the angle is taken from it: the next term is below rounding.
constexpr double kSmallSine = 1e-6;

// The Jacobian in blocks, wrist (joints 4 to 6) and arm (joints 1 to 3):
//   [A B] [dq_arm  ]   [position error]
//   [C D] [dq_wrist] = [rotation error].
// D holds three unit axes, so its inverse is three cross products; what remains for the arm is the
// Schur complement S = A - B D^-1 C: the velocity of the point that the wrist turns about. Exact
// for any six axes, spherical wrist or not.
class BlockSolver {
 public:
  // False near a singularity.
  [[nodiscard]] bool factor(const Chain& chain, const JointAxes& axes, const Vector3& p_0n) {
    const Vector3 z4 = axis(axes, 3);
    const Vector3 z5 = axis(axes, 4);
    const Vector3 z6 = axis(axes, 5);
    d_row4_ = z5.cross(z6);
    d_row5_ = z6.cross(z4);
    d_row6_ = z4.cross(z5);
    const double wrist = z4.dot(d_row4_);
    if (!(std::abs(wrist) > kLeastVolume)) return false;
    const double inverse = 1.0 / wrist;
    d_row4_ *= inverse;
    d_row5_ *= inverse;
    d_row6_ *= inverse;
    for (std::size_t i = 0; i < 3; ++i) b_[i] = linear_column(axes, p_0n, 3 + i);
    double sizes = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      reduce(chain, axes, p_0n, i);
      sizes *= s_[i].squaredNorm();
    }
    s_row1_ = s_[1].cross(s_[2]);
    s_row2_ = s_[2].cross(s_[0]);
    s_row3_ = s_[0].cross(s_[1]);
    const double arm = s_[0].dot(s_row1_);
    if (!(arm * arm > kLeastVolume * kLeastVolume * sizes)) return false;
    inverse_arm_ = 1.0 / arm;
    determinant_ = wrist * arm;
    return true;
  }

  // The step that removes the error to first order; added to q.
  void add_step(const Vector3& position_error, const Vector3& rotation_error, double* q) {
    const Vector3 g(d_row4_.dot(rotation_error), d_row5_.dot(rotation_error),
                    d_row6_.dot(rotation_error));
    const Vector3 b = position_error - wrist_moves(g);
    const double dq1 = s_row1_.dot(b) * inverse_arm_;
    const double dq2 = s_row2_.dot(b) * inverse_arm_;
    const double dq3 = s_row3_.dot(b) * inverse_arm_;
    const Vector3 wrist = g - dq1 * g_[0] - dq2 * g_[1] - dq3 * g_[2];
    q[0] += dq1;
    q[1] += dq2;
    q[2] += dq3;
    q[3] += wrist.x();
    q[4] += wrist.y();
    q[5] += wrist.z();
    step_squared_ = dq1 * dq1 + dq2 * dq2 + dq3 * dq3 + wrist.squaredNorm();
  }

  [[nodiscard]] double step_squared() const { return step_squared_; }
  // See regularity.hpp: |det J| = |det D| |det S|, lengths in units of the chain's.
  [[nodiscard]] double regularity(const Chain& chain) const {
    double unit = 1 / (chain.length * chain.length * chain.length);
    for (std::size_t i = 0; chain.has_prismatic && i < 3; ++i) {
      if (!chain.revolute[i]) unit *= chain.length;
    }
    return std::abs(determinant_) * unit;
  }

 private:
  // Columns i of S and of D^-1 C.
  [[gnu::always_inline]] void reduce(const Chain& chain, const JointAxes& axes, const Vector3& p_0n,
                                     std::size_t i) {
    const Vector3 z = axis(axes, i);
    if (!chain.revolute[i]) [[unlikely]] {
      g_[i].setZero();
      s_[i] = z;
      return;
    }
    g_[i] = Vector3(d_row4_.dot(z), d_row5_.dot(z), d_row6_.dot(z));
    s_[i] = linear_column(axes, p_0n, i) - wrist_moves(g_[i]);
  }

  // B times the wrist's motion.
  [[nodiscard]] Vector3 wrist_moves(const Vector3& wrist) const {
    return wrist.x() * b_[0] + wrist.y() * b_[1] + wrist.z() * b_[2];
  }

  static Vector3 axis(const JointAxes& axes, std::size_t i) {
    return Eigen::Map<const Vector3>(axes.axis(i));
  }

  Vector3 d_row4_, d_row5_, d_row6_;  // rows of D^-1
  std::array<Vector3, 3> b_;          // columns of B
  std::array<Vector3, 3> g_;          // columns of D^-1 C
  std::array<Vector3, 3> s_;          // columns of S
  Vector3 s_row1_, s_row2_, s_row3_;  // rows of the adjoint of S
  double inverse_arm_ = 0;
  double determinant_ = 0;
  double step_squared_ = 0;
};

// Whether `R` is the rotation that is `sine` away from R_reached, to kRotationDefect: at half a
// turn the sine is small, too, and of a matrix that is no rotation it says nothing.
[[gnu::always_inline]] inline bool is_small_turn(const Matrix3& R_reached, const Matrix3& R,
                                                 double sine_squared) {
  return (R - R_reached).squaredNorm() <=
         2 * sine_squared * (1 + sine_squared) + kRotationDefect * kRotationDefect;
}

}  // namespace

// NOLINTNEXTLINE(readability-function-size): a kernel
std::optional<InverseSolution> newton_inverse(const Chain& chain, const Pose& X_0n,
                                              const JointVector& seed,
                                              const InverseOptions& options, int& passes) {
  BlockSolver solver;
  JointTerms terms;
  JointAxes axes;
  Pose X;
  InverseSolution solution;
  solution.q = seed;
  double* q = solution.q.data();
  const double position_goal = options.position_tolerance_m * options.position_tolerance_m;
  const double rotation_goal =
      std::min(options.rotation_tolerance_rad * options.rotation_tolerance_rad, kSmallSine);
  const int most = std::min(kLargestIterations, options.max_iterations - 1);
  bool factored = false;
  for (int k = 1; k <= most; ++k) {
    passes = k;
    if (!joint_terms(chain, q, terms)) return std::nullopt;
    Frame frame;
    frame.advance_all(chain, terms, axes);
    frame.store_pose(X);
    const Vector3 position_error = X_0n.p - X.p;
    // Sine of the angle times the axis, to third order the rotation vector.
    const Vector3 rotation_error =
        0.5 * (X.R.col(0).cross(X_0n.R.col(0)) + X.R.col(1).cross(X_0n.R.col(1)) +
               X.R.col(2).cross(X_0n.R.col(2)));
    const double position = position_error.squaredNorm();
    const double rotation = rotation_error.squaredNorm();
    if (position <= position_goal && rotation <= rotation_goal) {
      if (!is_small_turn(X.R, X_0n.R, rotation)) return std::nullopt;
      solution.position_error_m = std::sqrt(position);
      solution.rotation_error_rad = std::sqrt(rotation) * (1 + rotation / 6);
      if (solution.position_error_m <= options.position_tolerance_m &&
          solution.rotation_error_rad <= options.rotation_tolerance_rad) {
        if (!factored && !solver.factor(chain, axes, X.p)) return std::nullopt;
        solution.regularity = solver.regularity(chain);
        if (solution.regularity < kStaleBelow) {
          if (!solver.factor(chain, axes, X.p)) return std::nullopt;
          solution.regularity = solver.regularity(chain);
        }
        if (!(solution.regularity >= options.degraded_below)) return std::nullopt;
        solution.verdict = Verdict::kConverged;
        solution.iterations = k;
        return solution;
      }
    }
    const double error = position + rotation;
    if (!(error < kLargestError * kLargestError)) return std::nullopt;
    // Once error times last step is below the goal, the last factors do as well as new ones.
    if (!factored ||
        error * solver.step_squared() > 0.04 * std::min(position_goal, rotation_goal)) {
      if (!solver.factor(chain, axes, X.p)) return std::nullopt;
      factored = true;
    }
    solver.add_step(position_error, rotation_error, q);
  }
  return std::nullopt;
}

}  // namespace armsig::kinematics
