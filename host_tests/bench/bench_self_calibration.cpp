// SPDX-License-Identifier: MIT
// The arm calibrates itself on the bench: armsigd against an emulated Puma 560 that bends, over
// real SocketCAN and a real serial line. Minutes: host_tests/bench/run --self; ARMSIG_BENCH_SEED=K
// is another arm, bent otherwise, and other noise.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "firmware/controller/workspace.hpp"
#include "firmware/linux/daemon_configuration.hpp"
#include "hal/simulated/random.hpp"
#include "host_tests/bench/bench_process.hpp"
#include "host_tests/bench/daemon_process.hpp"
#include "host_tests/bench/sensor_on_can.hpp"

namespace armsig::bench {
namespace {

constexpr int kPoses = 200;
constexpr double kAsked_mm = 0.15;

// Three pings of eight ranges, 0.2 mm each: a point of 0.1 mm (1 sigma per axis).
Changes sensor_of_a_tenth_of_a_millimetre() {
  return {{"pings: 8", "pings: 3"}, {"most_points: 48", "most_points: 24"}};
}

// As many ranges a point by the six receivers that it has there.
Changes the_same_on_can() {
  Changes changes = sensor_on_can();
  changes.insert(changes.end(), {{"pings: 8", "pings: 4"}, {"most_points: 48", "most_points: 24"}});
  return changes;
}

// A box that leaves room for the sweeps, and not for every pose.
Changes the_same_in_a_box() {
  Changes changes = sensor_of_a_tenth_of_a_millimetre();
  changes.insert(changes.end(),
                 {{"arc_deg: 320", "arc_deg: 80"},
                  {"supervision:\n",
                   "workspace: {x_mm: [-800, 900], y_mm: [-800, 800], z_mm: [-250, 1150], "
                   "hand_mm: 160}\n\nsupervision:\n"}});
  return changes;
}

// Drives as they are have 0.003 degrees of play of their own.
BenchProcess bending_arm() {
  const char* seed = std::getenv("ARMSIG_BENCH_SEED");
  return BenchProcess({"--target-mm", "150,0,50", "--start-deg", "0,-90,90,30,0,0", "--ping-ms",
                       "15", "--step-us", "2000", "--sensor-node", "32", "--maps-deg", "0.02",
                       "--deflection-mm", "0.5", "--backlash-deg", "0.002", "--seed",
                       seed == nullptr ? "1" : seed});
}

// NaN where it is not told.
double value_after(const std::string& line, const std::string& key) {
  const std::size_t at = line.find(fmt::format(" {}=", key));
  return at == std::string::npos ? std::nan("")
                                 : std::strtod(line.c_str() + at + key.size() + 2, nullptr);
}

JointVector any_pose(const controller::Configuration& configuration, simulated::Random& random) {
  JointVector q;
  for (std::size_t i = 0; i < configuration.drawing.joints.size(); ++i) {
    const auto [lower, upper] = configuration.drawing.limits[i];
    const double centre = configuration.sweeps.configuration[i];
    q.push_back(centre +
                configuration.sweeps.validation_reach * (random.uniform(lower, upper) - centre));
  }
  return q;
}

// Clear of what is around the arm.
JointVector random_pose(const controller::Configuration& configuration, simulated::Random& random) {
  for (;;) {
    JointVector q = any_pose(configuration, random);
    if (controller::room_at(configuration, q).left_m > controller::kLeastRoom_m) return q;
  }
}

// The arm stands at `q`, and the controller says so.
std::string stand_at(DaemonProcess& daemon, const JointVector& q) {
  std::string request = "move";
  for (std::size_t i = 0; i < q.size(); ++i) {
    request += fmt::format(" q{}_deg={:.6f}", i + 1, degrees(q[i]));
  }
  EXPECT_EQ(daemon.ask(request), "ok") << request;
  EXPECT_TRUE(daemon.is_in("holding"));
  std::this_thread::sleep_for(std::chrono::milliseconds(150));
  const std::string status = daemon.ask("status");
  for (std::size_t i = 0; i < q.size(); ++i) {
    EXPECT_NEAR(value_after(status, fmt::format("q{}_deg", i + 1)), degrees(q[i]), 0.01);
  }
  return status;
}

// Nobody helps it, and it ends by itself; then it is judged by the emulated arm's truth.
void calibrate_and_judge(const Changes& changes) {
  BenchProcess arm = bending_arm();
  DaemonProcess daemon(changes, arm.sensor_device);
  const auto configuration = daemon::read_configuration(daemon.configuration_path());
  ASSERT_TRUE(configuration) << tool::render(configuration.error());
  ASSERT_TRUE(daemon.enable());
  ASSERT_TRUE(daemon.identify(std::chrono::seconds(3600), "identify accuracy_mm=0.15 minutes=50"));
  const std::string told = daemon.heard("# identify accuracy=");
  std::printf("%s\n%s\n", told.c_str(), daemon.heard("# identify backlash").c_str());
  EXPECT_TRUE(told.starts_with("# identify accuracy=reached model=maps ")) << told;
  ASSERT_TRUE(daemon.is_in("holding"));
  std::printf("%s\n", daemon.ask("candidate").c_str());
  ASSERT_EQ(daemon.ask("accept"), "ok");

  simulated::Random random(99);
  double squares_mm2 = 0;
  double worst_mm = 0;
  for (int k = 0; k < kPoses && !testing::Test::HasFailure(); ++k) {
    const std::string status = stand_at(daemon, random_pose(configuration->controller, random));
    const Vector3 stated_mm(value_after(status, "x_mm"), value_after(status, "y_mm"),
                            value_after(status, "z_mm"));
    const double miss_mm = (stated_mm - 1e3 * arm.target_S()).norm();
    squares_mm2 += miss_mm * miss_mm;
    worst_mm = std::max(worst_mm, miss_mm);
  }
  const double rms_mm = std::sqrt(squares_mm2 / kPoses);
  const double predicted_mm = value_after(told, "predicted_tool_error_mm");
  std::printf("predicted %.3f mm, true %.3f mm (RMS of %d poses), worst %.3f mm\n", predicted_mm,
              rms_mm, kPoses, worst_mm);
  EXPECT_LE(rms_mm, kAsked_mm);
  EXPECT_NEAR(predicted_mm / rms_mm, 1, 0.35) << "what is stated is what there is";
}

TEST(BenchRun, self_calibration_reaches_its_accuracy_on_poses_never_measured) {
  calibrate_and_judge(sensor_of_a_tenth_of_a_millimetre());
}

TEST(BenchRun, self_calibration_with_the_sensor_on_can) { calibrate_and_judge(the_same_on_can()); }

TEST(BenchRun, self_calibration_in_a_workspace_box) { calibrate_and_judge(the_same_in_a_box()); }

}  // namespace
}  // namespace armsig::bench
