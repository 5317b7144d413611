// SPDX-License-Identifier: MIT
// What the console tells of an arm with a slide, before drives that a test sets.
#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "firmware/controller/controller.hpp"
#include "firmware/controller/position_keeper.hpp"
#include "hal/simulated/virtual_clock.hpp"
#include "host_tests/support/puma_cabinet.hpp"
#include "host_tests/support/set_drives.hpp"

namespace armsig::controller {
namespace {

class SilentSensor final : public hal::RangeSensor {
 public:
  bool gone = false;

 private:
  Result<std::optional<hal::RangeReading>> do_poll(hal::Instant /*now*/) override {
    if (gone) return std::unexpected(Error::kSensorPortGone);
    return std::optional<hal::RangeReading>();
  }
  [[nodiscard]] std::string_view do_words(Error /*error*/) const override { return "unplugged"; }
};

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
    return std::ranges::find(console.told, line) != console.told.end();
  }

  Configuration configuration = with_slide();
  test::SetDrives drives{6};
  SilentSensor sensor;
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

TEST(SlideConsole, tells_which_joints_moved_without_power_and_by_how_much) {
  test::RamMemory memory;
  JointVector now;
  {
    SlideArm before(memory);
    keep_positions(memory, before.drives);
    now = before.drives.actual;
  }
  SlideArm arm(memory);
  arm.drives.actual[0] = now[0] + radians(0.6);
  arm.drives.actual[1] = now[1] - radians(0.4);
  arm.drives.actual[2] = now[2] - 1.1e-3;
  arm.status();
  EXPECT_TRUE(arm.told("# moved without power joint=1 by_deg=0.600"));
  EXPECT_TRUE(arm.told("# moved without power joint=3 by_mm=-1.100"));
  EXPECT_EQ(std::ranges::count_if(
                arm.console.told,
                [](const std::string& line) { return line.starts_with("# moved without"); }),
            2);
}

TEST(SlideConsole, says_nothing_of_a_slide_that_settled_within_a_millimetre) {
  test::RamMemory memory;
  {
    SlideArm before(memory);
    keep_positions(memory, before.drives);
  }
  SlideArm arm(memory);
  arm.drives.actual[2] += 0.9e-3;
  arm.status();
  EXPECT_FALSE(has(arm.console.told.empty() ? "" : arm.console.told.back(), "# moved without"));
}

}  // namespace
}  // namespace armsig::controller
