// SPDX-License-Identifier: MIT
// What the console tells of an arm with a slide, before drives that a test sets.
#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "firmware/controller/controller.hpp"
#include "hal/simulated/virtual_clock.hpp"
#include "host_tests/support/puma_cabinet.hpp"
#include "host_tests/support/set_drives.hpp"
#include "host_tests/support/silent_sensor.hpp"

namespace armsig::controller {
namespace {

// Joint 3 is a slide from 0.1 to 0.5 m.
Configuration with_slide() {
  Configuration c = test::puma_controller();
  c.drawing.joints[2].type = JointType::kPrismatic;
  c.drawing.limits[2] = {0.1, 0.5};
  c.sweeps.configuration[2] = 0.3;
  return c;
}

struct SlideArm {
  explicit SlideArm(test::RamMemory& memory)
      : controller(
            std::make_unique<Controller>(configuration, drives, sensor, clock, memory, consoles)) {
    drives.actual = configuration.sweeps.configuration;
  }
  void step() {
    controller->tick({});
    controller->background();
    clock.wait_until(next += configuration.period);
  }
  std::string status() {
    console.requests.emplace_back("status");
    step();
    step();
    return console.replies.empty() ? "" : console.replies.back();
  }
  [[nodiscard]] bool told(const std::string& line) const {
    return std::ranges::any_of(console.told,
                               [&](const std::string& one) { return one.starts_with(line); });
  }

  Configuration configuration = with_slide();
  test::SetDrives drives{6};
  test::SilentSensor sensor;
  simulated::VirtualClock clock;
  test::LineConsole console;
  std::array<hal::Console*, 1> consoles{&console};
  std::unique_ptr<Controller> controller;
  hal::Instant next;
};

bool has(const std::string& line, const std::string& part) {
  return line.find(part + " ") != std::string::npos;
}

TEST(SlideConsole, reads_a_slide_in_millimetres_and_turning_joints_in_degrees) {
  test::RamMemory memory;
  SlideArm arm(memory);
  ASSERT_TRUE(check(arm.configuration));
  arm.drives.actual[2] = 0.25;
  arm.drives.actual[3] = radians(12.5);
  const std::string status = arm.status();
  EXPECT_TRUE(has(status, " q3_mm=250.0000")) << status;
  EXPECT_TRUE(has(status, " q4_deg=12.5000")) << status;
}

// What is not known is not a number: neither a reading nor a tool point, nor a time of no tick.
TEST(SlideConsole, tells_the_readings_that_it_has_heard_and_the_tool_once_it_has_heard_all) {
  test::RamMemory memory;
  SlideArm arm(memory);
  arm.drives.set_all(hal::DriveCondition::kStarting);
  std::string status = arm.status();
  EXPECT_EQ(status.find(" q"), std::string::npos) << status;
  EXPECT_EQ(status.find("_mm="), std::string::npos) << status;
  arm.drives.statuses[1].has_position = true;
  arm.drives.actual[1] = 0;
  status = arm.status();
  EXPECT_TRUE(has(status, " q2_deg=0.0000")) << "heard, and zero: " << status;
  EXPECT_EQ(status.find(" q1_deg="), std::string::npos) << status;
  EXPECT_EQ(status.find(" x_mm="), std::string::npos) << status;
  for (hal::DriveStatus& drive : arm.drives.statuses) drive.has_position = true;
  status = arm.status();
  for (const char* key : {" q1_deg=", " q2_deg=", " q3_mm=", " q6_deg=", " x_mm=", " z_mm="}) {
    EXPECT_NE(status.find(key), std::string::npos) << key << " in " << status;
  }
  arm.drives.statuses[4].has_position = false;
  status = arm.status();
  EXPECT_EQ(status.find(" q5_deg="), std::string::npos) << "it is set up anew: " << status;
  EXPECT_EQ(status.find(" x_mm="), std::string::npos) << status;
}

TEST(SlideConsole, tells_no_time_before_the_first_tick) {
  test::RamMemory memory;
  SlideArm arm(memory);
  arm.console.requests.emplace_back("status");
  arm.controller->background();
  ASSERT_EQ(arm.console.replies.size(), 1U);
  const std::string& status = arm.console.replies.back();
  EXPECT_TRUE(status.ends_with(" ticks=0")) << status;
}

TEST(SlideConsole, names_the_joints_that_their_drives_limit) {
  test::RamMemory memory;
  SlideArm arm(memory);
  EXPECT_EQ(arm.status().find("limits_active"), std::string::npos);
  arm.drives.statuses[5].limit_active = true;
  EXPECT_TRUE(has(arm.status(), " limits_active=6"));
  arm.drives.statuses[2].limit_active = true;
  EXPECT_TRUE(has(arm.status(), " limits_active=3,6"));
}

TEST(SlideConsole, repeats_what_stands_behind_the_sensors_trouble) {
  test::RamMemory memory;
  SlideArm arm(memory);
  EXPECT_EQ(arm.status().find("sensor"), std::string::npos) << "it has not been heard yet";
  arm.sensor.reading.emplace().air_celsius = 20;
  arm.sensor.reading->receivers.resize(arm.configuration.sensor.receivers.p_S.size());
  EXPECT_TRUE(has(arm.status(), " sensor=well"));
  EXPECT_EQ(arm.status().find("sensor_says"), std::string::npos);
  arm.sensor.gone = true;
  EXPECT_TRUE(has(arm.status(), " sensor=SENSOR_PORT_GONE sensor_says=\"unplugged\""));
}

TEST(SlideConsole, tells_times_in_tenths_of_microseconds) {
  test::RamMemory memory;
  SlideArm arm(memory);
  for (const char* what : {" late_mean_us=", " late_max_us=", " exec_mean_us=", " exec_max_us="}) {
    EXPECT_TRUE(has(arm.status(), std::string(what) + "0.0")) << what;
  }
  EXPECT_TRUE(arm.status().ends_with(" step_max_us=0.0")) << "the clock stands in a step";
}

TEST(SlideConsole, tells_which_joints_are_elsewhere_and_by_how_much) {
  test::RamMemory memory;
  JointVector now;
  {
    SlideArm before(memory);
    before.status();
    before.controller->finish();
    now = before.drives.actual;
  }
  SlideArm arm(memory);
  arm.drives.actual[0] = now[0] + radians(0.6);
  arm.drives.actual[1] = now[1] - radians(0.02);
  arm.drives.actual[2] = now[2] - 3.1e-3;
  EXPECT_TRUE(has(arm.status(), " unreferenced=1,3"));
  EXPECT_TRUE(arm.told("# unreferenced joint=1 why=moved by_deg=0.600 "));
  EXPECT_TRUE(arm.told("# unreferenced joint=3 why=moved by_mm=-3.100 "));
  EXPECT_EQ(std::ranges::count_if(
                arm.console.told,
                [](const std::string& line) { return line.starts_with("# unreferenced"); }),
            2);
}

// Three times the millimetre that the nominal model is taken for.
TEST(SlideConsole, says_nothing_of_a_slide_that_settled_within_three_millimetres) {
  test::RamMemory memory;
  {
    SlideArm before(memory);
    before.status();
  }
  SlideArm arm(memory);
  arm.drives.actual[2] += 2.9e-3;
  EXPECT_EQ(arm.status().find("unreferenced"), std::string::npos);
}

}  // namespace
}  // namespace armsig::controller
