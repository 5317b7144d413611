// SPDX-License-Identifier: MIT
// What `status` tells of a sensor that is made up of several units.
#include <array>
#include <string>

#include <gtest/gtest.h>

#include "firmware/controller/controller.hpp"
#include "hal/simulated/virtual_clock.hpp"
#include "host_tests/support/puma_cabinet.hpp"
#include "host_tests/support/set_drives.hpp"

namespace armsig::controller {
namespace {

class SensorOfUnits final : public hal::RangeSensor {
 public:
  std::optional<hal::FailingUnit> failing;

 private:
  Result<std::optional<hal::RangeReading>> do_poll(hal::Instant /*now*/) override {
    return std::nullopt;
  }
  [[nodiscard]] std::optional<hal::FailingUnit> do_failing_unit() const override { return failing; }
};

struct CabinetOfUnits {
  std::string status() {
    console.requests.emplace_back("status");
    const std::size_t before = console.replies.size();
    for (int i = 0; i < 50 && console.replies.size() == before; ++i) {
      controller.tick({});
      controller.background();
    }
    return console.replies.empty() ? "" : console.replies.back();
  }
  Configuration configuration = test::puma_controller();
  test::SetDrives drives = test::SetDrives(6);
  test::RamMemory memory;
  SensorOfUnits sensor;
  simulated::VirtualClock clock;
  test::LineConsole console;
  std::array<hal::Console*, 1> consoles{&console};
  Controller controller{configuration, drives, sensor, clock, memory, consoles};
};

TEST(StatusOfSensor, names_the_first_unit_that_failed_and_how) {
  CabinetOfUnits cabinet;
  cabinet.sensor.failing = hal::FailingUnit{.unit = 3, .error = Error::kSensorBadCrc};
  EXPECT_NE(cabinet.status().find(" sensor_unit=3 sensor_unit_error=SENSOR_BAD_CRC"),
            std::string::npos)
      << cabinet.console.replies.back();
}

TEST(StatusOfSensor, names_no_unit_where_none_failed) {
  CabinetOfUnits cabinet;
  EXPECT_TRUE(cabinet.status().starts_with("ok mode="));
  EXPECT_EQ(cabinet.console.replies.back().find("sensor_unit"), std::string::npos);
}

}  // namespace
}  // namespace armsig::controller
