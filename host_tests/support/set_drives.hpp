// SPDX-License-Identifier: MIT
// Drives of which every status, position and error is what a test sets, and that remember what they
// were told.
#pragma once

#include <optional>

#include "hal/joint_drives.hpp"

namespace armsig::test {

class SetDrives final : public hal::JointDrives {
 public:
  explicit SetDrives(std::size_t count) {
    statuses.resize(count);
    actual.resize(count);
    set_all(hal::DriveCondition::kDisabled);
  }
  void set_all(hal::DriveCondition condition) {
    for (hal::DriveStatus& status : statuses) {
      status.condition = condition;
      status.has_position = condition != hal::DriveCondition::kStarting;
    }
  }

  FixedVector<hal::DriveStatus, kMaxJoints> statuses;
  JointVector actual;
  JointVector targets;           // of the last write
  std::optional<Error> on_read;  // what each read, write or enabling fails with
  std::optional<Error> on_write;
  std::optional<std::size_t> faults_on_write;  // the drive that has the error of a write as well
  std::optional<Error> on_enable;
  int enabled = 0;  // how often each was asked for
  int disabled = 0;
  int quick_stops = 0;
  int resets = 0;

 private:
  static Result<void> outcome(const std::optional<Error>& error) {
    if (error) return std::unexpected(*error);
    return {};
  }
  [[nodiscard]] std::size_t do_count() const override { return statuses.size(); }
  Result<void> do_read(hal::Instant /*now*/) override { return outcome(on_read); }
  [[nodiscard]] const JointVector& do_positions() const override { return actual; }
  [[nodiscard]] hal::DriveStatus do_status(std::size_t joint) const override {
    return statuses[joint];
  }
  Result<void> do_write(const JointVector& readings, hal::Instant /*now*/) override {
    targets = readings;
    if (faults_on_write) statuses[*faults_on_write].fault = on_write;
    return outcome(on_write);
  }
  Result<void> do_enable() override {
    ++enabled;
    return outcome(on_enable);
  }
  void do_disable() override { ++disabled; }
  void do_quick_stop() override { ++quick_stops; }
  void do_reset_faults() override { ++resets; }
};

}  // namespace armsig::test
