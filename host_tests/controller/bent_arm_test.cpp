// SPDX-License-Identifier: MIT
// A stored signature with joint error maps and gravity, servoed with: where the tool of an arm
// that is bent like that comes to, by the estimator's own evaluation of what its joints have
// turned.
#include <gtest/gtest.h>

#include "core/calibration/readings.hpp"
#include "core/identification.hpp"
#include "core/kinematics/forward.hpp"
#include "firmware/controller/signature_store.hpp"
#include "host_tests/support/bent_puma.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

const Vector3 kTool(0.15, 0, 0.05);

Signature true_geometry() {
  const Arm robot = tool::table2_robot(1);
  const JointVector q = test::puma_configuration();
  const Pose X_SB = simulated::demo_base_pose();
  const KnownTarget target{1, 6, kTool};
  return signature_of(robot, q, X_SB, {&target, 1});
}

// Where the tool of the bent arm is, in the frame of the sensor.
Vector3 true_tool(const JointVector& readings) {
  static const calibration::ArmModel bent = test::bent_puma_model();
  const Arm robot = tool::table2_robot(1);
  const calibration::ReadingModel model{robot.couplings, {}, &bent};
  const JointVector turned =
      calibration::true_readings(model, test::puma_configuration(), readings);
  const Pose X_0n = *kinematics::forward(kinematics::make_chain(robot.joints), turned);
  return simulated::demo_base_pose() * (X_0n * kTool);
}

void store(PumaCabinet& puma, const calibration::PackedDeflections& deflections) {
  SignatureRecord record;
  record.signature = true_geometry();
  record.deflections = deflections;
  record.machine.drawing_crc = drawing_crc(tool::puma560());
  for (int i = 0; i < 6; ++i) {
    record.machine.drives.push_back({.counts_per_revolution = 4000, .gear_ratio = 100});
  }
  SignatureRecord found;
  SignatureStore store(puma.memory);
  (void)store.load(tool::puma560(), found);
  store.begin_write(record);
  Result<bool> done = false;
  while (done && !*done) done = store.step();
  ASSERT_TRUE(done);
}

// How far the tool of the bent arm is from where it was sent along a line, in the worst of some
// places, with what `deflections` say stored.
double worst_miss_m(const calibration::PackedDeflections& deflections) {
  PumaCabinet puma;
  EXPECT_TRUE(puma.run_until(Mode::kIdle));
  store(puma, deflections);
  puma.start(test::puma_controller(), 1);
  EXPECT_TRUE(puma.enable());
  puma.confirm();
  EXPECT_NE(puma.ask("status").find(" model=signature"), std::string::npos);
  EXPECT_EQ(puma.ask("move q1_deg=20 q2_deg=-60 q3_deg=40 q5_deg=50"), "ok");
  EXPECT_TRUE(puma.run_until(Mode::kServoing, 0.1) && puma.run_until(Mode::kHolding));
  const Vector3 begin = puma.now().X_RT->p;
  double worst_m = 0;
  for (const Vector3& way :
       {Vector3(-0.05, 0, 0), Vector3(0.03, -0.04, 0.03), Vector3(0.04, -0.05, 0.02)}) {
    const Vector3 goal = begin + way;
    std::string line = "move";
    for (int axis = 0; axis < 3; ++axis) {
      line += std::string(" ") + "xyz"[axis] + "_m=" + std::to_string(goal(axis));
    }
    EXPECT_EQ(puma.ask(line), "ok") << line;
    EXPECT_TRUE(puma.run_until(Mode::kServoing, 1) && puma.run_until(Mode::kHolding)) << line;
    worst_m = std::max(worst_m, (true_tool(puma.now().commanded) - goal).norm());
  }
  return worst_m;
}

TEST(BentArm, comes_where_its_tool_is_sent_by_the_maps_and_gravity_of_its_record) {
  EXPECT_LT(worst_miss_m(test::bent_puma()), 0.02e-3);
}

TEST(BentArm, would_miss_by_half_a_millimetre_by_its_geometry_alone) {
  EXPECT_GT(worst_miss_m({}), 0.3e-3);
}

}  // namespace
}  // namespace armsig::controller
