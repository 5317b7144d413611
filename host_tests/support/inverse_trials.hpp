// SPDX-License-Identifier: MIT
// Random arms of any kind, and poses that are half a turn away as often as near: no verdict of the
// inverse may be contradicted by a product of matrices in extended precision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "core/kinematics/inverse.hpp"
#include "host_tests/support/kinematics_reference.hpp"

namespace armsig::test {

// How far the pose at q is from a target, in extended precision; the position is that of p_nP.
struct TrueError {
  long double position_m = 0;
  long double rotation_rad = 0;  // the angle, 0 to pi
};

inline TrueError true_error(const DhRows& rows, const JointVector& q, const Pose& X_0n,
                            const Vector3& p_nP) {
  const Matrix4L T = reference_pose(rows, q);
  TrueError error;
  std::array<std::array<long double, 3>, 3> R{};  // target times the transpose of what is reached
  long double squares = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    long double difference = static_cast<long double>(X_0n.p[row]) - T[i][3];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      difference += (static_cast<long double>(X_0n.R(row, column)) - T[i][k]) *
                    static_cast<long double>(p_nP[column]);
      for (std::size_t j = 0; j < 3; ++j) {
        R[i][j] += static_cast<long double>(X_0n.R(row, column)) * T[j][k];
      }
    }
    squares += difference * difference;
  }
  error.position_m = std::sqrt(squares);
  const long double x = R[2][1] - R[1][2];
  const long double y = R[0][2] - R[2][0];
  const long double z = R[1][0] - R[0][1];
  error.rotation_rad =
      std::atan2(std::sqrt(x * x + y * y + z * z), R[0][0] + R[1][1] + R[2][2] - 1);
  return error;
}

struct InverseTrial {
  long tried = 0;
  long beyond_quarter_turn = 0;  // seeds whose orientation is more than 90 degrees off
  long refused = 0;              // an error instead of a verdict
  long not_finite = 0;
  long outside = 0;                // of the limits or the step
  long overrun = 0;                // more passes than allowed
  long misstated = 0;              // the errors stated are not the true ones
  long false_met = 0;              // said to be met, and is not
  long false_stuck = 0;            // said that nothing near is nearer, and something is
  std::array<long, 6> verdicts{};  // by Verdict

  [[nodiscard]] long faults() const {
    return refused + not_finite + outside + overrun + misstated + false_met + false_stuck;
  }
};

// One random arm of 1 to 8 joints, any of them prismatic, and requests of it.
class InverseTrials {
 public:
  explicit InverseTrials(std::mt19937_64& random) : random_(random) {
    const std::size_t joints = 1 + random_() % kMaxJoints;
    const double prismatic = uniform(0, 0.5);
    for (std::size_t i = 0; i < joints; ++i) {
      const bool slides = uniform(0, 1) < prismatic;
      rows_.push_back({slides ? JointType::kPrismatic : JointType::kRevolute, angle(), length(),
                       length(), angle()});
      const double most = uniform(1, 6);
      limits_.push_back(slides ? JointLimits{uniform(-0.5, 0), uniform(0.1, 0.8)}
                               : JointLimits{-most, most});
    }
    limited_ = random_() % 2 == 0;
    chain_ = kinematics::make_chain(rows_, limited_ ? limits_ : decltype(limits_){});
  }

  void request(InverseTrial& trial) {
    const JointVector seed = readings();
    const Pose X_seed = *kinematics::forward(chain_, seed);
    const Pose X_0n = target(X_seed, seed);
    kinematics::InverseOptions options;
    options.max_iterations = 1 + static_cast<int>(random_() % 60);
    if (random_() % 4 == 0) options.p_nP = {uniform(-0.2, 0.2), 0.1, 0.2};
    if (random_() % 8 == 0) options.max_step = JointVector(rows_.size(), uniform(0, 0.5));
    ++trial.tried;
    if (angle_between(X_seed.R, X_0n.R) > kPi / 2) ++trial.beyond_quarter_turn;
    const auto solution = kinematics::inverse(chain_, X_0n, seed, options);
    if (!solution) {
      ++trial.refused;
      return;
    }
    judge(X_0n, seed, options, *solution, trial);
  }

 private:
  double uniform(double lower, double upper) {
    return std::uniform_real_distribution(lower, upper)(random_);
  }
  double angle() {  // quarter turns half of the time
    if (random_() % 2 == 0) return kPi / 2 * (static_cast<double>(random_() % 4) - 1);
    return uniform(-kPi, kPi);
  }
  double length() { return random_() % 2 == 0 ? 0 : uniform(-0.5, 0.5); }
  JointVector readings() {
    JointVector q;
    for (const JointLimits& limit : limits_) q.push_back(uniform(limit.lower, limit.upper));
    if (random_() % 8 == 0) {  // where axes line up
      for (double& reading : q) reading = 0;
    }
    return q;
  }
  Matrix3 any_turn(double angle_rad) {
    std::normal_distribution<double> normal;
    const Vector3 axis(normal(random_), normal(random_), normal(random_));
    return rotation_about(axis.normalized(), angle_rad);
  }

  Pose target(const Pose& X_seed, const JointVector& seed) {
    Pose X = X_seed;
    switch (random_() % 8) {
      case 0:
      case 1:
      case 2: {  // reached from elsewhere, more than a quarter turn off if the arm can
        for (int k = 0; k < 8; ++k) {
          X = *kinematics::forward(chain_, readings());
          if (angle_between(X_seed.R, X.R) > kPi / 2) break;
        }
        return X;
      }
      case 3:  // half a turn about an axis of the seed's pose
        X.R = X_seed.R * rotation_about(Vector3::Unit(static_cast<int>(random_() % 3)), kPi);
        return X;
      case 4:  // half a turn but for a hair, about any
        X.R = X_seed.R * any_turn(kPi - std::pow(10, uniform(-16, -6)));
        return X;
      case 5:  // anything
        X.R = any_turn(uniform(0, kPi));
        X.p = {uniform(-2, 2), uniform(-2, 2), uniform(-2, 2)};
        return X;
      default: {  // a tick away
        JointVector q = seed;
        for (double& reading : q) reading += uniform(-0.02, 0.02);
        return *kinematics::forward(chain_, q);
      }
    }
  }

  void judge(const Pose& X_0n, const JointVector& seed, const kinematics::InverseOptions& options,
             const kinematics::InverseSolution& solution, InverseTrial& trial) {
    using kinematics::Verdict;
    constexpr long double kPromised = 1e-9L;
    ++trial.verdicts[static_cast<std::size_t>(solution.verdict)];
    bool inside = true;
    bool finite = std::isfinite(solution.position_error_m) &&
                  std::isfinite(solution.rotation_error_rad) && std::isfinite(solution.regularity);
    for (std::size_t i = 0; i < seed.size(); ++i) {
      const double reading = solution.q[i];
      finite = finite && std::isfinite(reading);
      if (limited_) {
        inside = inside && reading >= limits_[i].lower && reading <= limits_[i].upper;
      }
      if (!options.max_step.empty()) {
        inside = inside && std::abs(reading - seed[i]) <= options.max_step[i];
      }
    }
    if (!finite) ++trial.not_finite;
    if (!inside) ++trial.outside;
    if (solution.iterations > options.max_iterations || solution.iterations < 1) ++trial.overrun;
    if (!finite) return;
    const bool met =
        solution.verdict == Verdict::kConverged || solution.verdict == Verdict::kDegraded;
    const TrueError error = true_error(rows_, solution.q, X_0n, options.p_nP);
    // Where the whole pose is met, the position stated may be that of frame n.
    const bool stated =
        std::abs(error.rotation_rad - static_cast<long double>(solution.rotation_error_rad)) <
            kPromised &&
        (std::abs(error.position_m - static_cast<long double>(solution.position_error_m)) <
         kPromised);
    if (!stated) ++trial.misstated;
    const bool whole = rows_.size() >= 6;
    if (met && (error.position_m > kPromised || (whole && error.rotation_rad > kPromised))) {
      ++trial.false_met;
    }
    if ((solution.verdict == Verdict::kOutOfReach) && random_() % 16 == 0 &&
        is_left(X_0n, options, solution, error)) {
      ++trial.false_stuck;
    }
  }

  // Whether readings beside those of the solution are nearer to the pose by more than the curvature
  // of a minimum allows.
  bool is_left(const Pose& X_0n, const kinematics::InverseOptions& options,
               const kinematics::InverseSolution& solution, const TrueError& error) {
    const bool position_first = rows_.size() < 6;
    const auto merit = [&](const TrueError& e) {
      return e.position_m * e.position_m + (position_first ? 0 : e.rotation_rad * e.rotation_rad);
    };
    constexpr double kBeside = 1e-3;
    for (int k = 0; k < 32; ++k) {
      JointVector q = solution.q;
      for (std::size_t i = 0; i < q.size(); ++i) {
        q[i] += uniform(-kBeside, kBeside);
        if (limited_) q[i] = std::clamp(q[i], limits_[i].lower, limits_[i].upper);
      }
      const long double gain = merit(error) - merit(true_error(rows_, q, X_0n, options.p_nP));
      // What a slope would bring; a fold brings its square.
      if (gain > 1e-2L * static_cast<long double>(kBeside) * std::max(merit(error), 1e-6L))
        return true;
    }
    return false;
  }

  std::mt19937_64& random_;
  DhRows rows_;
  FixedVector<JointLimits, kMaxJoints> limits_;  // also the range of random readings
  bool limited_ = true;
  kinematics::Chain chain_;
};

// `count` requests of as many arms as are tried a few dozen times each.
inline InverseTrial try_inverses(long count, std::mt19937_64& random) {
  constexpr long kOfAnArm = 32;
  InverseTrial trial;
  while (trial.tried < count) {
    InverseTrials arm(random);
    for (long k = 0; k < kOfAnArm && trial.tried < count; ++k) arm.request(trial);
  }
  return trial;
}

}  // namespace armsig::test
