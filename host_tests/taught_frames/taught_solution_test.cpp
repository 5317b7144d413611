// SPDX-License-Identifier: MIT
// Tools and work objects of rows that teach them.
#include <algorithm>

#include <gtest/gtest.h>

#include "host_tests/taught_frames/taught_session.hpp"

namespace armsig::tool {
namespace {

using taught::by_abc;
using taught::flange_at;
using taught::session_of;
using taught::TaughtSession;
using taught::TrueFrames;
using taught::without_noise;

void expect_same(const Pose& X, const Pose& expected, double tolerance) {
  EXPECT_LT((X.p - expected.p).norm(), tolerance) << X.p.transpose();
  EXPECT_LT(angle_between(X.R, expected.R), tolerance) << X.R;
}

TEST(TaughtSolution, finds_tool_and_work_object_that_were_taught) {
  const TrueFrames of;
  TaughtSession session = session_of(of, without_noise);
  const auto solved = solved_frames(session.task("torch"), session.poses());
  ASSERT_TRUE(solved) << render(solved.error());
  expect_same((*solved)[0].X, of.X_ET, 1e-12);
  expect_same((*solved)[1].X, of.X_CW, 1e-12);
  EXPECT_EQ((*solved)[0].freedom, 6U);
  EXPECT_EQ((*solved)[1].freedom, 1U);
  EXPECT_NEAR((*solved)[0].rms_m, 0, 1e-13);
}

// The golden tool: numpy's lstsq, and its axes by cross products.
TEST(TaughtSolution, agrees_with_numpy) {
  const auto shown = [](double x, double y, double z, const Matrix3& R) {
    return Pose{R, 1e-3 * Vector3(x, y, z)};
  };
  const Matrix3 R0 = by_abc(10, 170, -5);
  TaughtSession session;
  session.add("t", "tip", shown(822.65, -108.92, 610.94, R0));
  session.add("t", "tip", shown(719.86, -93.65, 566.53, by_abc(40, 150, 20)));
  session.add("t", "tip", shown(768.68, -133.37, 596.31, by_abc(-35, 160, -25)));
  session.add("t", "tip", shown(862.04, 30.09, 551.0, by_abc(5, -175, 35)));
  session.add("t", "tip", shown(816.03, -163.04, 605.94, by_abc(90, 165, 0)));
  session.add("t", "x+", shown(887.76, -126.1, 684.97, R0));
  session.add("t", "z+", shown(768.06, -94.63, 682.7, R0));
  const auto solved = solved_frames(session.task(), session.poses());
  ASSERT_TRUE(solved);
  const Matrix3 R_ET{{0.7310913492254416, -0.41204570264491414, -0.5438049080502882},
                     {0.22700791164887132, 0.898534201417996, -0.37563772032497283},
                     {0.6434072171933896, 0.151177471251451, 0.7504482161012012}};
  EXPECT_LT(((*solved)[0].X.R - R_ET).norm(), 1e-12);
  EXPECT_NEAR((*solved)[0].rms_m, 0.14867923241044356e-3, 1e-14);
}

TEST(TaughtSolution, takes_the_fixed_tip_on_either_side_of_the_tool) {
  const TrueFrames of;
  TaughtSession session = session_of(of, without_noise);
  const auto solved = solved_frames(session.task("torch"), session.poses());
  // The same place of the arm, named from the other side, is an axis turned about.
  std::ranges::find(session.rows(), "x-", [](const TaughtRow& row) {
    return row.point->name;
  })->point = std::ranges::find(kTaughtPoints, "x+", &TaughtPoint::name);
  const auto turned = solved_frames(session.task("torch"), session.poses());
  ASSERT_TRUE(solved && turned);
  EXPECT_LT(((*solved)[0].X.R.col(0) + (*turned)[0].X.R.col(0)).norm(), 1e-12);
  EXPECT_LT(((*solved)[0].X.R.col(2) - (*turned)[0].X.R.col(2)).norm(), 1e-12);
}

// The direction that is taught first is kept, the second gives the side.
TEST(TaughtSolution, keeps_the_direction_that_is_taught_first) {
  const TrueFrames of;
  TaughtSession session = session_of(of, without_noise);
  std::swap(session.rows()[4], session.rows()[5]);
  std::swap(session.poses()[4], session.poses()[5]);
  const auto solved = solved_frames(session.task("torch"), session.poses());
  ASSERT_TRUE(solved);
  // The z point was taught 20 mm beside the axis, 150 mm away.
  EXPECT_NEAR(angle_between((*solved)[0].X.R, of.X_ET.R), std::atan2(0.02, 0.15), 1e-12);
}

TEST(TaughtSolution, has_the_axes_of_the_flange_without_directions) {
  const TrueFrames of;
  TaughtSession session = session_of(of, without_noise);
  session.rows().resize(4);
  session.poses().resize(4);
  const auto solved = solved_frames(session.task(), session.poses());
  ASSERT_TRUE(solved);
  EXPECT_FALSE((*solved)[0].oriented);
  EXPECT_EQ((*solved)[0].X.R, Matrix3::Identity());
}

// Each number of each pose moved: the whole solution again, by way of the tip too.
TEST(TaughtSolution, has_the_derivatives_that_differences_have) {
  TaughtSession session = session_of(TrueFrames{}, without_noise);
  const TaughtTask task = session.task("torch");
  const auto solved = solved_frames(task, session.poses());
  ASSERT_TRUE(solved);
  constexpr double kStep = 1e-6;
  for (std::size_t k = 0; k < session.poses().size(); ++k) {
    for (Eigen::Index number = 0; number < 6; ++number) {
      const auto moved = [&](double by) {
        std::vector<Pose> poses = session.poses();
        poses[k] = taught::moved_pose(poses[k], number, by);
        return *solved_frames(task, poses);
      };
      const auto above = moved(kStep);
      const auto below = moved(-kStep);
      for (std::size_t f = 0; f < 2; ++f) {
        Eigen::Vector<double, 6> difference;
        difference << above[f].X.p - below[f].X.p,
            rotation_vector(below[f].X.R.transpose() * above[f].X.R);
        const auto column = static_cast<Eigen::Index>(6 * k) + number;
        EXPECT_LT(((*solved)[f].by_rows.col(column) - difference / (2 * kStep)).norm(), 2e-6)
            << "frame " << f << ", row " << k << ", number " << number;
      }
    }
  }
}

TEST(TaughtSolution, has_the_derivative_by_a_tip_that_is_given) {
  const TrueFrames of;
  TaughtSession session = session_of(of, without_noise);
  const auto by_tip = solved_frames(session.task("", of.X_ET.p), session.poses());
  ASSERT_TRUE(by_tip);
  constexpr double kStep = 1e-6;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Vector3 step = kStep * Vector3::Unit(axis);
    const auto above = solved_frames(session.task("", of.X_ET.p + step), session.poses());
    const auto below = solved_frames(session.task("", of.X_ET.p - step), session.poses());
    const Vector3 difference = ((*above)[1].X.p - (*below)[1].X.p) / (2 * kStep);
    EXPECT_LT(((*by_tip)[1].by_tip.col(axis).head<3>() - difference).norm(), 1e-6);
  }
}

// --- Refusals ---------------------------------------------------------------------------------

void expect_refused(TaughtSession& session, const std::string& words) {
  const Problem problem = test::failure_of(solved_frames(session.task(), session.poses()));
  EXPECT_NE(problem.what.find(words), std::string::npos) << problem.what;
  EXPECT_FALSE(problem.expected.empty());
}

// Touches of one tip in these orientations.
TaughtSession touches_of(const std::vector<Matrix3>& orientations) {
  TaughtSession session;
  for (const Matrix3& R : orientations) {
    session.add("torch", "tip", flange_at(R, Vector3(0.01, 0.02, 0.2), Vector3(0.8, 0, 0.3)));
  }
  return session;
}

TEST(TaughtSolution, refuses_touches_that_are_too_few) {
  TaughtSession session = touches_of({by_abc(0, 0, 0), by_abc(30, 40, 0)});
  expect_refused(session, "tool \"torch\": 2 points of one tip");
}

TEST(TaughtSolution, refuses_touches_that_turn_about_one_axis_or_hardly) {
  TaughtSession one_axis =
      touches_of({by_abc(0, 0, 0), by_abc(40, 0, 0), by_abc(90, 0, 0), by_abc(130, 0, 0)});
  expect_refused(one_axis,
                 "along the direction 0.00, 0.00, 1.00 of the flange its touches turn by 0.0 deg");
  TaughtSession hardly =
      touches_of({by_abc(0, 0, 0), by_abc(1, 2, 0), by_abc(0, 2, 3), by_abc(3, 0, 1)});
  expect_refused(hardly, "deg at most, and leave the tip open");
  TaughtSession enough =
      touches_of({by_abc(0, 0, 0), by_abc(0, 8, 0), by_abc(0, 0, 8), by_abc(8, -8, 0)});
  EXPECT_TRUE(solved_frames(enough.task(), enough.poses()));
}

TEST(TaughtSolution, refuses_touches_of_more_than_one_tip) {
  TaughtSession session =
      touches_of({by_abc(0, 0, 0), by_abc(0, 40, 0), by_abc(0, 0, 40), by_abc(40, 0, 20)});
  session.poses()[2].p.x() += 0.1;
  expect_refused(session, "its touches miss one tip by ");
}

TEST(TaughtSolution, refuses_directions_that_give_no_orientation) {
  const TrueFrames of;
  TaughtSession one = session_of(of, without_noise);
  one.rows().resize(5);
  one.poses().resize(5);
  expect_refused(one, "directions of one axis");
  TaughtSession line = session_of(of, without_noise);
  line.rows().resize(6);
  line.poses().resize(6);
  line.poses()[5].p = line.poses()[0].p + 2 * (line.poses()[4].p - line.poses()[0].p);
  expect_refused(line, "its directions are on one line");
  TaughtSession near = session_of(of, without_noise);
  near.poses()[4].p = near.poses()[0].p + Vector3(0.001, 0, 0);
  expect_refused(near, "at line 6 the fixed tip is 1.0 mm from the tool's tip");
}

// Points of a work object at these places, touched by the bare flange.
TaughtSession object_of(const std::vector<std::pair<std::string_view, Vector3>>& points) {
  TaughtSession session;
  for (const auto& [point, p_C] : points) {
    session.add("table", point, flange_at(by_abc(10, 170, 0), Vector3::Zero(), p_C));
  }
  return session;
}

TEST(TaughtSolution, takes_two_points_on_x_and_one_on_y) {
  TaughtSession session = object_of(
      {{"x", Vector3(0.5, 0.1, 0)}, {"x", Vector3(0.8, 0.1, 0)}, {"y", Vector3(0.4, 0.4, 0)}});
  const auto solved = solved_frames(session.task(), session.poses());
  ASSERT_TRUE(solved) << render(solved.error());
  expect_same((*solved)[0].X, {Matrix3::Identity(), Vector3(0.4, 0.1, 0)}, 1e-12);
}

TEST(TaughtSolution, refuses_points_on_a_line) {
  TaughtSession session = object_of(
      {{"origin", Vector3(0.5, 0, 0)}, {"x", Vector3(0.7, 0, 0)}, {"xy", Vector3(0.9, 0.003, 0)}});
  expect_refused(session, "work object \"table\": its points are on a line but for 3.0 mm");
}

TEST(TaughtSolution, refuses_points_that_are_too_few_or_on_one_place) {
  TaughtSession no_side = object_of({{"origin", {0.5, 0, 0}}, {"x", {0.7, 0, 0}}});
  expect_refused(no_side, "no point beside its axis x");
  TaughtSession no_axis = object_of({{"origin", {0.5, 0, 0}}, {"xy", {0.7, 0.2, 0}}});
  expect_refused(no_axis, "0 points of its axis x");
  TaughtSession no_origin =
      object_of({{"x", {0.5, 0, 0}}, {"x", {0.6, 0, 0}}, {"xy", {0.7, 0.2, 0}}});
  expect_refused(no_origin, "no point beside its axis x that gives the origin");
  TaughtSession near =
      object_of({{"origin", {0.5, 0, 0}}, {"x", {0.502, 0, 0}}, {"xy", {0.7, 0.2, 0}}});
  expect_refused(near, "the points of its axis x are 2.0 mm apart");
}

TEST(TaughtTasks, are_of_one_kind_and_of_different_readings) {
  TaughtSession mixed = object_of({{"origin", {0.5, 0, 0}}, {"tip", {0.7, 0, 0}}});
  const Problem kinds = test::failure_of(taught_task(mixed.rows(), "taught.csv"));
  EXPECT_EQ(kinds.line, 3);
  EXPECT_EQ(kinds.what,
            "\"table\": \"tip\" is a point of a tool, the points before are of a work object");
  TaughtSession twice = object_of({{"origin", {0.5, 0, 0}}, {"x", {0.7, 0, 0}}});
  twice.rows()[1].q = twice.rows()[0].q;
  const Problem same = test::failure_of(taught_task(twice.rows(), "taught.csv"));
  EXPECT_EQ(same.what, "\"table\": the readings are those of line 2");
  // Another frame may have been taught from the same place.
  twice.rows()[1].frame = "other";
  EXPECT_TRUE(taught_task(twice.rows(), "taught.csv"));
}

}  // namespace
}  // namespace armsig::tool
