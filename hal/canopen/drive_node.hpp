// SPDX-License-Identifier: MIT
// One CiA 402 drive on a CANopen network: whether its node is there, set up and operational, and
// the frames that carry what the drive and its master tell each other. A node with several axes is
// one of these an axis: what concerns the node is told to each.
#pragma once

#include <cstdint>

#include "hal/canopen/configuration.hpp"
#include "hal/canopen/emergency.hpp"
#include "hal/canopen/protocol.hpp"
#include "hal/cia402/drive.hpp"
#include "hal/cia402/setup_run.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::canopen {

// How far a drive has come.
enum class Phase : std::uint8_t {
  kUnreset,      // the reset is still to be sent
  kBooting,      // the reset is sent, no boot-up message yet
  kBooted,       // waits for its turn
  kConfiguring,  // SDO requests
  kConfigured,   // set up, to be started with the other axes of its node
  kStarted,      // told to be operational, no position heard yet
  kRunning,      // exchanges PDOs
  kFailed,       // could not be set up
};

// Everything of the link that changes; plain, to be logged whole.
struct DriveNodeState {
  Phase phase = Phase::kUnreset;
  hal::Instant phase_since;
  unsigned boot_ups = 0;           // since the reset
  bool wholly_reset = false;       // by 81h, as it did not answer 82h
  bool absent = false;             // did not answer either, and is looked for again
  bool guarded = false;            // is asked whether it is there
  bool unsupervised = false;       // keeps its torque without its master, by its set-up
  std::uint32_t information = 0;   // last emergency that stopped nothing
  bool heard_operational = false;  // by a heartbeat, since the start
  // Feedback supervision.
  bool answered = false;         // a TPDO1 came since the last SYNC but one
  bool sync_unanswered = false;  // a SYNC was sent in the tick before
  unsigned missed = 0;
  hal::Instant heard_at;  // last heartbeat
  // Of the emergency of `information`, and of the one that is the fault.
  [[no_unique_address]] hal::DeviceDetails information_details = {};
  [[no_unique_address]] hal::DeviceDetails fault_details = {};
};

class DriveNode {
 public:
  // `axis` must outlive it.
  DriveNode(const AxisConfiguration& axis, const cia402::Scaling& scaling)
      : node_(axis.node), axis_(axis.axis), bus_(axis.bus), drive_(axis, scaling) {}

  [[nodiscard]] const DriveNodeState& state() const { return s_; }
  [[nodiscard]] cia402::Drive& drive() { return drive_; }
  [[nodiscard]] const cia402::Drive& drive() const { return drive_; }
  [[nodiscard]] NodeId node() const { return node_; }
  [[nodiscard]] std::uint16_t object(std::uint16_t index) const {
    return cia402::object_of_axis(axis_, index);
  }
  [[nodiscard]] BusNumber bus() const { return bus_; }
  [[nodiscard]] bool is_at(BusNumber bus, NodeId node) const {
    return node_ == node && bus_ == bus;
  }
  [[nodiscard]] bool shares_node(const DriveNode& other) const {
    return is_at(other.bus_, other.node_);
  }
  [[nodiscard]] std::uint32_t pdo_id(std::uint32_t function) const {
    return pdo1_id(function, node_, axis_);
  }
  [[nodiscard]] bool is_started() const {
    return s_.phase == Phase::kStarted || s_.phase == Phase::kRunning;
  }
  [[nodiscard]] bool is_guarded() const { return is_started() && s_.guarded; }
  [[nodiscard]] hal::DriveStatus status() const;

  void enter(Phase phase, hal::Instant now);
  // It does not answer the reset of its communication: it is reset as a whole, once.
  [[nodiscard]] bool may_be_wholly_reset() const { return !s_.wholly_reset; }
  void wait_for_whole_reset(hal::Instant now);
  // It is set up, as `report` says, and waits to be started; where a node has one axis, it is.
  void enter_set_up(const cia402::SetupReport& report, hal::Instant now);
  // Forgets the fault. One whose link or set-up failed goes back to Phase::kUnreset, at the next
  // release().
  void reset(hal::Instant now);
  // Another axis of its node is to be reset, which needs this one without torque.
  void reset_with_node(hal::Instant now);
  // It is on the way to a reset of its node.
  [[nodiscard]] bool awaits_reset() const {
    return s_.phase == Phase::kUnreset || drive_.state().leaving;
  }
  // It is looked for again; until it boots it has the fault kDriveAbsent.
  void look_again(hal::Instant now);
  // The torque of this drive may go: what waited for that is done.
  void release(hal::Instant now);

  // Frames of this node. False if `frame` has not the length of its kind, and was ignored.
  bool take_feedback(const hal::ReceivedCanFrame& received);
  bool take_heartbeat(const hal::CanFrame& frame, hal::Instant now);
  bool take_emergency(const hal::CanFrame& frame);

  // Time-outs and lost feedback, then what the drive itself is watched for. `sync_sent`: this tick
  // sent a SYNC. Latches kHeartbeatLost, kFeedbackLost, and what cia402::Drive::supervise() does.
  void supervise(const Configuration& configuration, bool sync_sent, hal::Instant now);

  // RPDO1: controlword and target position. Unless it `may_release` no command takes torque off.
  [[nodiscard]] hal::CanFrame command(bool may_release);

 private:
  void keep_details(const Emergency& emergency, bool is_fault);
  void supervise_link(const Configuration& configuration, bool sync_sent, hal::Instant now);

  NodeId node_;
  [[no_unique_address]] hal::AxisNumber axis_;
  [[no_unique_address]] BusNumber bus_;
  cia402::Drive drive_;
  DriveNodeState s_;
};

}  // namespace armsig::canopen
