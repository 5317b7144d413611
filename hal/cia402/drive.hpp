// SPDX-License-Identifier: MIT
// One CiA 402 drive in a position mode, behind any transport: what it told, what it is commanded,
// what is wrong with it. A transport calls hear() with what a cycle brought, sends
// what command() says, and tells by latch() what went wrong on the way.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/error.hpp"
#include "hal/cia402/settings.hpp"
#include "hal/cia402/state_machine.hpp"
#include "hal/device_object.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::cia402 {

// What an enabled drive says of itself that ends in a fault if it lasts.
inline constexpr std::size_t kStatusRules = 5;

// How far a drive is that homes.
enum class Homing : std::uint8_t {
  kNone,
  kEntering,   // is told the mode
  kSearching,  // moves by itself
  kLeaving,    // is told its former mode again, once it stands
};

// Everything that changes; plain, to be logged whole.
struct DriveState {
  std::optional<Error> fault;
  std::uint32_t fault_code = 0;
  hal::DeviceObject fault_object;
  // As the last cycle told.
  bool heard = false;       // since the transport has started it
  bool hides_mode = false;  // its mode (6061h) is still to be read, in Operation enabled
  State state = State::kNotReadyToSwitchOn;
  std::uint16_t status_word = 0;
  std::int32_t actual_counts = 0;
  [[no_unique_address]] hal::Torque torque = {};
  double position = 0;
  hal::Instant position_at;
  std::array<hal::Instant, kStatusRules> well_at{};  // when each rule was last kept
  // Standstill: `rest_position` was left for the last time at `moved_at`.
  double rest_position = 0;
  hal::Instant moved_at;
  bool tells_rest = false;  // has used bit 10 of the statusword in Quick stop active
  bool stands = true;
  bool held = false;  // in Quick stop active, until torque may go
  // Command.
  Goal goal = Goal::kDisabled;
  hal::Instant progress_at;                 // last change of state, goal or homing
  bool arrived = false;                     // the goal was reached since it was set
  bool resetting = false;                   // a fault reset is under way
  bool leaving = false;                     // for a new set-up, as soon as the torque may go
  std::optional<hal::Instant> released_at;  // since when it may
  Homing homing = Homing::kNone;
  bool searched = false;   // its statusword has denied since then that the reference is found
  bool homed = false;      // found it since it was set up
  bool reset_bit = false;  // fault reset bit of the last controlword
  // Profile position: a target is offered (controlword bit 4) until the drive takes it, and the
  // next one once the drive has seen that the offer is over.
  bool offers = false;
  bool taken = false;  // since it was enabled, it has taken one
  std::int32_t offered_counts = 0;
  double target = 0;
  hal::Instant target_at;
};

// What a cycle sends.
struct Setpoint {
  std::uint16_t control_word = 0;  // object 6040h
  std::int32_t target_counts = 0;  // object 607Ah, or 60C1h:1
};

class Drive {
 public:
  // `settings` must outlive it.
  Drive(const DriveSettings& settings, const Scaling& scaling)
      : settings_(&settings), scaling_(scaling) {}

  [[nodiscard]] const DriveState& state() const { return s_; }
  // Without words: what a code means is told by who knows where it came from.
  [[nodiscard]] hal::DriveStatus status() const;
  [[nodiscard]] bool is_enabled() const {
    return s_.goal == Goal::kEnabled && s_.state == State::kOperationEnabled && !is_homing();
  }
  [[nodiscard]] bool is_homing() const { return hal::kMayHome && s_.homing != Homing::kNone; }

  // A cycle brought objects 6041h and 6064h. Latches kFeedbackImplausible.
  void hear(std::uint16_t status_word, std::int32_t counts, hal::Instant at);
  // The cycle brought object 6077h as well.
  void hear_torque(std::int16_t per_mille);
  [[nodiscard]] bool tells_torque() const { return settings_->tells_torque(); }
  // The transport begins anew with it: what it told counts no more.
  void forget();

  void set_goal(Goal goal, hal::Instant now);
  // Keeps the first fault.
  void latch(Error error, std::uint32_t code = 0, const hal::DeviceObject& object = {});
  // The drive's own reason for the kDriveFault that was latched, told after it.
  void explain(std::uint32_t code);
  // Its mode is to be seen once it is enabled, before it counts as arrived; it has been seen.
  void hide_mode() { s_.hides_mode = true; }
  void show_mode() { s_.hides_mode = false; }
  // In Operation enabled, and its mode is still to be seen.
  [[nodiscard]] bool awaits_mode() const { return s_.hides_mode && is_enabled(); }
  // It is to find its reference: it is told the mode, searches, is told its former mode again. Who
  // tells it calls search() after the first, and end_homing() after the second.
  // Precondition: is_enabled().
  void begin_homing(hal::Instant now) { enter_homing(Homing::kEntering, now); }
  void search(hal::Instant now);
  // It is to stop searching. Also what any other goal than Goal::kEnabled does.
  void leave_homing(hal::Instant now);
  // It counts as arrived once it has shown its mode.
  void end_homing(hal::Instant now);
  // Forgets the fault; a drive in Fault is reset by the following controlwords.
  void reset(hal::Instant now);
  // Its settings are in doubt: it is to be set up anew as soon as its torque is gone. `rebooted`:
  // its state is not known any more.
  void leave(bool rebooted);
  // The torque may be taken off this drive. Whether it is leaving and has none any more, or takes
  // too long over it.
  [[nodiscard]] bool has_let_go(hal::Instant now);

  // Once a tick, after hear(): whether it stands, keeps its state, and what its statusword says.
  // Latches kDriveFault, kDriveDroppedOut, kTransitionTimeout, kTargetsIgnored, kDriveLimited,
  // kDriveLags, kDriveWarning, kVoltageLost, kHomingFailed.
  void supervise(const GroupSettings& settings, hal::Instant now);

  // Takes the target of the next cycle: `target` if every drive of the group is enabled, the former
  // one if only this is, its position else. Errors: kNotFinite, kJointLimit, kTargetStep; the
  // former target then stays.
  Result<void> set_target(double target, bool group_enabled, hal::Duration period,
                          hal::Instant now);

  // Unless it `may_release` no command takes torque off.
  [[nodiscard]] Setpoint command(bool may_release);

 private:
  [[nodiscard]] bool follows() const;
  [[nodiscard]] bool keeps_in_mode(std::uint16_t mask, std::uint16_t well) const;
  Setpoint offer(Setpoint wanted);
  void take_rest(hal::Instant at);
  void update_rest(hal::Duration period, hal::Instant now);
  void check_state(const GroupSettings& settings, hal::Instant now);
  void enter_homing(Homing stage, hal::Instant now);
  void check_homing(const GroupSettings& settings, hal::Instant now);
  void check_status_word(const StatusLimits& limits, hal::Instant now);

  const DriveSettings* settings_;
  Scaling scaling_;
  DriveState s_;
};

}  // namespace armsig::cia402
