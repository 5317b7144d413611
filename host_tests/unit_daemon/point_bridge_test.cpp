// SPDX-License-Identifier: MIT
// The bridge of docs/sensors.md, as it is printed there, tells armsigd's points.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "hal/linux/line_server.hpp"
#include "hal/linux/steady_clock.hpp"
#include "host_tests/support/temporary.hpp"

namespace armsig::daemon {
namespace {

// What stands in Python in the guide.
std::string bridge_of_guide() {
  std::ifstream guide(ARMSIG_GUIDE);
  std::string bridge;
  bool inside = false;
  for (std::string line; std::getline(guide, line);) {
    if (line.starts_with("```")) {
      inside = line == "```python";
    } else if (inside) {
      bridge += line + "\n";
    }
  }
  return bridge;
}

std::optional<hal::PointReading> next_point(linux_hal::PointServer& server) {
  linux_hal::SteadyClock clock;
  const hal::Instant gives_up = clock.now() + std::chrono::seconds(30);
  while (clock.now() < gives_up) {
    if (const auto polled = server.poll(clock.now()); polled && *polled) return *polled;
    clock.wait_until(clock.now() + std::chrono::milliseconds(5));
  }
  return std::nullopt;
}

TEST(PointBridge, of_the_guide_passes_on_what_a_program_prints) {
  const std::string script = test::temporary("bridge.py");
  std::ofstream(script) << bridge_of_guide();
  linux_hal::PointServer server{{}};
  (void)server.poll(linux_hal::monotonic_now());
  const std::string command = "python3 " + script + " 127.0.0.1 " + std::to_string(server.port());
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> bridge(::popen(command.c_str(), "w"),
                                                               &::pclose);
  ASSERT_NE(bridge, nullptr);
  std::fputs("0.8125 -0.031 0.455 more\n", bridge.get());
  std::fflush(bridge.get());
  const auto point = next_point(server);
  ASSERT_TRUE(point) << server.words(Error::kSensorMalformed);
  EXPECT_NEAR(point->p_S.x(), 0.8125, 1e-9);
  EXPECT_NEAR(point->p_S.y(), -0.031, 1e-9);
  EXPECT_NEAR(point->p_S.z(), 0.455, 1e-9);
  EXPECT_EQ(server.malformed(), 0U);
}

}  // namespace
}  // namespace armsig::daemon
