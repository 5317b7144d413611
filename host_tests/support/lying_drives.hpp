// SPDX-License-Identifier: MIT
// Joints whose readings are not where the joints are, and the controller before them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "firmware/controller/controller.hpp"
#include "hal/simulated/virtual_clock.hpp"
#include "host_tests/support/puma_cabinet.hpp"
#include "host_tests/support/silent_sensor.hpp"

namespace armsig::test {

// Joints with encoders that may lie: each reads a multiple of where it is, less what was lost. Some
// count from zero at every power-up, until their drives have brought them where they began.
class LyingDrives final : public hal::JointDrives {
 public:
  explicit LyingDrives(const JointVector& at)
      : joints(at), scale(at.size(), 1.0), lost(at.size(), 0.0), readings(at), home_(at) {
    for (std::uint32_t i = 0; i < at.size(); ++i) {
      identities.push_back(
          {.device = {1, 2, 3, 1001 + i}, .counts_per_revolution = 4000, .gear_ratio = 100});
    }
  }
  void power_up() {
    condition = hal::DriveCondition::kDisabled;
    homing.reset();
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (counts_anew[i]) lost[i] = scale[i] * joints[i];
      homed[i] = false;
    }
    refresh();
  }
  // The joints stand where they read what they read last.
  void stand_at_readings() {
    for (std::size_t i = 0; i < joints.size(); ++i) joints[i] = (readings[i] + lost[i]) / scale[i];
  }
  void refresh() {
    for (std::size_t i = 0; i < joints.size(); ++i) readings[i] = scale[i] * joints[i] - lost[i];
  }

  JointVector joints;  // where they are
  JointVector scale;
  JointVector lost;
  JointVector readings;
  FixedVector<hal::DriveIdentity, kMaxJoints> identities;
  hal::DriveCondition condition = hal::DriveCondition::kDisabled;
  std::array<bool, kMaxJoints> counts_anew{};
  std::array<bool, kMaxJoints> homed{};
  std::optional<std::size_t> homing;  // joint

 private:
  static constexpr double kHomingStep = 0.02;  // a tick
  static constexpr int kShortestSearch = 60;   // ticks

  [[nodiscard]] std::size_t do_count() const override { return joints.size(); }
  Result<void> do_read(hal::Instant /*now*/) override {
    if (homing) search(*homing);
    refresh();
    return {};
  }
  void search(std::size_t joint) {
    const double way = home_[joint] - joints[joint];
    joints[joint] += std::clamp(way, -kHomingStep, kHomingStep);
    if (--search_left_ > 0 || std::abs(way) > kHomingStep) return;
    lost[joint] = 0;
    homed[joint] = true;
    homing.reset();
  }
  [[nodiscard]] const JointVector& do_positions() const override { return readings; }
  [[nodiscard]] hal::DriveStatus do_status(std::size_t joint) const override {
    hal::DriveStatus status;
    status.condition = homing == joint ? hal::DriveCondition::kHoming : condition;
    status.homed = homed[joint];
    status.has_position = true;
    return status;
  }
  [[nodiscard]] std::optional<hal::DriveIdentity> do_identity(std::size_t joint) const override {
    return identities[joint];
  }
  Result<void> do_write(const JointVector& targets, hal::Instant /*now*/) override {
    if (condition != hal::DriveCondition::kEnabled) return {};
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (i != homing) joints[i] = (targets[i] + lost[i]) / scale[i];
    }
    return {};
  }
  Result<void> do_home(std::size_t joint) override {
    homing = joint;
    search_left_ = kShortestSearch;
    homed[joint] = false;
    lost[joint] = scale[joint] * joints[joint];  // counts from there on, until it has found it
    return {};
  }
  void do_stop_homing() override { homing.reset(); }
  Result<void> do_enable() override {
    condition = hal::DriveCondition::kEnabled;
    return {};
  }
  void do_disable() override {
    condition = hal::DriveCondition::kDisabled;
    homing.reset();
  }
  void do_quick_stop() override { do_disable(); }
  void do_reset_faults() override { do_disable(); }

  JointVector home_;
  int search_left_ = 0;
};

// The whole controller before such drives.
struct LyingPlant {
  explicit LyingPlant(const controller::Configuration& of = puma_controller())
      : configuration(of), drives(of.sweeps.configuration) {
    power_up();
  }
  // As after a loss of power: the memory, the arm and its drives are what remains.
  void power_up() {
    controller.reset();
    console.told.clear();
    drives.power_up();
    controller = std::make_unique<controller::Controller>(configuration, drives, sensor, clock,
                                                          memory, consoles);
    run(5);
  }
  void step() {
    controller->tick({});
    controller->background();
    clock.wait_until(next += configuration.period);
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) step();
  }
  std::string ask(const std::string& request) {
    const std::size_t before = console.replies.size();
    console.requests.push_back(request);
    for (int i = 0; i < 500 && console.replies.size() == before; ++i) step();
    return console.replies.size() == before ? "" : console.replies.back();
  }
  bool rest_after(const std::string& request) {
    if (ask(request) != "ok") return false;
    for (int i = 0; i < 5000; ++i) {
      step();
      if (i > 2 && controller->state().snapshot().mode != controller::Mode::kServoing) return true;
    }
    return false;
  }
  [[nodiscard]] bool told(const std::string& begin) const {
    return std::ranges::any_of(console.told,
                               [&](const std::string& line) { return line.starts_with(begin); });
  }

  controller::Configuration configuration;
  RamMemory memory;
  LyingDrives drives;
  SilentSensor sensor;
  simulated::VirtualClock clock;
  LineConsole console;
  std::array<hal::Console*, 1> consoles{&console};
  hal::Instant next;
  std::unique_ptr<controller::Controller> controller;
};

}  // namespace armsig::test
