// SPDX-License-Identifier: MIT
// What the whole arm stays clear of, against places along the way, close to each other, of a chain
// that is multiplied out apart, and distances of links that are searched for point by point.
#include "core/clearance/clearance.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "host_tests/support/kinematics_reference.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::clearance {
namespace {

using test::Random;
using test::shared_arm;

// Origins 0 ... n, by the reference.
std::vector<Vector3> origins(const DhRows& rows, const JointVector& q) {
  std::vector<Vector3> found;
  for (std::size_t n = 0; n <= rows.size(); ++n) {
    DhRows first;
    for (std::size_t i = 0; i < n; ++i) first.push_back(rows[i]);
    const auto T = test::reference_pose(first, q);
    found.emplace_back(static_cast<double>(T[0][3]), static_cast<double>(T[1][3]),
                       static_cast<double>(T[2][3]));
  }
  return found;
}

// Of two segments: from a point of one to the nearest of the other, to and fro, which comes ever
// nearer to the nearest pair.
double searched_distance(const Vector3& a0, const Vector3& a1, const Vector3& b0,
                         const Vector3& b1) {
  const auto nearest = [](const Vector3& p, const Vector3& from, const Vector3& to) -> Vector3 {
    const Vector3 along = to - from;
    const double length = std::max(along.squaredNorm(), 1e-12);
    return from + std::clamp((p - from).dot(along) / length, 0.0, 1.0) * along;
  };
  Vector3 on_a = (a0 + a1) / 2;
  Vector3 on_b = b0;
  for (int k = 0; k < 300; ++k) {
    on_b = nearest(on_a, b0, b1);
    on_a = nearest(on_b, a0, a1);
  }
  return (on_a - on_b).norm();
}

// Room to planes, box and between links, as the header says it.
double reference_room(const Arm& arm, const Surroundings& around, const JointVector& q) {
  const std::size_t n = arm.joints.size();
  std::vector<Vector3> p = origins(arm.joints, q);
  p.push_back(p.back());  // the hand
  const double r = around.link_radius_m;
  const auto radius = [&](std::size_t link) { return link > n ? around.hand_m : r; };
  const std::size_t links = around.hand_m > r ? n + 1 : n;
  double least = 1e9;
  for (std::size_t i = 1; i <= links; ++i) {
    for (const HalfSpace& plane : around.planes) {
      if (i == 1 && plane.limit == Limit::kMountingPlane &&
          arm.joints[0].type == JointType::kRevolute) {
        continue;
      }
      least = std::min(least, plane.normal_B.dot(p[i]) - plane.offset_m - radius(i));
    }
    least = std::min({least, (p[i] - around.lower_B).minCoeff() - radius(i),
                      (around.upper_B - p[i]).minCoeff() - radius(i)});
  }
  for (std::size_t j = 1; r > 0 && j <= links; ++j) {
    for (std::size_t i = 1; i + 1 < j; ++i) {
      double between = 0;
      for (std::size_t k = i + 1; k < j; ++k) {
        const DhJoint& row = arm.joints[k - 1];
        between += row.type == JointType::kRevolute ? std::hypot(row.a_m, row.d_m) : row.a_m;
      }
      const double apart = radius(i) + radius(j);
      if (between < (j > n ? 2 * apart : apart + kLeastRoom_m)) continue;
      const Vector3 from =
          i == 1 && arm.joints[0].type == JointType::kRevolute ? around.foot_B : p[i - 1];
      least =
          std::min(least, searched_distance(from, p[i], p[j - 1], p[j]) - radius(i) - radius(j));
    }
  }
  return least;
}

// An arm on its mounting plane, with something in its hand, in a box.
struct Set {
  Arm arm;
  Surroundings around;
};
Set set_up(const Arm& arm, const Mounting& mounting = {}, double box_m = 0, double hand_m = 0) {
  Set set{.arm = arm, .around = surroundings_of(arm, mounting)};
  if (box_m > 0) {
    set.around.lower_B = Vector3::Constant(-box_m);
    set.around.upper_B = Vector3(box_m, 0.9 * box_m, box_m);
  }
  set.around.hand_m = hand_m;
  return set;
}

std::vector<Set> sets() {
  return {set_up(tool::puma560(), {.floor_m = 0.672}, 0, 0.16),
          set_up(tool::puma560(), {.floor_m = 0.672, .link_radius_m = 0}, 0.8, 0.16),
          set_up(shared_arm("ur5")),
          set_up(shared_arm("ur10e"), {}, 1.0, 0.1),
          set_up(shared_arm("stanford"), {.floor_m = 0.3}, 0.9),
          set_up(shared_arm("cobra600"), {}, 0.62),
          set_up(shared_arm("iiwa7"), {.on = Mounting::On::kWall, .floor_m = 0.5}, 0, 0.12)};
}

TEST(Clearance, of_a_pose_is_that_of_its_nearest_part) {
  Random random(11);
  for (const auto& [arm, around] : sets()) {
    for (int n = 0; n < 60; ++n) {
      const JointVector q = random.configuration(arm);
      EXPECT_NEAR(room_at(arm.joints, around, q).left_m, reference_room(arm, around, q), 1e-5);
    }
  }
}

TEST(Clearance, of_readings_that_may_be_off_is_no_more_than_there_is_at_any_of_them) {
  Random random(12);
  for (const auto& [arm, around] : sets()) {
    JointVector within;
    for (std::size_t i = 0; i < arm.joints.size(); ++i) within.push_back(0.02);
    for (int n = 0; n < 15; ++n) {
      const JointVector q = random.configuration(arm);
      const double stated = room_at(arm.joints, around, q, within).left_m;
      EXPECT_LT(stated, room_at(arm.joints, around, q).left_m);
      for (int k = 0; k < 10; ++k) {
        JointVector off = q;
        for (double& reading : off) reading += random.uniform(-0.02, 0.02);
        EXPECT_GE(reference_room(arm, around, off), stated - 1e-5);
      }
    }
  }
}

// How many ways were clear, and how many not: both as their places say, but for those that come too
// near to say.
struct Ways {
  int clear = 0;
  int leaving = 0;

  void look(const Set& set, const JointVector& from, const JointVector& to) {
    WayLook look;
    const auto says = look.whole(set.arm.joints, set.around, from, to);
    double least = 1e9;
    constexpr int kPlaces = 200;
    for (int place = 0; place <= kPlaces; ++place) {
      JointVector q = from;
      for (std::size_t i = 0; i < q.size(); ++i) q[i] += (to[i] - from[i]) * place / kPlaces;
      least = std::min(least, reference_room(set.arm, set.around, q));
    }
    if (says == WayLook::Says::kClear) {
      EXPECT_GE(least, kLeastRoom_m / 2 - 1e-5);
      ++clear;
    } else {
      EXPECT_EQ(says, WayLook::Says::kLeaves);
      EXPECT_LT(look.room().left_m, kLeastRoom_m);
      EXPECT_LT(least, kLeastRoom_m + 2e-2) << "nothing is as near as that";
      ++leaving;
    }
  }
};

TEST(Clearance, of_a_way_is_that_of_all_its_places) {
  Random random(13);
  Ways ways;
  for (const Set& set : sets()) {
    int looked = 0;
    for (int n = 0; n < 4000 && looked < 12; ++n) {
      const JointVector from = random.configuration(set.arm);
      const JointVector to = random.configuration(set.arm);
      // Of ways between poses that are clear themselves there is something to tell.
      if (room_at(set.arm.joints, set.around, from).left_m < kLeastRoom_m ||
          room_at(set.arm.joints, set.around, to).left_m < kLeastRoom_m) {
        continue;
      }
      ways.look(set, from, to);
      ++looked;
    }
  }
  EXPECT_GT(ways.clear, 10);
  EXPECT_GT(ways.leaving, 10);
}

WayLook::Says whole(const Arm& arm, const Surroundings& around, const JointVector& from,
                    const JointVector& to) {
  WayLook look;
  return look.whole(arm.joints, around, from, to);
}

Surroundings box(const Vector3& lower_B, const Vector3& upper_B) {
  Surroundings around;
  around.lower_B = lower_B;
  around.upper_B = upper_B;
  return around;
}

TEST(Clearance, is_whole_where_nothing_is_around) {
  const Arm arm = tool::puma560();
  Random random(14);
  WayLook look;
  EXPECT_EQ(look.step(arm.joints, {}, random.configuration(arm), random.configuration(arm)),
            WayLook::Says::kClear);
}

TEST(Clearance, of_a_slide_counts_its_way) {
  Arm arm;
  arm.joints = {{.type = JointType::kPrismatic}};
  const Surroundings around = box({-1, -1, -0.1}, {1, 1, 0.5});
  EXPECT_EQ(whole(arm, around, {0.0}, {0.49}), WayLook::Says::kClear);
  EXPECT_EQ(whole(arm, around, {0.0}, {0.6}), WayLook::Says::kLeaves);
  EXPECT_EQ(whole(arm, around, {0.0}, {-0.2}), WayLook::Says::kLeaves);
}

// Some turns about the vertical, of which a look that took the slide for short would skip each.
TEST(Clearance, is_left_by_turns_with_a_slide_that_is_out_at_one_end_of_the_way) {
  for (const double offset_m : {0.0, 0.4}) {
    Arm arm;
    arm.joints = {{.type = JointType::kRevolute, .alpha_rad = kPi / 2},
                  {.type = JointType::kPrismatic, .d_m = offset_m}};
    const Surroundings around = box({-2, -2, -1}, {0.3, 2, 1});
    const double out = 0.8 - offset_m;
    const double in = -offset_m;
    EXPECT_EQ(whole(arm, around, {0.0, out}, {16.9, in}), WayLook::Says::kLeaves);
    EXPECT_EQ(whole(arm, around, {16.9, in}, {0.0, out}), WayLook::Says::kLeaves);
  }
}

TEST(Clearance, names_link_limit_and_place) {
  const Arm arm = shared_arm("ur5");
  const Surroundings around = surroundings_of(arm, {});
  const JointVector down{0, radians(60), 0, 0, 0, 0};
  const Room low = room_at(arm.joints, around, down);
  EXPECT_EQ(low.limit, Limit::kMountingPlane);
  EXPECT_LT((low.p_B - origins(arm.joints, down)[low.link]).norm(), 1e-9);
  EXPECT_NEAR(low.left_m, low.p_B.z() - around.link_radius_m, 1e-12);
  // Folded: the flange in the base's own column.
  const JointVector folded{0, radians(-90), radians(170), 0, 0, 0};
  const Room self = room_at(arm.joints, around, folded);
  EXPECT_EQ(self.limit, Limit::kLink);
  EXPECT_GT(self.link, self.other + 1);
}

TEST(Clearance, of_a_joint_ends_where_something_comes_too_near) {
  const Arm arm = shared_arm("ur5");
  const Surroundings around = surroundings_of(arm, {});
  const JointVector q{0, radians(-60), radians(60), radians(-90), radians(-90), 0};
  for (std::size_t joint = 0; joint < 6; ++joint) {
    const JointLimits limits{q[joint] - kPi, q[joint] + kPi};
    const auto [lower, upper] = free_readings(arm.joints, {}, around, q, joint, limits);
    for (int k = 0; k <= 200; ++k) {
      JointVector at = q;
      at[joint] = lower + (upper - lower) * k / 200;
      EXPECT_GE(reference_room(arm, around, at), kLeastRoom_m / 2 - 1e-5);
    }
    for (const auto& [end, limit] :
         {std::pair(lower, limits.lower), std::pair(upper, limits.upper)}) {
      if (end == limit) continue;
      JointVector last = q;
      last[joint] = end;
      EXPECT_GE(reference_room(arm, around, last), kLeastRoom_m - 1e-6) << "joint " << joint + 1;
      EXPECT_EQ(WayLook().whole(arm.joints, around, last, q), WayLook::Says::kClear)
          << "there and not back, joint " << joint + 1;
      JointVector beyond = q;
      beyond[joint] = end + (limit - end > 0 ? 1 : -1) * radians(2);
      EXPECT_LT(reference_room(arm, around, beyond), kLeastRoom_m) << "joint " << joint + 1;
    }
  }
}

TEST(Surroundings, of_an_arm_on_floor_ceiling_and_wall_are_behind_its_mounting_plane) {
  const Arm arm = shared_arm("ur5");
  for (const auto on : {Mounting::On::kFloor, Mounting::On::kCeiling, Mounting::On::kWall}) {
    const Surroundings around = surroundings_of(arm, {.on = on});
    ASSERT_EQ(around.planes.size(), 1U);
    EXPECT_EQ(around.planes[0].limit, Limit::kMountingPlane);
    EXPECT_EQ(around.planes[0].normal_B, Vector3(0, 0, 1));
    EXPECT_EQ(around.planes[0].offset_m, 0);
  }
  EXPECT_EQ(gravity_B(arm, {}), Vector3(0, 0, -1));
  EXPECT_EQ(gravity_B(arm, {.on = Mounting::On::kCeiling}), Vector3(0, 0, 1));
  EXPECT_EQ(gravity_B(arm, {.on = Mounting::On::kWall}), Vector3(-1, 0, 0));
  // A base frame that stands upside down.
  Arm below = arm;
  below.joints[0].d_m = -0.4;
  EXPECT_EQ(surroundings_of(below, {}).planes[0].normal_B, Vector3(0, 0, -1));
  EXPECT_EQ(gravity_B(below, {}), Vector3(0, 0, 1));
  EXPECT_EQ(gravity_B(below, {.on = Mounting::On::kCeiling}), Vector3(0, 0, -1));
}

TEST(Surroundings, of_an_arm_on_a_pedestal_end_at_the_floor_and_of_others_there_too) {
  const Arm arm = shared_arm("ur5");
  const Surroundings standing = surroundings_of(arm, {.floor_m = 0.6});
  ASSERT_EQ(standing.planes.size(), 1U);
  EXPECT_EQ(standing.planes[0].limit, Limit::kFloor);
  EXPECT_EQ(standing.planes[0].offset_m, -0.6);
  EXPECT_EQ(standing.foot_B, Vector3(0, 0, -0.6));
  for (const auto on : {Mounting::On::kCeiling, Mounting::On::kWall}) {
    const Surroundings hanging = surroundings_of(arm, {.on = on, .floor_m = 2});
    ASSERT_EQ(hanging.planes.size(), 2U);
    EXPECT_EQ(hanging.planes[0].limit, Limit::kMountingPlane);
    EXPECT_EQ(hanging.planes[1].normal_B, -gravity_B(arm, {.on = on}));
    EXPECT_EQ(hanging.planes[1].offset_m, -2);
    EXPECT_EQ(hanging.foot_B, Vector3::Zero());
  }
  const Vector3 pull = Vector3(0.5, 0, -0.8).normalized();
  const Surroundings tilted =
      surroundings_of(arm, {.on = Mounting::On::kTilted, .tilted_gravity_B = pull, .floor_m = 0.6});
  ASSERT_EQ(tilted.planes.size(), 1U);
  EXPECT_EQ(tilted.planes[0].normal_B, -pull);
}

TEST(Surroundings, have_links_as_thick_as_the_arm_is_long_unless_it_is_told) {
  const Arm arm = shared_arm("ur5");
  EXPECT_NEAR(surroundings_of(arm, {}).link_radius_m,
              0.05 * (0.425 + 0.39225 + 0.10915 + 0.09465 + 0.0823), 1e-12);
  EXPECT_EQ(surroundings_of(arm, {.link_radius_m = 0.07}).link_radius_m, 0.07);
  EXPECT_NEAR(surroundings_of(shared_arm("stanford"), {}).link_radius_m,
              0.05 * (0.154 + std::hypot(0.0203, 1.0)), 1e-12);
}

}  // namespace
}  // namespace armsig::clearance
