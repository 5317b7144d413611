// SPDX-License-Identifier: MIT
#include "core/frames/alignment.hpp"

#include <gtest/gtest.h>

#include "core/frames/sense.hpp"
#include "host_tests/support/exact_arm.hpp"
#include "host_tests/support/known_arms.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::frames {
namespace {

SenseCheck check_sense(const Arm& nominal, const JointVector& configuration,
                       const AxisLines& identified) {
  SenseChecking checking(nominal, configuration, identified);
  while (checking.step()) {
  }
  return checking.result();
}

using test::kP;
using test::kR;

Pose some_motion() { return {rotation_z(2.0) * rotation_x(-1.0), Vector3(1.5, -0.7, 2.2)}; }

AxisLines moved(const Pose& X_AB, const AxisLines& lines_B) {
  AxisLines lines_A = lines_B;
  for (AxisLine& line : lines_A) {
    line.direction = X_AB.R * line.direction;
    line.point = X_AB * line.point;
  }
  return lines_A;
}

TEST(Align, finds_the_motion_between_two_copies_of_an_arm) {
  const AxisLines lines_B = axis_lines(test::puma560(), {0.3, -0.4, 0.9, 0.2, -0.7, 0.1});
  const Alignment alignment = align(moved(some_motion(), lines_B), lines_B);
  EXPECT_LT((alignment.X_AB.R - some_motion().R).norm(), 1e-13);
  EXPECT_LT((alignment.X_AB.p - some_motion().p).norm(), 1e-13);
  EXPECT_LT(alignment.worst_angle_rad(), 1e-13);
  EXPECT_LT(alignment.worst_distance_m(), 1e-13);
}

TEST(Align, does_not_care_where_on_its_line_a_point_stands) {
  AxisLines lines_B = axis_lines(test::puma560(), {0.3, -0.4, 0.9, 0.2, -0.7, 0.1});
  const AxisLines lines_A = moved(some_motion(), lines_B);
  for (AxisLine& line : lines_B) line.point += 0.4 * line.direction;
  EXPECT_LT((align(lines_A, lines_B).X_AB.p - some_motion().p).norm(), 1e-13);
}

TEST(Align, ignores_the_point_of_a_prismatic_joint) {
  AxisLines lines_B = axis_lines(test::stanford(), {0.3, -0.4, 0.5, 0.2, -0.7, 0.1});
  const AxisLines lines_A = moved(some_motion(), lines_B);
  lines_B[2].point += Vector3(5, 6, 7);
  const Alignment alignment = align(lines_A, lines_B);
  EXPECT_LT((alignment.X_AB.p - some_motion().p).norm(), 1e-13);
  EXPECT_EQ(alignment.joints[2].distance_m, 0.0);
}

// Least squares by hand: one direction of three is off, with equal weights and no moments.
TEST(Align, shares_an_error_of_direction_among_the_joints) {
  const Vector3 z = Vector3::UnitZ();
  AxisLines lines_B{{kP, z}, {kP, z}, {kP, z}};
  AxisLines lines_A = lines_B;
  lines_A[0].direction = rotation_x(0.03) * z;
  const Alignment alignment = align(lines_A, lines_B);
  EXPECT_NEAR(alignment.joints[0].angle_rad, 0.02, 1e-5);
  EXPECT_NEAR(alignment.joints[1].angle_rad, 0.01, 1e-5);
}

TEST(Align, tells_how_far_each_joint_is_off) {
  const AxisLines lines_B = axis_lines(test::ur5(), JointVector{0.3, -0.9, 0.9, 0.2, -0.7, 0.1});
  AxisLines lines_A = moved(some_motion(), lines_B);
  lines_A[4].direction = (lines_A[4].direction + 1e-3 * some_motion().R.col(0)).normalized();
  const Alignment alignment = align(lines_A, lines_B);
  EXPECT_GT(alignment.joints[4].angle_rad, 3e-4);
  EXPECT_EQ(alignment.worst_angle_rad(), alignment.joints[4].angle_rad);
  EXPECT_LT(alignment.worst_angle_rad(), 1e-3);
}

// The sum of squares that the header states, by cross products.
double sum_of_squares(const AxisLines& lines_A, const AxisLines& lines_B, const Pose& X_AB) {
  double sum_m2 = 0;
  for (std::size_t i = 0; i < lines_A.size(); ++i) {
    const Vector3& axis_A = lines_A[i].direction;
    sum_m2 += (arm_size(lines_A) * (X_AB.R * lines_B[i].direction - axis_A)).squaredNorm();
    if (lines_A[i].type == kP) continue;
    sum_m2 += (X_AB * lines_B[i].point - lines_A[i].point).cross(axis_A).squaredNorm();
  }
  return sum_m2;
}

struct Misbuilt {
  AxisLines lines_A;
  AxisLines lines_B;
};

// Axes of an arm that was built ten times worse than usual, and those of its drawing.
Misbuilt misbuilt(test::Random& random, bool with_slide) {
  const test::Tolerances bad{radians(1), radians(2), 5e-3};
  test::Cell cell = test::puma_cell(random, bad);
  Arm drawing = test::puma();
  if (with_slide) cell.arm.joints[3].type = drawing.joints[3].type = kP;
  const JointVector q = test::cell_configuration();
  return {moved(cell.X_SB, axis_lines(cell.arm, q)), axis_lines(drawing, q)};
}

TEST(Align, no_small_motion_brings_the_axes_of_a_misbuilt_arm_nearer) {
  test::Random random(1);
  for (int trial = 0; trial < 40; ++trial) {
    const auto [lines_A, lines_B] = misbuilt(random, trial % 2 == 1);
    const Alignment found = align(lines_A, lines_B);
    EXPECT_NEAR(found.cost_m2, sum_of_squares(lines_A, lines_B, found.X_AB), 1e-15);
    for (int k = 0; k < 20; ++k) {
      const Matrix3 turn = rotation_about(random.direction(), 1e-5);
      const Pose X_near{turn * found.X_AB.R, turn * found.X_AB.p + random.normal_vector(1e-5)};
      EXPECT_GT(sum_of_squares(lines_A, lines_B, X_near), found.cost_m2) << trial;
    }
  }
}

TEST(Align, comes_near_a_minimum_in_a_few_steps_from_each_start) {
  constexpr int kTrials = 40;
  test::Random random(2);
  int steps = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto [lines_A, lines_B] = misbuilt(random, trial % 2 == 1);
    Aligning aligning(lines_A, lines_B);
    do {
      ++steps;
    } while (aligning.step());
  }
  EXPECT_LT(steps, 6.5 * 24 * kTrials);
}

TEST(Align, looks_no_further_where_nothing_is_left) {
  const AxisLines lines = axis_lines(test::puma560(), {0.3, -0.4, 0.9, 0.2, -0.7, 0.1});
  Aligning aligning(lines, lines);
  int steps = 1;
  while (aligning.step()) ++steps;
  EXPECT_EQ(steps, 2);
  EXPECT_FALSE(aligning.step());
}

TEST(Align, parallel_axes_are_not_slid_along) {
  const AxisLines lines_B = axis_lines(test::cobra600(), {0.3, -0.9, 0.1, 0.2});
  const Pose X_AB{rotation_z(1.0), Vector3(0.2, 0.3, 0.0)};
  const Alignment alignment = align(moved(X_AB, lines_B), lines_B);
  EXPECT_LT((alignment.X_AB.R - X_AB.R).norm(), 1e-13);
  EXPECT_LT((alignment.X_AB.p - X_AB.p).norm(), 1e-13);
}

TEST(Align, nearly_parallel_axes_are_not_slid_along_for_a_millimetre) {
  const AxisLines lines_B{{kR, Vector3::UnitZ(), {0, 0, 0}},
                          {kR, rotation_x(1e-3) * Vector3::UnitZ(), {0.4, 0, 0}},
                          {kR, rotation_x(-1e-3) * Vector3::UnitZ(), {0.7, 0, 0}}};
  AxisLines lines_A = lines_B;
  lines_A[1].point.y() += 1e-3;
  EXPECT_LT(align(lines_A, lines_B).X_AB.p.norm(), 2e-3);
}

TEST(Align, leaves_the_turn_about_a_single_axis_at_the_identity) {
  const AxisLines one{{kR, Vector3::UnitZ(), {0.1, 0.2, 0.3}}};
  const Alignment alignment = align(one, one);
  EXPECT_TRUE(alignment.X_AB.R.isIdentity(1e-12));
  EXPECT_LT(alignment.X_AB.p.norm(), 1e-12);
}

TEST(Align, leaves_the_translation_of_prismatic_joints_at_zero) {
  const AxisLines lines_B{{kP, Vector3::UnitX(), {4, 5, 6}}, {kP, Vector3::UnitY(), {7, 8, 9}}};
  const Alignment alignment = align(moved(some_motion(), lines_B), lines_B);
  EXPECT_LT((alignment.X_AB.R - some_motion().R).norm(), 1e-13);
  EXPECT_LT(alignment.X_AB.p.norm(), 1e-13);
}

TEST(Align, traps_when_the_counts_differ) {
  const AxisLines one{{kR, Vector3::UnitZ(), {0, 0, 0}}};
  EXPECT_DEATH((void)align(one, {}), "");
}

// Axes of `arm` in a sensor frame, with some joints turning backwards.
AxisLines seen(const Arm& arm, const JointVector& q, std::initializer_list<std::size_t> reversed) {
  AxisLines lines = moved(some_motion(), axis_lines(arm, q));
  for (const std::size_t joint : reversed) lines[joint].direction *= -1.0;
  return lines;
}

JointVector some_readings() { return {0.3, -0.4, 0.9, 0.2, -0.7, 0.1}; }

TEST(CheckSense, accepts_an_arm_against_its_own_drawing) {
  const SenseCheck check =
      check_sense(test::puma560(), some_readings(), seen(test::puma560(), some_readings(), {}));
  EXPECT_EQ(check.verdict, SenseVerdict::kAgrees);
  EXPECT_LT(check.angle_rad, 1e-13);
  EXPECT_LT(check.distance_m, 1e-13);
}

TEST(CheckSense, accepts_zeros_a_dozen_degrees_from_the_drawing) {
  JointVector q = some_readings();
  for (double& reading : q) reading += radians(12);
  EXPECT_EQ(check_sense(test::puma560(), some_readings(), seen(test::puma560(), q, {})).verdict,
            SenseVerdict::kAgrees);
}

TEST(CheckSense, names_a_joint_whose_reading_is_negated) {
  JointVector q = some_readings();
  q[2] = -q[2];
  const SenseCheck check =
      check_sense(test::puma560(), q, seen(test::puma560(), some_readings(), {2}));
  EXPECT_EQ(check.verdict, SenseVerdict::kJointsReversed);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(check.reversed[i], i == 2) << i;
}

TEST(CheckSense, names_a_joint_whose_reading_is_negated_about_the_signature_configuration) {
  const SenseCheck check =
      check_sense(test::puma560(), some_readings(), seen(test::puma560(), some_readings(), {4}));
  EXPECT_EQ(check.verdict, SenseVerdict::kJointsReversed);
  EXPECT_TRUE(check.reversed[4]);
}

TEST(CheckSense, names_both_of_two_reversed_joints) {
  JointVector q = some_readings();
  q[0] = -q[0];
  q[3] = -q[3];
  const SenseCheck check =
      check_sense(test::puma560(), q, seen(test::puma560(), some_readings(), {0, 3}));
  EXPECT_EQ(check.verdict, SenseVerdict::kJointsReversed);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(check.reversed[i], i == 0 || i == 3) << i;
}

TEST(CheckSense, names_a_reversed_prismatic_joint) {
  const SenseCheck check =
      check_sense(test::stanford(), some_readings(), seen(test::stanford(), some_readings(), {2}));
  EXPECT_EQ(check.verdict, SenseVerdict::kJointsReversed);
  EXPECT_TRUE(check.reversed[2]);
}

TEST(CheckSense, recognises_left_handed_sensor_coordinates) {
  AxisLines lines = seen(test::stanford(), some_readings(), {});
  for (AxisLine& line : lines) {
    // x and y exchanged: a point is reflected, a direction of travel too, and the axis of a turn is
    // reflected and reversed.
    std::swap(line.point.x(), line.point.y());
    std::swap(line.direction.x(), line.direction.y());
    if (line.type == kR) line.direction *= -1.0;
  }
  const SenseCheck check = check_sense(test::stanford(), some_readings(), lines);
  EXPECT_EQ(check.verdict, SenseVerdict::kSensorMirrored);
  for (const bool reversed : check.reversed) EXPECT_FALSE(reversed);
}

TEST(CheckSense, has_no_opinion_on_a_drawing_of_another_arm) {
  Arm other = test::puma560();
  for (DhJoint& row : other.joints) row.alpha_rad += radians(60);
  EXPECT_EQ(check_sense(test::puma560(), some_readings(), seen(other, some_readings(), {})).verdict,
            SenseVerdict::kNoMatch);
}

// One axis moves away from the drawing, or turns away from it, little by little.
struct Departure {
  Vector3 shift_m;
  Vector3 turn;
};
constexpr int kDepartures = 20;

AxisLines departed(AxisLines lines, const Departure& by, int k) {
  lines[1].point += by.shift_m * k / kDepartures;
  lines[1].direction = (lines[1].direction + by.turn * k / kDepartures).normalized();
  return lines;
}

TEST(CheckSense, accepts_directions_within_20_degrees_and_lines_within_a_fifth_of_the_arm) {
  const AxisLines drawn = axis_lines(test::puma560(), some_readings());
  const AxisLines whole = seen(test::puma560(), some_readings(), {});
  for (const Departure& by : {Departure{{0.3, -0.3, 0.3}, Vector3::Zero()},
                              Departure{Vector3::Zero(), {-1.0, 1.5, 1.0}}}) {
    int accepted = 0;
    for (int k = 0; k <= kDepartures; ++k) {
      const SenseCheck check =
          check_sense(test::puma560(), some_readings(), departed(whole, by, k));
      const bool near = check.angle_rad <= radians(20) && check.distance_m <= 0.2 * arm_size(drawn);
      EXPECT_EQ(check.verdict == SenseVerdict::kAgrees, near)
          << degrees(check.angle_rad) << " degrees, " << check.distance_m << " m";
      accepted += near ? 1 : 0;
    }
    EXPECT_GT(accepted, 2);
    EXPECT_LT(accepted, kDepartures - 2) << by.turn.transpose();
  }
}

TEST(CheckSense, names_a_reversed_joint_within_10_degrees_and_a_tenth_of_the_arm_alone) {
  JointVector negated = some_readings();
  negated[2] = -negated[2];
  const AxisLines drawn = axis_lines(test::puma560(), some_readings());
  for (const Departure& by : {Departure{{0.3, -0.3, 0.3}, Vector3::Zero()},
                              Departure{Vector3::Zero(), {-1.0, 1.5, 1.0}}}) {
    int named = 0;
    for (int k = 0; k <= kDepartures; ++k) {
      const Alignment explained =
          align(departed(seen(test::puma560(), some_readings(), {}), by, k), drawn);
      const bool near = explained.worst_angle_rad() <= radians(10) &&
                        explained.worst_distance_m() <= 0.1 * arm_size(drawn);
      const SenseCheck check = check_sense(
          test::puma560(), negated, departed(seen(test::puma560(), some_readings(), {2}), by, k));
      EXPECT_EQ(check.verdict == SenseVerdict::kJointsReversed, near) << k;
      named += near ? 1 : 0;
    }
    EXPECT_GT(named, 2);
    EXPECT_LT(named, kDepartures - 2) << by.turn.transpose();
  }
}

TEST(CheckSense, cannot_tell_the_sense_of_a_single_joint) {
  const Arm one = test::make_arm({{kR, 0, 0.1, 0.2, radians(90)}}, {});
  EXPECT_EQ(check_sense(one, {0.4}, seen(one, {0.4}, {0})).verdict, SenseVerdict::kAgrees);
}

TEST(CheckSense, cannot_tell_the_sense_of_two_crossing_axes) {
  const Arm two = test::make_arm({{kR, 0, 0, 0, radians(90)}, {kR, 0, 0, 0, 0}}, {});
  EXPECT_EQ(check_sense(two, {0.4, 0.2}, seen(two, {0.4, 0.2}, {1})).verdict,
            SenseVerdict::kAgrees);
}

}  // namespace
}  // namespace armsig::frames
