// SPDX-License-Identifier: MIT
// Five axes meet a position, in the posture that turns the tool as nearly as any does: what an
// independent search over random starts finds is no better.
#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>

#include "host_tests/support/independent_postures.hpp"
#include "host_tests/support/posture_kinds.hpp"

namespace armsig::test {
namespace {

using kinematics::Solutions;
using kinematics::Verdict;

// As the handling robots with an elbow and no joint that turns the forearm.
KnownArm five_axes() {
  KnownArm arm = arm_of("five axes", rows_of({{0, 0.33, 0.075, -kQuarter},
                                              {-kQuarter, 0, 0.3, kPi},
                                              {0, 0, 0.32, 0},
                                              {kQuarter, 0, 0, kQuarter},
                                              {0, 0.08, 0, 0}}));
  const std::array<std::array<double, 2>, 5> limits{
      {{-170, 170}, {-60, 140}, {-140, 215}, {-120, 120}, {-360, 360}}};
  for (std::size_t i = 0; i < 5; ++i)
    arm.limits[i] = {radians(limits[i][0]), radians(limits[i][1])};
  return arm;
}

bool is_inside(const KnownArm& arm, const Eigen::VectorXd& q) {
  for (std::size_t i = 0; i < arm.limits.size(); ++i) {
    bool inside = false;
    for (const double turn : {-2 * kPi, 0.0, 2 * kPi}) {
      const double reading = std::remainder(q[static_cast<Eigen::Index>(i)], 2 * kPi) + turn;
      inside = inside || (reading >= arm.limits[i].lower && reading <= arm.limits[i].upper);
    }
    if (!inside) return false;
  }
  return true;
}

// The least angle by which the orientation is missed, over all postures inside the limits. The
// position counts a thousand times as much.
double least_turn(const KnownArm& arm, const Pose& X, int starts, std::mt19937_64& random) {
  using Arm = IndependentArm<double>;
  const Arm independent(arm.joints);
  double least = 10;
  for (int k = 0; k < starts; ++k) {
    Arm::Readings q(5);
    for (Eigen::Index i = 0; i < 5; ++i) q[i] = uniform(random, -kPi, kPi);
    Arm::JacobianS J;
    Arm::ErrorS e = Arm::error({X.R, X.p}, independent.place(q, &J));
    double damping = 0.1;
    for (int pass = 0; pass < 150; ++pass) {
      const auto weighted = [](Arm::ErrorS error) {
        error.head<3>() *= 1e3;
        return error;
      };
      Arm::JacobianS A = J;
      A.topRows<3>() *= 1e3;
      Eigen::MatrixXd normal = A.transpose() * A;
      normal.diagonal().array() += damping;
      Eigen::VectorXd step = normal.ldlt().solve(A.transpose() * weighted(e));
      if (step.norm() > 0.5) step *= 0.5 / step.norm();
      const Arm::Readings next = q + step;
      Arm::JacobianS J_next;
      const Arm::ErrorS e_next = Arm::error({X.R, X.p}, independent.place(next, &J_next));
      const bool better = weighted(e_next).squaredNorm() < weighted(e).squaredNorm();
      damping = better ? std::max(1e-9, 0.2 * damping) : std::min(1e9, 4 * damping);
      if (!better) continue;
      q = next;
      e = e_next;
      J = J_next;
    }
    if (e.head<3>().norm() > 1e-5 || !is_inside(arm, q)) continue;
    least = std::min(least, e.tail<3>().norm());
  }
  return least;
}

TEST(FiveAxes, miss_the_orientation_by_no_more_than_another_posture) {
  constexpr double kAsGood = 0.021;  // rad: so near, the posture nearest to the middle comes first
  const char* told = std::getenv("ARMSIG_POSTURES");
  const int poses = told == nullptr ? 6 : 10 * std::atoi(told);
  std::mt19937_64 random(3);
  const KnownArm drawing = five_axes();
  double most = 0;
  double largest = 0;
  int beaten = 0;
  int refused = 0;
  for (int k = 0; k < poses; ++k) {
    const KnownArm arm = built(drawing, random);
    const Pose X = reference(drawing, random_readings(drawing, random));
    const kinematics::Chain chain = kinematics::make_chain(arm.joints, arm.limits);
    const Solutions listed = *kinematics::cold_start(chain, kinematics::ClosedForm{}, X);
    const double least = least_turn(arm, X, 60, random);
    if (least > 9) continue;  // out of the individual's limits
    if (listed.empty() || listed[0].solution.verdict == Verdict::kJointLimit) {
      ++refused;
      continue;
    }
    const double by = listed[0].solution.rotation_error_rad - least;
    most = std::max(most, by);
    largest = std::max(largest, least);
    beaten += by > kAsGood ? 1 : 0;
  }
  std::printf("| poses | beaten | by at most, rad | refused | least missed, at most, rad |\n");
  std::printf("|--:|--:|--:|--:|--:|\n| %d | %d | %.4f | %d | %.4f |\n", poses, beaten, most,
              refused, largest);
  EXPECT_EQ(beaten, 0);
  EXPECT_EQ(refused, 0);
}

}  // namespace
}  // namespace armsig::test
