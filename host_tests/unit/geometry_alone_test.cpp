// SPDX-License-Identifier: MIT
// The geometry for formats that cannot carry gravity and maps: no better one, by an independent
// search, and none that is worse than leaving the maps out.
#include "firmware/analysis/evaluation/geometry_alone.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "core/identification.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::calibration {
namespace {

using test::Random;

struct Case {
  Arm arm;
  ArmModel model;
  Signature signature;
  std::vector<JointVector> poses;

  [[nodiscard]] ReadingModel whole() const { return {arm.couplings, {}, &model}; }
  [[nodiscard]] ReadingModel rigid() const { return {arm.couplings, {}, nullptr}; }
};

// Means and first waves are what a geometry can stand for, faster ones what it cannot.
Case make_case(const Arm& drawing, Random& random, int poses) {
  Case made{test::made_to(drawing, {}, random), {}, {}, {}};
  made.arm.couplings = drawing.couplings;
  const std::size_t n = drawing.joints.size();
  made.model = model_of(drawing, {});
  choose_gravity_terms(drawing, made.model);
  for (GravityTerm& term : made.model.gravity) term.coefficient = random.uniform(-3e-4, 3e-4);
  for (JointModel& joint : made.model.joints) {
    joint.covered = {-1.5, 1.2};
    if (joint.type != JointType::kRevolute) joint.covered = {0.3, 0.6};
    const double slow = random.uniform(2, 6);
    const double fast = random.uniform(0.2, 1);
    const double phase = random.uniform(0, 6);
    for (std::size_t k = 0; k < kKnots; ++k) {
      const double turn = 2 * kPi * static_cast<double>(k) / kKnots;
      joint.map[k] = slow * std::cos(turn + phase) + fast * std::sin(11 * turn);
    }
  }
  const KnownTarget target{1, n, Vector3(0.05, 0.08, 0.1)};
  const JointVector q_s =
      effective_readings(drawing, covered_configuration(made.model, drawing.limits, 3));
  made.signature =
      signature_of(made.arm, q_s, {random.rotation(), random.normal_vector(1)}, {&target, 1});
  for (int k = 1; k <= poses; ++k) {
    made.poses.push_back(covered_configuration(made.model, drawing.limits, k));
  }
  return made;
}

// Mean square distance, by the S-Model's product and not by the code under test.
double mean_square(const Case& made, const Signature& signature) {
  const Vector3 p_L = signature.X_SL.back().inverse() * signature.targets[0].p_S;
  double sum = 0;
  for (const JointVector& q : made.poses) {
    const JointVector turned = true_readings(made.whole(), made.signature.configuration, q);
    const Vector3 exact =
        kinematics::target_position(made.signature, turned, made.signature.targets[0]);
    const std::size_t n = signature.joint_count();
    const Vector3 said = kinematics::link_pose(signature, effective_readings(made.arm, q), n) * p_L;
    sum += (exact - said).squaredNorm();
  }
  return sum / static_cast<double>(made.poses.size());
}

TEST(GeometryAlone, stays_where_nothing_is_left_out) {
  Random random(3);
  Case made = make_case(test::puma(), random, 100);
  Signature fitted = made.signature;
  ASSERT_TRUE(fit_geometry_alone(made.whole(), made.whole(), made.poses, fitted));
  EXPECT_LT(difference(made.signature, made.whole(), fitted, made.whole(), made.poses).rms_m,
            1e-12);
  for (std::size_t k = 0; k < fitted.X_SL.size(); ++k) {
    EXPECT_LT((fitted.X_SL[k].R - made.signature.X_SL[k].R).norm(), 1e-9);
  }
}

TEST(GeometryAlone, is_the_best_in_the_mean_square) {
  Random random(5);
  std::vector<Arm> arms{test::puma(), test::ur5(), test::stanford(), test::iiwa7()};
  Arm coupled = test::puma();
  coupled.couplings.push_back({2, 1, -1});
  arms.push_back(coupled);
  for (const Arm& arm : arms) {
    const Case made = make_case(arm, random, 300);
    Signature fitted = made.signature;
    ASSERT_TRUE(fit_geometry_alone(made.whole(), made.rigid(), made.poses, fitted));
    const double left = mean_square(made, fitted);
    EXPECT_NEAR(std::sqrt(left),
                difference(made.signature, made.whole(), fitted, made.rigid(), made.poses).rms_m,
                1e-9);
    EXPECT_LT(left, 0.7 * mean_square(made, made.signature));
    // No axis and no target can be moved to any good.
    for (std::size_t i = 0; i < fitted.joint_count(); ++i) {
      for (int c = 0; c < 4; ++c) {
        for (const double by : {-2e-5, 2e-5}) {
          Signature moved = fitted;
          Pose& X = moved.X_SL[i];
          const Pose X_last = X.inverse() * fitted.X_SL.back();
          if (c < 2) X.R = X.R * rotation_about(Vector3::Unit(c), by);
          if (c >= 2) X.p += by * X.R.col(c - 2);
          if (i + 1 == fitted.joint_count()) moved.X_SL.back() = X * X_last;
          EXPECT_GT(mean_square(made, moved), left * (1 - 1e-6)) << "joint " << i << " " << c;
        }
      }
    }
    for (int c = 0; c < 3; ++c) {
      Signature moved = fitted;
      moved.targets[0].p_S += 1e-5 * Vector3::Unit(c);
      EXPECT_GT(mean_square(made, moved), left);
    }
  }
}

TEST(GeometryAlone, does_as_well_at_poses_that_it_was_not_fitted_to) {
  Random random(7);
  Case made = make_case(test::ur5(), random, 600);
  Signature fitted = made.signature;
  ASSERT_TRUE(fit_geometry_alone(made.whole(), made.rigid(), made.poses, fitted));
  const Leftover at_fitted =
      difference(made.signature, made.whole(), fitted, made.rigid(), made.poses);
  made.poses.clear();
  for (int k = 601; k <= 900; ++k) {
    made.poses.push_back(covered_configuration(made.model, made.arm.limits, k));
  }
  const Leftover elsewhere =
      difference(made.signature, made.whole(), fitted, made.rigid(), made.poses);
  EXPECT_LT(elsewhere.rms_m, 1.15 * at_fitted.rms_m);
  EXPECT_GE(elsewhere.largest_m, elsewhere.rms_m);
}

TEST(GeometryAlone, turns_the_last_link_with_the_mean_of_its_map) {
  Random random(9);
  Case made = make_case(test::puma(), random, 200);
  made.model.gravity.clear();
  for (JointModel& joint : made.model.joints) joint.map.fill(0);
  // 0.02 degrees more over all that is covered, 0 at rest: outside of it.
  JointModel& last = made.model.joints[5];
  for (std::size_t k = 0; k < kKnots; ++k) last.map[k] = k < 20 || k > 90 ? 2 : 0;
  made.signature.configuration[5] = kPi;
  Signature fitted = made.signature;
  ASSERT_TRUE(fit_geometry_alone(made.whole(), made.rigid(), made.poses, fitted));
  const Matrix3 turn = made.signature.X_SL[6].R.transpose() * fitted.X_SL[6].R;
  const Vector3 axis = made.signature.X_SL[6].R.transpose() * made.signature.X_SL[5].R.col(2);
  EXPECT_NEAR(rotation_vector(turn).dot(axis), radians(0.02), radians(0.002));
}

// What the poses do not tell stays, also after a fit that moved it.
TEST(GeometryAlone, leaves_the_axis_of_a_joint_that_rested) {
  Random random(15);
  Case made = make_case(test::puma(), random, 100);
  Signature fitted = made.signature;
  ASSERT_TRUE(fit_geometry_alone(made.whole(), made.rigid(), made.poses, fitted));
  for (JointVector& q : made.poses) q[3] = made.signature.configuration[3];
  made.model.gravity.clear();
  made.model.joints[3].map.fill(0);
  fitted = made.signature;
  ASSERT_TRUE(fit_geometry_alone(made.whole(), made.rigid(), made.poses, fitted));
  EXPECT_LT((fitted.X_SL[3].R - made.signature.X_SL[3].R).norm(), 1e-12);
  EXPECT_GT((fitted.X_SL[2].R - made.signature.X_SL[2].R).norm(), 1e-6);
}

TEST(GeometryAlone, needs_a_pose) {
  Random random(11);
  const Case made = make_case(test::puma(), random, 1);
  Signature fitted = made.signature;
  const auto refused = fit_geometry_alone(made.whole(), made.rigid(), {}, fitted);
  EXPECT_EQ(test::failure_of(refused).error, Error::kTooFewPoints);
}

TEST(GeometryAlone, looks_where_the_rows_were) {
  Random random(13);
  const Case made = make_case(test::ur5(), random, 200);
  for (const JointVector& q : made.poses) {
    for (const double reading : q) {
      EXPECT_GE(reading, -1.5);
      EXPECT_LE(reading, 1.2);
    }
  }
  ArmModel unknown = made.model;
  unknown.joints[2].covered = {};
  double largest = 0;
  for (int k = 1; k <= 50; ++k) {
    largest = std::max(largest, covered_configuration(unknown, made.arm.limits, k)[2]);
  }
  EXPECT_GT(largest, 2);
}

// The origin of the last link stands for a tool, where there is room for it.
TEST(GeometryAlone, takes_the_last_links_origin_where_it_has_no_target) {
  Random random(31);
  Case made = make_case(test::puma560(), random, 40);
  made.signature.targets[0].link = 3;
  Signature fitted = made.signature;
  ASSERT_TRUE(fit_geometry_alone(made.whole(), made.rigid(), made.poses, fitted));
  EXPECT_EQ(fitted.targets.size(), 1U);
  EXPECT_GT((fitted.X_SL[5].R - made.signature.X_SL[5].R).norm(), 1e-9);
  made.signature.targets.resize(kMaxTargets, made.signature.targets[0]);
  const auto refused = fit_geometry_alone(made.whole(), made.rigid(), made.poses, made.signature);
  ASSERT_FALSE(refused);
  EXPECT_EQ(test::failure_of(refused).error, Error::kCapacityExceeded);
  EXPECT_EQ(test::failure_of(refused).found, 6 * 4 + 3 * kMaxTargets);
}

TEST(GeometryAlone, refuses_a_pose_that_is_no_number) {
  Random random(32);
  Case made = make_case(test::puma560(), random, 10);
  made.poses[3][2] = std::numeric_limits<double>::quiet_NaN();
  const auto refused = fit_geometry_alone(made.whole(), made.rigid(), made.poses, made.signature);
  ASSERT_FALSE(refused);
  EXPECT_EQ(test::failure_of(refused).error, Error::kSingular);
}

}  // namespace
}  // namespace armsig::calibration
