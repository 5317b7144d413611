// SPDX-License-Identifier: MIT
// The emulated arm is no kinder than a real one: maps of its readings, sag, play and growth, and
// what an identification by geometry alone makes of them.
#include <cmath>

#include <gtest/gtest.h>

#include "host_tests/support/table_3_run.hpp"

namespace armsig::cabinet {
namespace {

// A Puma's cabinet with what `world` says.
struct Plant {
  explicit Plant(const World& world)
      : cabinet(test::puma_controller(), test::puma_bus(), world, memory, consoles) {}

  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / 0.002); ++i) cabinet.step();
  }
  std::string ask(const std::string& request) {
    const std::size_t before = console.replies.size();
    console.requests.push_back(request);
    for (int i = 0; i < 500 && console.replies.size() == before; ++i) cabinet.step();
    return console.replies.size() == before ? "" : console.replies.back();
  }
  bool enable() {
    run(3);
    const bool enabled = ask("enable") == "ok";
    run(1);
    return enabled;
  }
  Vector3 target() { return cabinet.sensor().target(cabinet.clock().now()); }

  test::LineConsole console;
  std::array<hal::Console*, 1> consoles{&console};
  test::RamMemory memory;
  VirtualCabinet cabinet;
};

World ideal() {
  World world = test::puma_world();
  world.drive.emplace();
  return world;
}

World bent(const Bends& bends) {
  World world = ideal();
  simulated::Random random(5);
  world.bent = bent_model(test::puma_controller().drawing, bends, random);
  return world;
}

Vector3 rigid(const World& world, const JointVector& q) {
  return simulated::target_position(world.arm, q, world.arm.targets[0]);
}

TEST(VirtualPlant, arm_without_bends_is_where_its_encoders_say) {
  const World world = ideal();
  Plant plant(world);
  plant.run(0.1);
  EXPECT_TRUE(plant.target() == rigid(world, plant.cabinet.sensor().true_readings()));
}

TEST(VirtualPlant, maps_turn_every_joint_by_no_more_than_told) {
  const double largest = radians(0.02);
  const World world = bent({.map_rad = largest});
  simulated::Random random(9);
  JointVector furthest = test::puma_configuration();
  for (double& joint : furthest) joint = 0;
  for (int i = 0; i < 2000; ++i) {
    JointVector q;
    for (std::size_t k = 0; k < 6; ++k) q.push_back(random.uniform(-kPi, kPi));
    const JointVector t = turned(*world.bent, q);
    for (std::size_t k = 0; k < 6; ++k) {
      furthest[k] = std::max(furthest[k], std::abs(t[k] - q[k]));
    }
  }
  for (const double joint : furthest) {
    EXPECT_LE(joint, largest * (1 + 1e-9));
    EXPECT_GT(joint, 0.6 * largest);
  }
  Plant plant(world);
  plant.run(0.1);
  const double off_m = (plant.target() - rigid(world, test::puma_configuration())).norm();
  EXPECT_GT(off_m, 1e-5);
  EXPECT_LT(off_m, 6 * largest * 1.2);
}

TEST(VirtualPlant, sag_lets_the_stretched_arm_hang_and_the_upright_one_stand) {
  World world = bent({.sag_m = 0.5e-3});
  world.arm.X_S0 = {};  // z up
  const auto fall_m = [&](const JointVector& q) {
    return (rigid(world, turned(*world.bent, q)) - rigid(world, q)).z();
  };
  // Level, the upper arm and the forearm in line; and all of it upright.
  EXPECT_LT(fall_m({0, 0, radians(90), 0, 0, 0}), -0.3e-3);
  EXPECT_GT(fall_m({0, 0, radians(90), 0, 0, 0}), -0.7e-3);
  EXPECT_NEAR(fall_m({0, radians(-90), radians(90), 0, 0, 0}), 0, 0.05e-3);
}

TEST(VirtualPlant, play_leaves_a_joint_on_the_side_that_it_came_from) {
  World world = test::puma_world();  // drives as they are, with friction
  world.play_rad = radians(0.05);
  Plant plant(world);
  ASSERT_TRUE(plant.enable());
  const auto at_ten_from = [&](const std::string& degrees) {
    EXPECT_EQ(plant.ask("move q1_deg=" + degrees), "ok");
    plant.run(5);
    EXPECT_EQ(plant.ask("move q1_deg=10"), "ok");
    plant.run(5);
    return plant.cabinet.sensor().true_readings()[0];
  };
  const double from_above = at_ten_from("20");
  const double from_below = at_ten_from("0");
  EXPECT_NEAR(degrees(from_above - from_below), 0.05 + 0.003, 0.005) << "and the drives' own";
}

TEST(VirtualPlant, arm_that_warms_up_grows_to_what_was_told) {
  World world = ideal();
  world.growth = 1e-3;
  world.warming = std::chrono::seconds(10);
  Plant plant(world);
  const auto growth = [&] {
    const Vector3 foot = world.arm.X_S0.p;
    const Vector3 cold = rigid(world, plant.cabinet.sensor().true_readings());
    return (plant.target() - foot).norm() / (cold - foot).norm() - 1;
  };
  plant.run(0.1);
  EXPECT_LT(growth(), 2e-5);
  plant.run(10);
  EXPECT_NEAR(growth(), 1e-3 * (1 - std::exp(-1)), 2e-5);
  plant.run(100);
  EXPECT_NEAR(growth(), 1e-3, 1e-6);
}

double held_out_mm(const World& world) {
  Plant plant(world);
  EXPECT_TRUE(plant.enable());
  EXPECT_EQ(plant.ask("identify"), "ok");
  std::string reply;
  for (int i = 0; i < 3600 && !reply.starts_with("ok"); ++i) {
    plant.run(1);
    reply = plant.ask("candidate");
  }
  const std::size_t at = reply.find("validation_rms_mm=");
  return at == std::string::npos ? 0 : std::stod(reply.substr(at + 18));
}

TEST(VirtualPlant, identification_by_geometry_alone_shows_the_maps_on_held_out_poses) {
  const double plain = held_out_mm(ideal());
  const double with_maps = held_out_mm(bent({.map_rad = radians(0.05), .sag_m = 1e-3}));
  EXPECT_GT(plain, 0);
  EXPECT_GT(with_maps, 1.5 * plain) << plain;
}

}  // namespace
}  // namespace armsig::cabinet
