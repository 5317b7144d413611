// SPDX-License-Identifier: MIT
// Many random poses tried on the inverse: anywhere in the joint limits, and on purpose at
// singularities, on the boundary of reach and beyond it.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <random>

#include <Eigen/LU>

#include "firmware/analysis/postures/cold_start.hpp"
#include "host_tests/support/kinematics_random.hpp"
#include "host_tests/support/kinematics_reference.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::test {

inline constexpr double kGoal = 1e-9;         // m and rad
inline constexpr double kLargestStep = 0.01;  // rad or m in one tick

inline bool met(const kinematics::InverseSolution& solution) {
  return solution.verdict == kinematics::Verdict::kConverged ||
         solution.verdict == kinematics::Verdict::kDegraded;
}

// The pose by the product of matrices in extended precision, so that the kernel under test does not
// judge itself.
inline Pose reference(const KnownArm& arm, const JointVector& q) {
  const Matrix4L T = reference_pose(arm.joints, q);
  Pose X;
  for (std::size_t r = 0; r < 3; ++r) {
    const auto row = static_cast<Eigen::Index>(r);
    X.p[row] = static_cast<double>(T[r][3]);
    for (std::size_t c = 0; c < 3; ++c) {
      X.R(row, static_cast<Eigen::Index>(c)) = static_cast<double>(T[r][c]);
    }
  }
  return X;
}

// How many of `poses` random poses the inverse misses from a seed at most half a degree (or 9 mm)
// away, by the reference.
inline int missed_poses(const KnownArm& arm, int poses, std::mt19937_64& random) {
  const kinematics::Chain chain = kinematics::make_chain(arm.joints, arm.limits);
  int missed = 0;
  for (int k = 0; k < poses; ++k) {
    const JointVector q = random_readings(arm, random);
    const Pose X = reference(arm, q);
    const auto s = *kinematics::inverse(chain, X, disturbed(arm, q, radians(0.5), random));
    const Pose found = reference(arm, s.q);
    if (!met(s) || (found.p - X.p).norm() > kGoal || angle_between(found.R, X.R) > kGoal) ++missed;
  }
  return missed;
}

struct ColdStartTrial {
  int poses = 0;
  int none = 0;      // no solution
  int not_near = 0;  // the first is not near the seed
};

// Cold starts with the reference half a degree away from readings that reach the pose.
inline ColdStartTrial try_cold_starts(const KnownArm& arm, int poses, std::mt19937_64& random) {
  const kinematics::Chain chain = kinematics::make_chain(arm.joints, arm.limits);
  const kinematics::ClosedForm form = kinematics::closed_form(chain);
  ColdStartTrial trial{.poses = poses};
  for (int k = 0; k < poses; ++k) {
    const JointVector q = random_readings(arm, random);
    const JointVector seed = disturbed(arm, q, radians(0.5), random);
    const Pose X = *kinematics::forward(chain, q);
    if (kinematics::cold_start(chain, form, X)->empty()) ++trial.none;
    const kinematics::Solutions solutions = *kinematics::cold_start(chain, form, X, seed);
    double farthest = solutions.empty() ? 1 : 0;
    for (std::size_t i = 0; !solutions.empty() && i < q.size(); ++i) {
      farthest = std::max(farthest, std::abs(solutions[0].solution.q[i] - seed[i]));
    }
    // Next to a singularity the nearest solution may be a little further than the true one.
    if (farthest >= 0.1) ++trial.not_near;
  }
  return trial;
}

// The joints whose reading decides about a singularity: shoulder, elbow, wrist.
inline constexpr std::array<std::size_t, 3> kSingularJoints = {1, 2, 4};

inline double jacobian_determinant(const kinematics::Chain& chain, const JointVector& q) {
  const auto at = *kinematics::forward_with_jacobian(chain, q);
  return at.J.leftCols<6>().determinant();
}

// `q` with the reading of `joint` moved to where the Jacobian's determinant changes its sign,
// nothing where it keeps it over the whole range.
inline std::optional<JointVector> made_singular(const KnownArm& arm, const kinematics::Chain& chain,
                                                JointVector q, std::size_t joint,
                                                std::mt19937_64& random) {
  constexpr int kParts = 24;
  constexpr int kHalvings = 60;
  const JointLimits& limit = arm.limits[joint];
  const double part = (limit.upper - limit.lower) / kParts;
  const auto determinant = [&](double reading) {
    q[joint] = reading;
    return jacobian_determinant(chain, q);
  };
  const auto first = static_cast<int>(random() % kParts);
  for (int k = 0; k < kParts; ++k) {
    double lower = limit.lower + part * ((first + k) % kParts);
    double upper = lower + part;
    const bool positive = determinant(lower) > 0;
    if ((determinant(upper) > 0) == positive) continue;
    for (int halving = 0; halving < kHalvings; ++halving) {
      const double middle = 0.5 * (lower + upper);
      ((determinant(middle) > 0) == positive ? lower : upper) = middle;
    }
    return q;
  }
  return std::nullopt;
}

struct SingularTrial {
  int poses = 0;
  int without_verdict = 0;  // an error instead
  int not_finite = 0;
  int step_exceeded = 0;
  int iterations_exceeded = 0;
  int untrue = 0;  // the stated distance is not the true one, or a pose said to be met is not
  std::array<int, 6> verdicts{};  // by Verdict

  [[nodiscard]] int faults() const {
    return without_verdict + not_finite + step_exceeded + iterations_exceeded + untrue;
  }
};

inline void judge(const KnownArm& arm, const kinematics::Chain& chain, const JointVector& seed,
                  const Pose& X, SingularTrial& trial) {
  kinematics::InverseOptions options;
  options.max_step = JointVector(arm.joints.size(), kLargestStep);
  const auto s = kinematics::inverse(chain, X, seed, options);
  ++trial.poses;
  if (!s) {
    ++trial.without_verdict;
    return;
  }
  ++trial.verdicts[static_cast<std::size_t>(s->verdict)];
  bool finite = std::isfinite(s->position_error_m) && std::isfinite(s->rotation_error_rad);
  bool bounded = true;
  for (std::size_t i = 0; i < seed.size(); ++i) {
    finite = finite && std::isfinite(s->q[i]);
    bounded = bounded && std::abs(s->q[i] - seed[i]) <= kLargestStep;
  }
  if (!finite) ++trial.not_finite;
  if (!bounded) ++trial.step_exceeded;
  if (s->iterations > options.max_iterations) ++trial.iterations_exceeded;
  if (!finite) return;
  const Pose found = reference(arm, s->q);
  const double off_m = (found.p - X.p).norm();
  const bool stated = std::abs(off_m - s->position_error_m) <= 1e-12;
  if (!stated || (met(*s) && (off_m > kGoal || angle_between(found.R, X.R) > kGoal))) {
    ++trial.untrue;
  }
}

// Seeds a singular posture missed by 1e-9 to 1e-2 rad, or by nothing; targets that were reached
// from about there, that lie a nanometre to a metre further out or in, and anywhere about the base.
inline void try_singular_poses(const KnownArm& arm, int poses, std::mt19937_64& random,
                               SingularTrial& trial) {
  const kinematics::Chain chain = kinematics::make_chain(arm.joints, arm.limits);
  const auto magnitude = [&](double least, double most) {
    return std::pow(10, uniform(random, least, most)) * (random() % 2 == 0 ? 1 : -1);
  };
  for (int k = 0; k < poses;) {
    const std::size_t joint = kSingularJoints[random() % kSingularJoints.size()];
    const auto singular = made_singular(arm, chain, random_readings(arm, random), joint, random);
    if (!singular) continue;
    JointVector seed = *singular;
    if (random() % 8 != 0) seed[joint] += magnitude(-9, -2);
    JointVector goal = *singular;
    for (double& reading : goal) reading += uniform(random, -0.02, 0.02);
    const bool ends_singular = random() % 2 == 0;
    Pose X = reference(arm, ends_singular ? *singular : goal);
    if (ends_singular) {
      for (std::size_t i = 0; i < seed.size(); ++i) seed[i] += uniform(random, -0.005, 0.005);
    }
    const auto where = random() % 3;
    if (where == 1) X.p += magnitude(-9, 0) * X.p.normalized();
    if (where == 2) X.p *= uniform(random, 0, 3);
    judge(arm, chain, seed, X, trial);
    ++k;
  }
}

}  // namespace armsig::test
