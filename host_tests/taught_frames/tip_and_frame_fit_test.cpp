// SPDX-License-Identifier: MIT
// Tips and frames by least squares. Golden values are of numpy 1.24: lstsq for the tip; for the
// frame Newton's method on three angles with a Hessian by differences.
#include <gtest/gtest.h>

#include "firmware/host_tool/taught_frames/frame_fit.hpp"
#include "firmware/host_tool/taught_frames/tip_fit.hpp"
#include "host_tests/taught_frames/random_poses.hpp"

namespace armsig::tool {
namespace {

using taught::by_abc;

constexpr std::array<bool, 3> kOrigin{true, true, true};
constexpr std::array<bool, 3> kOnX{false, true, true};
constexpr std::array<bool, 3> kOnY{true, false, true};
constexpr std::array<bool, 3> kInXy{false, false, true};

void expect_near(const Vector3& value, const Vector3& expected, double tolerance) {
  EXPECT_LT((value - expected).norm(), tolerance) << value.transpose();
}

// In metres, of what a controller shows in millimetres.
Pose shown_pose(double x, double y, double z, double a, double b, double c) {
  return {by_abc(a, b, c), 1e-3 * Vector3(x, y, z)};
}

std::vector<Pose> golden_poses() {
  return {shown_pose(822.65, -108.92, 610.94, 10, 170, -5),
          shown_pose(719.86, -93.65, 566.53, 40, 150, 20),
          shown_pose(768.68, -133.37, 596.31, -35, 160, -25),
          shown_pose(862.04, 30.09, 551.0, 5, -175, 35),
          shown_pose(816.03, -163.04, 605.94, 90, 165, 0)};
}

TEST(TipFit, agrees_with_numpy) {
  const TipFit fit = fit_tip(golden_poses());
  expect_near(fit.t_E, 1e-3 * Vector3(11.623348546071899, -34.12825957189443, 210.06714932765476),
              1e-14);
  expect_near(fit.tip_C, 1e-3 * Vector3(850.2267483164334, -119.94954761937322, 399.95400004568296),
              1e-14);
  EXPECT_NEAR(std::sqrt(fit.residual_squares() / 5), 0.14867923241044356e-3, 1e-14);
}

TEST(TipFit, has_the_derivatives_that_differences_have) {
  std::mt19937 random(1);
  const Vector3 t_E(0.02, -0.05, 0.2);
  std::vector<Pose> poses;
  for (int k = 0; k < 4; ++k) {
    poses.push_back(
        taught::flange_at(taught::any_rotation(random, 0.5), t_E, Vector3(0.7, 0.1, 0.4)));
  }
  const TipFit fit = fit_tip(poses);
  constexpr double kStep = 1e-6;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    for (Eigen::Index number = 0; number < 6; ++number) {
      std::vector<Pose> above = poses;
      std::vector<Pose> below = poses;
      above[k] = taught::moved_pose(poses[k], number, kStep);
      below[k] = taught::moved_pose(poses[k], number, -kStep);
      const TipFit up = fit_tip(above);
      const TipFit down = fit_tip(below);
      const Eigen::VectorXd stated = fit.by_poses.col(static_cast<Eigen::Index>(6 * k) + number);
      expect_near(stated.head<3>(), (up.t_E - down.t_E) / (2 * kStep), 1e-7);
      expect_near(stated.tail<3>(), (up.tip_C - down.tip_C) / (2 * kStep), 1e-7);
    }
  }
}

TEST(LeastTurned, is_the_axis_about_which_all_poses_turn) {
  const Vector3 axis = Vector3(1, 2, 2) / 3;
  std::vector<Pose> poses;
  for (const double angle : {0.0, 0.4, 1.1}) poses.push_back({rotation_about(axis, angle), {}});
  const LeastTurned least = least_turned(poses);
  EXPECT_NEAR(std::abs(least.direction_E.dot(axis)), 1, 1e-12);
  EXPECT_NEAR(least.angle_rad, 0, 1e-7);
}

TEST(LeastTurned, is_by_how_much_the_poses_tilt_it) {
  std::vector<Pose> poses{{Matrix3::Identity(), {}},
                          {rotation_x(radians(90)), {}},
                          {rotation_about(Vector3::UnitY(), radians(10)), {}}};
  // About x by much and about y by little: x is what turns least, by those 10 degrees.
  const LeastTurned least = least_turned(poses);
  EXPECT_NEAR(degrees(least.angle_rad), 10, 1);
  EXPECT_GT(std::abs(least.direction_E.x()), 0.9);
}

TEST(FrameFit, is_that_of_three_points) {
  const Pose start{rotation_z(1), Vector3(1, 2, 2)};
  const auto fit =
      fit_frame({{Vector3(1, 2, 3), kOrigin}, {Vector3(1, 4, 3), kOnX}, {Vector3(0, 5, 3), kInXy}},
                start, FrameOrigin::kToBeFound);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->freedom, 0U);
  expect_near(fit->X_AW.p, {1, 2, 3}, 1e-12);
  expect_near(fit->X_AW.R.col(0), {0, 1, 0}, 1e-12);
  expect_near(fit->X_AW.R.col(1), {-1, 0, 0}, 1e-12);
  expect_near(fit->X_AW.R.col(2), {0, 0, 1}, 1e-12);
}

// Two points on x and one on y, whose foot on x is the origin.
TEST(FrameFit, finds_an_origin_that_nobody_touched) {
  const auto fit =
      fit_frame({{Vector3(2, 0, 1), kOnX}, {Vector3(5, 0, 1), kOnX}, {Vector3(1, 4, 1), kOnY}},
                Pose{rotation_x(0.3), Vector3(0.5, 0.2, 1)}, FrameOrigin::kToBeFound);
  ASSERT_TRUE(fit);
  expect_near(fit->X_AW.p, {1, 0, 1}, 1e-12);
  EXPECT_LT((fit->X_AW.R - Matrix3::Identity()).norm(), 1e-12);
}

TEST(FrameFit, agrees_with_an_independent_least_squares) {
  const auto mm = [](double x, double y, double z) { return Vector3(1e-3 * Vector3(x, y, z)); };
  const std::vector<FramePoint> points{
      {mm(700.28, 199.46, 99.82), kOrigin}, {mm(699.24, 199.48, 99.26), kOrigin},
      {mm(809.88, 245.99, 88.13), kOnX},    {mm(975.0, 316.17, 69.04), kOnX},
      {mm(640.76, 337.68, 92.59), kOnY},    {mm(811.84, 442.54, 70.69), kInXy},
      {mm(634.02, 454.59, 82.75), kInXy}};
  const auto fit = fit_frame(points, {rotation_z(0.3), mm(690, 190, 90)}, FrameOrigin::kToBeFound);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->freedom, 8U);
  EXPECT_NEAR(fit->residual_squares(), 1.3062624792715907e-6, 1e-15);
  expect_near(fit->X_AW.p, mm(699.8561724288428, 199.52517234507522, 99.74644737689003), 1e-9);
  const Matrix3 R = by_abc(degrees(0.4005283726684105), degrees(0.10162670389487405),
                           degrees(-0.049170568112774295));
  EXPECT_LT(angle_between(fit->X_AW.R, R), 1e-8);
}

TEST(FrameFit, has_the_derivatives_that_differences_have) {
  std::mt19937 random(2);
  const Pose X_AW{taught::any_rotation(random, 1), Vector3(0.5, 0.2, 0.1)};
  std::vector<FramePoint> points;
  for (const auto& [p_W, zero] :
       {std::pair(Vector3(0, 0, 0), kOrigin), std::pair(Vector3(0.1, 0, 0), kOnX),
        std::pair(Vector3(0.3, 0, 0), kOnX), std::pair(Vector3(0, 0.2, 0), kOnY),
        std::pair(Vector3(0.2, 0.3, 0), kInXy)}) {
    points.push_back({X_AW * p_W, zero});
  }
  for (const FrameOrigin origin : {FrameOrigin::kToBeFound, FrameOrigin::kKnown}) {
    const auto fit = fit_frame(points, X_AW, origin);
    ASSERT_TRUE(fit);
    constexpr double kStep = 1e-6;
    for (Eigen::Index column = 0; column < 15; ++column) {
      std::vector<FramePoint> above = points;
      std::vector<FramePoint> below = points;
      above[static_cast<std::size_t>(column / 3)].p_A[column % 3] += kStep;
      below[static_cast<std::size_t>(column / 3)].p_A[column % 3] -= kStep;
      const auto up = fit_frame(above, X_AW, origin);
      const auto down = fit_frame(below, X_AW, origin);
      ASSERT_TRUE(up && down);
      expect_near(fit->by_points.col(column).head<3>(), (up->X_AW.p - down->X_AW.p) / (2 * kStep),
                  1e-6);
      expect_near(fit->by_points.col(column).tail<3>(),
                  rotation_vector(down->X_AW.R.transpose() * up->X_AW.R) / (2 * kStep), 1e-6);
    }
  }
}

TEST(FrameFit, needs_points_that_determine_it) {
  const std::vector<FramePoint> on_a_line{
      {Vector3(0, 0, 0), kOrigin}, {Vector3(1, 0, 0), kOnX}, {Vector3(2, 0, 0), kInXy}};
  EXPECT_FALSE(fit_frame(on_a_line, Pose{}, FrameOrigin::kToBeFound));
  const std::vector<FramePoint> too_few{{Vector3(0, 0, 0), kOrigin}, {Vector3(1, 0, 0), kOnX}};
  EXPECT_FALSE(fit_frame(too_few, Pose{}, FrameOrigin::kToBeFound));
}

TEST(FrameAlong, has_right_handed_axes_whichever_are_given) {
  for (int main = 0; main < 3; ++main) {
    for (int second = 0; second < 3; ++second) {
      if (second == main) continue;
      const Pose X =
          frame_along(Vector3(1, 2, 3), main, Vector3(0, 2, 0), second, Vector3(0.1, 1, 1));
      EXPECT_NEAR(X.R.determinant(), 1, 1e-12);
      EXPECT_GT(X.R.col(second).dot(Vector3(0.1, 0, 1)), 0);
      expect_near(X.R.col(main), Vector3::UnitY(), 1e-12);
    }
  }
}

}  // namespace
}  // namespace armsig::tool
