// SPDX-License-Identifier: MIT
// CANopen master (CiA 301) of the CiA 402 drives of one arm, over any CAN bus.
//
// The drives may be on two buses. SYNC is sent on both before a frame of either is taken, nothing
// is waited for, and what stops the drives of one bus stops those of the other. No drive is reset
// for the first time while a bus is down. A tick, in fixed order:
//   read():  SYNC first, so that its jitter is that of the tick alone; then every frame that has
//            arrived (at most kMaxFramesPerTick a bus); then supervision of each drive; then the
//            reaction of the group.
// Stopping and stopped are two conditions: after a stop no command that takes torque off, and no
// reset, is sent before every position stands, or Configuration::stop_timeout is over.
//   write(): the master's heartbeat if it is due; one step of the set-up of one drive; RPDO1 of
//            every drive whose position is known. An RPDO1 takes effect at the next SYNC
//            (transmission type 1).
// No drive is reset for the first time before all that have torque by a former master were stopped
// and stand, or Configuration::stop_timeout is over (rest_inquiry.hpp).
// Drives are set up one after the other, with one SDO request under way at a time. The axes of one
// node are reset together, set up one after the other, and started together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "core/base/fixed_vector.hpp"
#include "hal/can_bus.hpp"
#include "hal/canopen/buses.hpp"
#include "hal/canopen/configuration.hpp"
#include "hal/canopen/drive_node.hpp"
#include "hal/canopen/drive_setup.hpp"
#include "hal/canopen/homing_run.hpp"
#include "hal/canopen/rest_inquiry.hpp"
#include "hal/canopen/sdo_client.hpp"
#include "hal/cia402/group.hpp"
#include "hal/cia402/setup_run.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::canopen {

// Takes the frames that are none of the drives', such as those of a range sensor on the same bus.
class FrameSink {
 public:
  void take(const hal::ReceivedCanFrame& received) { do_take(received); }

 protected:
  ~FrameSink() = default;

 private:
  virtual void do_take(const hal::ReceivedCanFrame& received) = 0;
};

// Of one bus.
struct MasterCounters {
  std::uint32_t malformed = 0;  // frames of a drive with a wrong length
  std::uint32_t foreign = 0;    // frames that only a master sends, sent by somebody else
  std::uint32_t unknown = 0;    // frames of nobody that is configured, extended and remote ones
  std::uint32_t unsent = 0;     // own frames that the bus did not take
#ifndef ARMSIG_SMALL_IMAGE
  std::uint32_t unanswered = 0;       // SYNCs that a started drive left unanswered
  std::uint32_t late_heartbeats = 0;  // of started drives, after more than twice their period
  std::uint32_t emergencies = 0;      // of drives, but for "no error"
  std::uint32_t repeated = 0;         // requests of the set-up that were sent again
#endif
};

class Master final : public hal::JointDrives {
 public:
  // Largest number of frames taken in a tick. A full cycle brings two a drive; what a flood brings
  // beyond this waits in the bus's queue, which may overflow, but the tick stays short.
  static constexpr unsigned kMaxFramesPerTick = 64;
  // Ticks in a row in which the bus takes no frame before it counts as a fault of every drive.
  static constexpr unsigned kBusBusyLimit = 3;

  // `bus` and `other_frames` (which may be null) must outlive the master.
  Master(const CheckedConfiguration& configuration, hal::CanBus& bus,
         FrameSink* other_frames = nullptr)
      : Master(configuration, NamedBuses{{&bus, {}}}, other_frames) {}
  // As many buses as the configuration has.
  Master(const CheckedConfiguration& configuration, const NamedBuses& buses,
         FrameSink* other_frames = nullptr);
  Master(const Master&) = delete;
  Master& operator=(const Master&) = delete;

  [[nodiscard]] const MasterCounters& counters(BusNumber bus = 0) const {
    return buses_[bus].counters;
  }
  [[nodiscard]] const DriveNodeState& node_state(std::size_t joint) const {
    return nodes_[joint]->state();
  }
  // What a drive goes without, of those that were set up.
  [[nodiscard]] const cia402::SetupReport& setup_report(std::size_t joint) const {
    return reports_[joint];
  }
  [[nodiscard]] const cia402::DriveState& drive_state(std::size_t joint) const {
    return nodes_[joint]->drive().state();
  }

 private:
  [[nodiscard]] std::size_t do_count() const override { return nodes_.size(); }
  Result<void> do_read(hal::Instant now) override;
  [[nodiscard]] const JointVector& do_positions() const override { return positions_; }
  [[nodiscard]] hal::DriveStatus do_status(std::size_t joint) const override {
    if constexpr (kMostBuses > 1) return with_bus(*nodes_[joint]);
    return nodes_[joint]->status();
  }
  [[nodiscard]] std::optional<hal::DriveIdentity> do_identity(std::size_t joint) const override {
    if (!nodes_[joint]->is_started()) return std::nullopt;
    return identities_[joint];
  }
  [[nodiscard]] std::optional<hal::DeviceObject> do_gap(std::size_t joint,
                                                        std::size_t number) const override {
    const auto& gaps = reports_[joint].gaps;
    if (!nodes_[joint]->is_started() || number >= gaps.size()) return std::nullopt;
    return gaps[number];
  }
  Result<void> do_write(const JointVector& targets, hal::Instant now) override;
  Result<void> do_enable() override;
  void do_disable() override;
  void do_quick_stop() override;
  void do_reset_faults() override;
  Result<void> do_home(std::size_t joint) override;
  void do_stop_homing() override;

  // What is of one bus.
  struct Bus {
    std::optional<hal::Instant> heartbeat_at;
    hal::CanBus* can = nullptr;
    [[no_unique_address]] BusName name;
    MasterCounters counters;
    unsigned busy_ticks = 0;
    std::array<bool, kMaxOtherNodes> other_needs_start{};
    bool busy_now = false;
    bool usable = false;  // at the last tick; not kept of the only bus

    Result<void> send(const hal::CanFrame& frame);
  };
  // Of one bus in one tick.
  struct Cycle {
    hal::CanState state = hal::CanState::kDown;
    bool sync_sent = false;
    [[nodiscard]] bool is_usable() const {
      return state != hal::CanState::kDown && state != hal::CanState::kBusOff;
    }
  };

  Result<void> send_to(const DriveNode& drive, const hal::CanFrame& frame) {
    return buses_[drive.bus()].send(frame);
  }
  [[nodiscard]] std::uint8_t bus_count() const { return configuration_->buses.count; }
  // A bus that fails is named, or has another master.
  [[nodiscard]] hal::DriveStatus with_bus(const DriveNode& drive) const;
  // What is inline is called in one place, of master.cpp.
  [[nodiscard]] inline Cycle begin_cycle(BusNumber bus);
  inline void read_bus(BusNumber bus, const Cycle& cycle);
  inline void begin_write(BusNumber bus, hal::Instant now);
  inline void end_write(BusNumber bus);
  [[nodiscard]] hal::ReceivedCanFrame with_plausible_stamp(hal::ReceivedCanFrame received) const;
  void take(const hal::ReceivedCanFrame& received, BusNumber bus);
  [[nodiscard]] bool is_about_ours(const hal::CanFrame& nmt, BusNumber bus) const;
  void count_frame(const DriveNode& drive, const hal::CanFrame& frame);
  void take_of_drive(DriveNode& drive, const hal::ReceivedCanFrame& received);
  bool take_pdo(DriveNode& drive, const hal::ReceivedCanFrame& received);
  void take_of_other(const hal::ReceivedCanFrame& received, BusNumber bus);
  void latch_started(Error error, BusNumber bus);
  void latch_second_master(BusNumber bus);
  void release_drives();
  void step_others(BusNumber bus);
  // True while a drive may still be moving by its former master.
  bool step_inquiries();
  void take_answer(const DriveNode& drive, const hal::CanFrame& frame);
  void look_again();
  void reset_drives();
  void step_setup();
  void step_requests(DriveNode& drive);
  void finish_setup(DriveNode& drive);
  void start_configured();
  // Each axis of the node that `drive` is of, itself too.
  template <typename F>
  void for_axes_of(DriveNode& drive, const F& do_with) {
    if constexpr (cia402::kMostAxes == 1) {
      do_with(drive);
    } else {
      for (auto& axis : nodes_) {
        if (axis->shares_node(drive)) do_with(*axis);
      }
    }
  }
  [[nodiscard]] bool all_await_reset(DriveNode& drive);
  void reset_whole_nodes();
  // Of the axes of a node, the one that has asked least lately, while none is asking.
  [[nodiscard]] bool may_ask(std::size_t joint) const;
  inline void send_guarding(BusNumber bus);
  void fail_setup(DriveNode& drive, const cia402::SetupRefusal& refusal);
  void take_setup_answer(DriveNode& drive, const SdoOutcome& outcome);
  void wait_for_boot_up(DriveNode& drive);
  // What a drive shows as its mode once it is enabled.
  void step_mode_inquiry();
  void take_mode(DriveNode& drive, const SdoOutcome& outcome);
  void step_homing();

  CheckedConfiguration configuration_;
  std::array<Bus, kMostBuses> buses_;
  FrameSink* other_frames_;
  BusNumber second_master_on_ = 0;
  FixedVector<std::optional<DriveNode>, kMaxJoints> nodes_;
  std::array<hal::DriveIdentity, kMaxJoints> identities_{};  // of those that were set up
  std::array<cia402::SetupReport, kMaxJoints> reports_;
  JointVector positions_;
  cia402::Group group_;
  hal::Instant now_;
  // Before the first reset; empty after it.
  FixedVector<std::optional<RestInquiry>, kMaxJoints> inquiries_;
  std::optional<hal::Instant> inquiring_since_;
  // Set-up of one drive at a time.
  std::optional<std::size_t> setup_joint_;
  cia402::SetupRun setup_;
  std::optional<SdoTransfer> transfer_;
  // The mode of a drive that shows it in Operation enabled only.
  std::optional<std::size_t> mode_joint_;
  std::optional<SdoTransfer> mode_inquiry_;
  // Of one drive at a time.
  struct NoHoming {  // takes no memory
    explicit operator bool() const { return false; }
    HomingRun* operator->() { return nullptr; }
    void emplace(const Configuration& /*configuration*/, std::size_t /*joint*/) {}
    void reset() {}
  };
  using OneHoming = std::optional<HomingRun>;
  [[no_unique_address]] std::conditional_t<hal::kMayHome, OneHoming, NoHoming> homing_;
};

}  // namespace armsig::canopen
