// SPDX-License-Identifier: MIT
// An arm whose wrist joints are coupled, as a real Puma 560's: the controller's readings are of the
// joints, the motors' stay inside.
#include <gtest/gtest.h>

#include "core/kinematics/forward.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

// Joint 5 turns joint 6, and joint 4 both.
JointCouplings wrist() { return {{4, 3, 0.014}, {5, 3, -0.013}, {5, 4, -0.18}}; }

Configuration coupled() {
  Configuration configuration = test::puma_controller();
  configuration.drawing.couplings = wrist();
  return configuration;
}

struct CoupledCabinet : PumaCabinet {
  CoupledCabinet() {
    world.arm.arm = tool::puma560();
    world.arm.arm.couplings = wrist();
    cabinet.reset();
    cabinet = std::make_unique<cabinet::VirtualCabinet>(coupled(), test::puma_bus(), world, memory,
                                                        consoles);
  }
  // Where the hand is, in the base of the arm as it was built.
  [[nodiscard]] Pose hand_0() {
    return world.arm.X_S0.inverse() *
           simulated::link_pose(world.arm, cabinet->sensor().true_readings(), 6);
  }
  void move(const std::string& request) {
    ASSERT_EQ(ask(request), "ok");
    ASSERT_TRUE(run_until(Mode::kServoing, 0.5));
    ASSERT_TRUE(run_until(Mode::kHolding, 20));
    run(0.3);
  }
  cabinet::World world = test::puma_world();
};

TEST(CoupledWrist, is_where_the_model_says) {
  CoupledCabinet puma;
  ASSERT_TRUE(puma.enable());
  puma.move("move q3_deg=10 q4_deg=60 q5_deg=40 q6_deg=-20");
  EXPECT_NEAR(puma.now().positions[5], radians(-20), 1e-4);
  const double motor = puma.cabinet->sensor().true_readings()[5];
  EXPECT_GT(std::abs(motor - radians(-20)), 0.05) << "the motor turns for joints 4 and 5 as well";
  EXPECT_LT((puma.hand_0().p - puma.now().X_RT->p).norm(), 1e-4);
  EXPECT_LT(angle_between(puma.hand_0().R, puma.now().X_RT->R), 2e-4);
}

TEST(CoupledWrist, carries_the_tool_along_a_line) {
  CoupledCabinet puma;
  ASSERT_TRUE(puma.enable());
  puma.move("move q3_deg=10 q5_deg=40");
  const Pose from = puma.hand_0();
  puma.move("move dz_mm=-100 dx_mm=50");
  const Vector3 way = puma.hand_0().p - from.p;
  EXPECT_LT((way - Vector3(0.05, 0, -0.1)).norm(), 1e-4);
  EXPECT_LT(angle_between(from.R, puma.hand_0().R), 4e-4);
}

TEST(CoupledWrist, is_refused_a_move_for_which_a_motor_would_leave_its_limits) {
  CoupledCabinet puma;
  ASSERT_TRUE(puma.enable());
  // Joint 6 may turn to 266 degrees; its motor would have to turn to 280 for it.
  EXPECT_TRUE(puma.ask("move q4_deg=0 q5_deg=90 q6_deg=265").starts_with("error JOINT_LIMIT "));
}

TEST(CoupledWrist, that_leads_back_to_its_joint_is_refused) {
  Configuration configuration = coupled();
  EXPECT_TRUE(check(configuration));
  configuration.drawing.couplings.push_back({3, 5, 0.5});
  ASSERT_FALSE(check(configuration));
  EXPECT_EQ(test::failure_of(check(configuration)).setting, "arm.coupling");
  EXPECT_EQ(test::failure_of(check(configuration)).error, Error::kUnsupported);
}

}  // namespace
}  // namespace armsig::controller
