// SPDX-License-Identifier: MIT
// The table of what is different about an arm: what was planted is found, whatever frame it is
// looked at from, and the effects add up to the displacement of the tool.
#include "firmware/analysis/differences/differences.hpp"

#include <memory>
#include <vector>

#include "core/base/low_discrepancy.hpp"
#include "core/identification.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "host_tests/support/exact_arm.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::differences {
namespace {

using test::Random;

constexpr int kTool = 1;

std::unique_ptr<calibration::Refined> exact(const Signature& signature) {
  auto estimate = std::make_unique<calibration::Refined>();
  estimate->signature = signature;
  return estimate;
}

std::unique_ptr<calibration::Refined> estimate_of(const Arm& arm, const JointVector& configuration,
                                                  const Pose& X_S0, const Vector3& p_F) {
  const KnownTarget tool{kTool, arm.joints.size(), p_F};
  return exact(signature_of(arm, configuration, X_S0, std::span(&tool, 1)));
}

JointVector some_readings(const Arm& arm, double share) {
  JointVector q;
  for (const JointLimits& limits : arm.limits) {
    q.push_back(limits.lower + share * (limits.upper - limits.lower));
  }
  return q;
}

const Vector3 kTool_F(0.08, 0.03, 0.12);
const Pose kBase{rotation_z(0.3) * rotation_x(0.2), Vector3(1, -2, 0.5)};

Differences found(const Arm& drawing, const calibration::Refined& estimate) {
  auto result = differences(drawing, estimate, 0);
  EXPECT_TRUE(result.has_value());
  return result.value_or(Differences{});
}

double value_of(const Differences& differences, std::size_t joint, Cause cause) {
  for (const Difference& d : differences.all) {
    if (d.joint == joint && d.cause == cause) return d.value;
  }
  return 0;
}

double sum_of_effects(const Differences& differences) {
  double sum = 0;
  for (const Difference& d : differences.all) sum += d.effect.adds_m;
  return sum;
}

// Everything but the one planted is near nought.
void expect_only(const Arm& drawing, const Arm& arm, std::size_t joint, Cause cause, double value) {
  const auto estimate = estimate_of(arm, some_readings(drawing, 0.4), kBase, kTool_F);
  const Differences differences = found(drawing, *estimate);
  bool seen = false;
  for (const Difference& d : differences.all) {
    const bool planted = d.joint == joint && d.cause == cause;
    seen = seen || planted;
    EXPECT_NEAR(d.value, planted ? value : 0, 1e-3 * std::abs(value))
        << "joint " << d.joint + 1 << " cause " << static_cast<int>(d.cause);
  }
  EXPECT_TRUE(seen);
  EXPECT_NEAR(sum_of_effects(differences), differences.total_rms_m, 0.01 * differences.total_rms_m);
}

TEST(Differences, are_none_of_an_arm_as_drawn) {
  for (const test::KnownArm& known : test::known_arms()) {
    SCOPED_TRACE(known.name);
    const auto estimate = estimate_of(known.drawing, some_readings(known, 0.3), kBase, kTool_F);
    const Differences differences = found(known.drawing, *estimate);
    EXPECT_LT(differences.total_rms_m, 1e-9);
    for (const Difference& d : differences.all) EXPECT_NEAR(d.value, 0, 1e-9);
  }
}

TEST(Differences, name_the_zero_of_an_encoder) {
  const Arm drawing = test::puma560();
  for (const std::size_t joint : {1U, 2U, 3U, 4U}) {
    SCOPED_TRACE(joint + 1);
    Arm arm = drawing;
    arm.joints[joint].theta_rad += radians(0.5);
    expect_only(drawing, arm, joint, Cause::kZero, radians(0.5));
  }
}

TEST(Differences, name_the_tilt_of_an_axis_against_the_axis_before) {
  const Arm drawing = test::puma560();
  Arm arm = drawing;
  arm.joints[0].alpha_rad += radians(0.1);  // -90 degrees: axis 2 leans towards axis 1
  expect_only(drawing, arm, 1, Cause::kTiltY, radians(0.1));
}

TEST(Differences, name_the_tilt_of_a_parallel_axis_out_of_their_plane) {
  const Arm drawing = test::puma560();
  Arm arm = drawing;
  arm.joints[1].alpha_rad += radians(0.1);
  // The row turns the axis about the link, x of its frame: that leads from axis 2 to axis 3.
  expect_only(drawing, arm, 2, Cause::kTiltX, radians(0.1));
}

TEST(Differences, name_the_length_of_a_link) {
  const Arm drawing = test::puma560();
  Arm arm = drawing;
  arm.joints[1].a_m += 1e-3;
  expect_only(drawing, arm, 2, Cause::kShiftX, 1e-3);
}

TEST(Differences, name_the_offset_along_the_axis_before) {
  const Arm drawing = test::puma560();
  Arm arm = drawing;
  arm.joints[3].d_m += 1e-3;
  expect_only(drawing, arm, 4, Cause::kShiftX, 1e-3);
}

// Read off Table 2 by hand: its rows less those of Table 1.
TEST(Differences, are_those_of_the_papers_robot_1) {
  const Arm arm = test::puma560_robot1();
  const auto estimate = estimate_of(arm, some_readings(arm, 0.4), kBase, kTool_F);
  const Differences differences = found(test::puma560_robot1().drawing, *estimate);
  const double printed_rad = radians(0.002);
  EXPECT_NEAR(value_of(differences, 1, Cause::kTiltY), radians(-0.066), printed_rad);
  EXPECT_NEAR(
      std::hypot(value_of(differences, 2, Cause::kTiltX), value_of(differences, 2, Cause::kTiltY)),
      radians(0.217), printed_rad);
  EXPECT_NEAR(value_of(differences, 3, Cause::kTiltY), radians(-0.519), printed_rad);
  EXPECT_NEAR(value_of(differences, 3, Cause::kZero), radians(-0.296), printed_rad);
  EXPECT_NEAR(value_of(differences, 4, Cause::kZero), radians(-0.497), printed_rad);
  EXPECT_NEAR(value_of(differences, 4, Cause::kShiftX), 2.08e-3, 1e-5);
}

// An individual of a drawing, about as a workshop makes it.
Arm individual(const Arm& drawing, Random& random, double times = 1) {
  Arm arm = drawing;
  for (DhJoint& row : arm.joints) {
    row.alpha_rad += times * random.uniform(-1, 1) * radians(0.15);
    row.theta_rad += times * random.uniform(-1, 1) * radians(0.3);
    row.a_m += times * random.uniform(-1, 1) * 0.8e-3;
    row.d_m += times * random.uniform(-1, 1) * 0.8e-3;
  }
  return arm;
}

void expect_same(const Differences& a, const Differences& b) {
  ASSERT_EQ(a.all.size(), b.all.size());
  EXPECT_NEAR(a.total_rms_m, b.total_rms_m, 1e-8);
  for (std::size_t k = 0; k < a.all.size(); ++k) {
    SCOPED_TRACE(a.all[k].joint + 1);
    EXPECT_EQ(a.all[k].cause, b.all[k].cause);
    EXPECT_NEAR(a.all[k].value, b.all[k].value, 1e-7);
    EXPECT_NEAR(a.all[k].effect.rms_m, b.all[k].effect.rms_m, 1e-7);
    EXPECT_NEAR(a.all[k].effect.adds_m, b.all[k].effect.adds_m, 1e-7);
  }
}

TEST(Differences, do_not_depend_on_the_sensor_or_the_configuration) {
  Random random(3);
  for (const test::KnownArm& known : test::known_arms()) {
    SCOPED_TRACE(known.name);
    const Arm arm = individual(known.drawing, random);
    const auto here = estimate_of(arm, some_readings(arm, 0.4), kBase, kTool_F);
    const auto there = estimate_of(arm, some_readings(arm, 0.7), random.pose(3), kTool_F);
    expect_same(found(known.drawing, *here), found(known.drawing, *there));
  }
}

// The same arm by other rows: the frame of link 2 stands elsewhere along its two parallel axes, the
// base and the last frame are others.
TEST(Differences, do_not_depend_on_the_rows_that_describe_the_drawing) {
  Random random(4);
  const Arm drawing = test::puma560();
  Arm other = drawing;
  other.joints[1].d_m += 0.2;
  other.joints[2].d_m -= 0.2;
  other.joints[5].d_m += 0.1;
  // Row 1 with its common normal the other way round.
  other.joints[3].theta_rad += kPi;
  other.joints[3].alpha_rad = -other.joints[3].alpha_rad;
  other.joints[4].theta_rad += kPi;
  const Arm arm = individual(drawing, random);
  const auto estimate = estimate_of(arm, some_readings(arm, 0.4), kBase, kTool_F);
  expect_same(found(drawing, *estimate), found(other, *estimate));
}

// The least root mean square of the distances of the drawing's tool from the arm's, by products of
// Denavit-Hartenberg rows and a descent by differences over base and tool.
double fitted_distance_m(const Arm& drawing, const Arm& arm) {
  constexpr int kCount = 1000;  // as differences() takes
  using Unknowns = Eigen::Matrix<double, 9, 1>;
  struct Place {
    Pose X_B6;    // of the drawing
    Vector3 p_S;  // of the arm's tool
  };
  const auto types = types_of(arm.joints);
  std::vector<Place> places;
  for (int k = 0; k < kCount; ++k) {
    const JointVector q = evenly_spread_configuration(types, arm.limits, k + 1);
    places.push_back({test::plain_dh_pose(drawing.joints, q, types.size(), Pose{}),
                      test::plain_dh_pose(arm.joints, q, types.size(), kBase) * kTool_F});
  }
  const auto residuals = [&](const Unknowns& x) {
    const double angle = x.head<3>().norm();
    Pose X = kBase;
    X.p += x.segment<3>(3);
    if (angle > 0) X.R = X.R * rotation_about(x.head<3>() / angle, angle);
    Eigen::VectorXd apart(3 * kCount);
    for (int k = 0; k < kCount; ++k) {
      const Place& place = places[static_cast<std::size_t>(k)];
      apart.segment<3>(3 * k) = X * (place.X_B6 * Vector3(kTool_F + x.tail<3>())) - place.p_S;
    }
    return apart;
  };
  Unknowns x = Unknowns::Zero();
  for (int step = 0; step < 6; ++step) {
    constexpr double kStep = 1e-6;
    Eigen::MatrixXd J(3 * kCount, 9);
    for (int c = 0; c < 9; ++c) {
      J.col(c) =
          (residuals(x + Unknowns::Unit(c) * kStep) - residuals(x - Unknowns::Unit(c) * kStep)) /
          (2 * kStep);
    }
    // A slide of the base along axes that are all parallel is one of the tool, too.
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
    decomposition.setThreshold(1e-6);
    x -= Unknowns(decomposition.compute(J).solve(residuals(x)));
  }
  return std::sqrt(residuals(x).squaredNorm() / kCount);
}

TEST(Differences, add_up_to_the_displacement_of_the_tool) {
  Random random(5);
  for (const double times : {1.0, 10.0}) {
    for (const test::KnownArm& known : test::known_arms()) {
      SCOPED_TRACE(known.name);
      const Arm arm = individual(known.drawing, random, times);
      const auto estimate = estimate_of(arm, some_readings(arm, 0.4), kBase, kTool_F);
      const Differences differences = found(known.drawing, *estimate);
      // Readings of a coupled arm would have to be coupled here, too: none of these is.
      const double total_m = fitted_distance_m(known.drawing, arm);
      EXPECT_NEAR(differences.total_rms_m, total_m, 1e-4 * total_m);
      EXPECT_NEAR(sum_of_effects(differences), total_m, 2e-3 * total_m);
      const auto drawn = fitted_drawing(known.drawing, *estimate, 0);
      ASSERT_TRUE(drawn.has_value());
      const JointVector q = some_readings(arm, 0.6);
      const Vector3 p_arm =
          kinematics::target_position(estimate->signature, q, estimate->signature.targets[0]);
      const Vector3 p_drawn = kinematics::target_position(*drawn, q, drawn->targets[0]);
      EXPECT_LT((p_arm - p_drawn).norm(), 5 * total_m);
    }
  }
}

// Lines as uncertain as the estimate says: the values scatter by the stated sigma.
TEST(Differences, scatter_by_the_sigma_they_state) {
  constexpr int kTrials = 40;
  Random random(6);
  std::mt19937 generator(6);
  std::normal_distribution<double> normal;
  const Arm drawing = test::ur5();
  const auto truth =
      estimate_of(individual(drawing, random), some_readings(drawing, 0.4), kBase, kTool_F);
  const Differences true_differences = found(drawing, *truth);
  const auto estimate = exact(truth->signature);
  const auto layout = calibration::make_layout(truth->signature, {true}, {}, 0);
  ASSERT_TRUE(layout.has_value());
  estimate->layout = *layout;
  estimate->information.reset(layout->size());
  FixedVector<double, calibration::kMaxParameters> sigma;
  for (std::size_t c = 0; c < layout->size(); ++c) {
    sigma.push_back(random.uniform(0.5e-4, 2e-4));
    estimate->information.set_entry(c, c, 1 / sigma[c]);
  }
  FixedVector<double, kMaxJoints * kCauses> squares(true_differences.all.size(), 0.0);
  for (int trial = 0; trial < kTrials; ++trial) {
    estimate->signature = truth->signature;
    for (std::size_t i = 0; i < drawing.joints.size(); ++i) {
      Pose& X_SL = estimate->signature.X_SL[i];
      const std::size_t c = layout->axis[i];
      // One after the other: the order in an expression is the compiler's.
      const double shift_y_m = normal(generator) * sigma[c + 3];
      const double shift_x_m = normal(generator) * sigma[c + 2];
      const double tilt_y_rad = normal(generator) * sigma[c + 1];
      const double tilt_x_rad = normal(generator) * sigma[c];
      X_SL.p += X_SL.R.col(0) * shift_x_m + X_SL.R.col(1) * shift_y_m;
      X_SL.R = X_SL.R * rotation_about(Vector3::UnitX(), tilt_x_rad) *
               rotation_about(Vector3::UnitY(), tilt_y_rad);
    }
    const Differences differences = found(drawing, *estimate);
    ASSERT_EQ(differences.all.size(), true_differences.all.size());
    for (std::size_t k = 0; k < differences.all.size(); ++k) {
      const double off = differences.all[k].value - true_differences.all[k].value;
      squares[k] += off * off / (differences.all[k].sigma * differences.all[k].sigma);
    }
  }
  for (std::size_t k = 0; k < squares.size(); ++k) {
    SCOPED_TRACE(k);
    EXPECT_GT(squares[k] / kTrials, 0.5);
    EXPECT_LT(squares[k] / kTrials, 1.6);
  }
}

// With gains and eccentric encoders the arm is another one; what the lines hold of them at the
// signature configuration is not laid to the zeros.
TEST(Differences, tell_the_errors_of_the_readings_apart_from_the_zeros) {
  const Arm drawing = test::puma560();
  const JointVector configuration = some_readings(drawing, 0.4);
  const calibration::ReadingCorrection correction{.gain = 1e-3, .sin_1 = 2e-3};
  // Where the encoders read the configuration, the joints have turned as far as the errors say.
  JointVector turned = configuration;
  for (double& q : turned) q = calibration::corrected(correction, q);
  auto estimate = estimate_of(drawing, turned, kBase, kTool_F);
  estimate->signature.configuration = configuration;
  estimate->readings.corrections.resize(6, correction);
  const Differences differences = found(drawing, *estimate);
  for (std::size_t joint = 0; joint < 6; ++joint) {
    EXPECT_NEAR(value_of(differences, joint, Cause::kScale), 1e-3, 1e-12);
    EXPECT_NEAR(value_of(differences, joint, Cause::kOnceATurn), 2e-3, 1e-12);
  }
  for (std::size_t joint = 1; joint < 5; ++joint) {
    EXPECT_NEAR(value_of(differences, joint, Cause::kZero), 0, 1e-6);
  }
  EXPECT_NEAR(sum_of_effects(differences), differences.total_rms_m, 1e-3 * differences.total_rms_m);
}

TEST(Differences, are_refused_of_an_arm_that_is_not_the_drawings) {
  const Arm drawing = test::puma560();
  Arm arm = drawing;
  arm.joints[0].alpha_rad = radians(90.0);
  arm.joints[2].alpha_rad = radians(-90.0);
  const auto estimate = estimate_of(arm, some_readings(arm, 0.4), kBase, kTool_F);
  const auto result = differences(drawing, *estimate, 0);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(test::failure_of(result), Error::kNotConverged);
}

}  // namespace
}  // namespace armsig::differences
