// SPDX-License-Identifier: MIT
// One CiA 402 drive as its master sees it: what it told, what it is commanded, what went wrong.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/error.hpp"
#include "hal/canopen/cia402.hpp"
#include "hal/canopen/configuration.hpp"
#include "hal/canopen/protocol.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::canopen {

// How far a drive has come.
enum class Phase : std::uint8_t {
  kUnreset,      // the reset is still to be sent
  kBooting,      // the reset is sent, no boot-up message yet
  kBooted,       // waits for its turn
  kConfiguring,  // SDO requests
  kStarted,      // told to be operational, no position heard yet
  kRunning,      // exchanges PDOs
  kFailed,       // could not be set up
};

// What an enabled drive says of itself that ends in a fault if it lasts.
inline constexpr std::size_t kStatusRules = 5;

// Everything that changes; plain, to be logged whole.
struct DriveNodeState {
  Phase phase = Phase::kUnreset;
  hal::Instant phase_since;
  unsigned boot_ups = 0;  // since the reset
  std::optional<Error> fault;
  std::uint32_t fault_code = 0;
  // As the last TPDO1 told.
  cia402::State state = cia402::State::kNotReadyToSwitchOn;
  std::uint16_t status_word = 0;
  std::int32_t actual_counts = 0;
  double position = 0;
  hal::Instant position_at;
  std::array<hal::Instant, kStatusRules> well_at{};  // when each rule was last kept
  std::uint32_t information = 0;                     // last emergency that told no error
  bool heard_operational = false;                    // by a heartbeat, since the start
  // Standstill: `rest_position` was left for the last time at `moved_at`.
  double rest_position = 0;
  hal::Instant moved_at;
  bool tells_rest = false;  // has used bit 10 of the statusword in Quick stop active
  bool stands = true;
  bool held = false;  // in Quick stop active, until torque may go
  // Feedback supervision.
  bool answered = false;         // a TPDO1 came since the last SYNC but one
  bool sync_unanswered = false;  // a SYNC was sent in the tick before
  unsigned missed = 0;
  hal::Instant heard_at;  // last heartbeat
  // Command.
  cia402::Goal goal = cia402::Goal::kDisabled;
  hal::Instant progress_at;                 // last change of state or goal
  bool arrived = false;                     // the goal was reached since it was set
  bool resetting = false;                   // a fault reset is under way
  bool set_up_again = false;                // to be reset by NMT as soon as the torque may go
  std::optional<hal::Instant> released_at;  // since when it may
  bool reset_bit = false;                   // fault reset bit of the last controlword
  double target = 0;
  hal::Instant target_at;
};

class DriveNode {
 public:
  DriveNode(const AxisConfiguration& axis, const Scaling& scaling)
      : axis_(&axis), scaling_(scaling) {}

  [[nodiscard]] const DriveNodeState& state() const { return s_; }
  [[nodiscard]] NodeId node() const { return axis_->node; }
  [[nodiscard]] bool is_started() const {
    return s_.phase == Phase::kStarted || s_.phase == Phase::kRunning;
  }
  [[nodiscard]] hal::DriveStatus status() const;

  void enter(Phase phase, hal::Instant now);
  void set_goal(cia402::Goal goal, hal::Instant now);
  [[nodiscard]] bool is_enabled() const {
    return s_.goal == cia402::Goal::kEnabled && s_.state == cia402::State::kOperationEnabled;
  }
  // Keeps the first fault.
  void latch(Error error, std::uint32_t code = 0);
  // Forgets the fault; a drive in Fault is reset by the following controlwords, and one whose link
  // or set-up failed goes back to Phase::kUnreset, at the next release().
  void reset(hal::Instant now);
  // The torque of this drive may go: what waited for that is done.
  void release(hal::Instant now);

  // Frames of this node. False if `frame` has not the length of its kind, and was ignored.
  bool take_feedback(const hal::ReceivedCanFrame& received);
  bool take_heartbeat(const hal::CanFrame& frame, hal::Instant now);
  bool take_emergency(const hal::CanFrame& frame);

  // Time-outs, lost feedback, states left by themselves, and what the statusword tells.
  // `sync_sent`: this tick sent a SYNC. Latches kHeartbeatLost, kFeedbackLost, kDriveFault,
  // kDriveDroppedOut, kTransitionTimeout, kTargetsIgnored, kDriveLimited, kDriveLags,
  // kDriveWarning, kVoltageLost.
  void supervise(const Configuration& configuration, bool sync_sent, hal::Instant now);

  // Takes the target for the next RPDO1: `target` if every drive of the group is enabled, the
  // former one if only this is, its position else. Errors: kNotFinite, kJointLimit, kTargetStep;
  // the former target then stays.
  Result<void> set_target(double target, bool group_enabled, hal::Duration period,
                          hal::Instant now);

  // RPDO1: controlword and target position. Unless it `may_release` no command takes torque off.
  [[nodiscard]] hal::CanFrame command(bool may_release);

 private:
  void take_rest(hal::Instant at);
  void update_rest(hal::Duration period, hal::Instant now);
  void check_state(const Configuration& configuration, hal::Instant now);
  void check_status_word(const StatusLimits& limits, hal::Instant now);

  const AxisConfiguration* axis_;
  Scaling scaling_;
  DriveNodeState s_;
};

}  // namespace armsig::canopen
