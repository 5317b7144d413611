// SPDX-License-Identifier: MIT
// The R5F has no memory to look at the way before its arm goes: what its configuration makes it do,
// always the same, is looked at here. The floor is that of a Puma, 672 mm below its shoulder.
#include <gtest/gtest.h>

#include "firmware/cabinet_r5f/configuration.hpp"
#include "firmware/controller/pose_visit.hpp"
#include "firmware/controller/sweep.hpp"

namespace armsig::cabinet {
namespace {

controller::Configuration on_its_floor() {
  controller::Configuration c = controller_configuration();
  c.around = clearance::surroundings_of(c.drawing, {.floor_m = 0.672});
  c.around.hand_m = 0.16;
  return c;
}

// Goes through `poses` in their order, from the signature configuration and back to it.
void expect_clear(const controller::Configuration& c, const std::vector<JointVector>& poses) {
  JointVector at = c.sweeps.configuration;
  const auto go = [&](const JointVector& to) {
    clearance::WayLook look;
    EXPECT_EQ(look.whole(c.drawing.joints, c.around, at, to), clearance::WayLook::Says::kClear)
        << "link " << int{look.room().link} << " limit " << static_cast<int>(look.room().limit)
        << " link " << int{look.room().other};
    at = to;
  };
  for (const JointVector& pose : poses) go(pose);
  go(c.sweeps.configuration);
}

// Each in the order in which its points are measured, extended as far as it may be.
TEST(R5fConfiguration, keeps_its_sweeps_clear_of_floor_and_links) {
  const controller::Configuration c = on_its_floor();
  std::vector<JointVector> poses;
  for (std::size_t joint = 0; joint < c.drawing.joints.size(); ++joint) {
    controller::Sweep sweep(c, joint);
    for (; sweep.next(); sweep.skip()) {
      poses.push_back(c.sweeps.configuration);
      poses.back()[joint] = *sweep.next();
    }
  }
  expect_clear(c, poses);
}

TEST(R5fConfiguration, keeps_its_held_out_poses_clear_of_floor_and_links) {
  const controller::Configuration c = on_its_floor();
  std::vector<JointVector> poses;
  for (std::size_t i = 0; i < c.sweeps.validation_poses; ++i) {
    poses.push_back(controller::held_out_pose(c, i));
  }
  expect_clear(c, poses);
}

TEST(R5fConfiguration, keeps_its_checks_clear_of_floor_and_links) {
  const controller::Configuration c = on_its_floor();
  std::vector<JointVector> poses;
  for (std::size_t i = 0; i < c.check.poses; ++i) poses.push_back(controller::spread_pose(c, i));
  expect_clear(c, poses);
}

}  // namespace
}  // namespace armsig::cabinet
