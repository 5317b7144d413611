// SPDX-License-Identifier: MIT
// The drives of an arm whose joints are coupled, such as a Puma 560's wrist, as the drives of its
// joints: positions and targets are effective readings (core/base/arm.hpp), the motors' readings
// stay inside.
#pragma once

#include <optional>

#include "core/base/arm.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::controller {

class CoupledDrives final : public hal::JointDrives {
 public:
  // `motors` must outlive it. Precondition: no coupling leads back to the joint that it moves.
  CoupledDrives(const JointCouplings& couplings, hal::JointDrives& motors)
      : couplings_(couplings), motors_(motors), positions_(motors.positions()) {}

 private:
  [[nodiscard]] std::size_t do_count() const override { return motors_.count(); }
  Result<void> do_read(hal::Instant now) override {
    auto read = motors_.read(now);
    positions_ = effective_readings(couplings_, motors_.positions());
    return read;
  }
  [[nodiscard]] const JointVector& do_positions() const override { return positions_; }
  [[nodiscard]] hal::DriveStatus do_status(std::size_t joint) const override {
    hal::DriveStatus status = motors_.status(joint);
    for (const JointCoupling& coupling : couplings_) {
      if (coupling.joint != joint) continue;
      status.has_position = status.has_position && motors_.status(coupling.from).has_position;
    }
    return status;
  }
  [[nodiscard]] std::optional<hal::DriveIdentity> do_identity(std::size_t joint) const override {
    return motors_.identity(joint);
  }
  [[nodiscard]] std::optional<hal::DeviceObject> do_gap(std::size_t joint,
                                                        std::size_t number) const override {
    return motors_.gap(joint, number);
  }
  Result<void> do_write(const JointVector& targets, hal::Instant now) override {
    return motors_.write(readings_for(couplings_, targets), now);
  }
  Result<void> do_enable() override { return motors_.enable(); }
  void do_disable() override { motors_.disable(); }
  void do_quick_stop() override { motors_.quick_stop(); }
  void do_reset_faults() override { motors_.reset_faults(); }
  Result<void> do_home(std::size_t joint) override { return motors_.home(joint); }
  void do_stop_homing() override { motors_.stop_homing(); }

  JointCouplings couplings_;
  hal::JointDrives& motors_;
  JointVector positions_;
};

}  // namespace armsig::controller
