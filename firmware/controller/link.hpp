// SPDX-License-Identifier: MIT
// All that passes between the servo tick and the background.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "firmware/controller/histogram.hpp"
#include "firmware/controller/latest_value.hpp"
#include "firmware/controller/machine.hpp"
#include "firmware/controller/mode.hpp"
#include "firmware/controller/model.hpp"
#include "firmware/controller/motion.hpp"
#include "hal/joint_drives.hpp"
#include "hal/mailbox.hpp"

namespace armsig::controller {

enum class CommandKind : std::uint8_t {
  kEnable,  // also needs every drive without torque
  kDisable,
  kReset,
  kStop,  // quick stop, Faulted with kQuickStop
  kHalt,  // the move and the sequence end in a ramp; a drive that is homing stops
  kMove,  // from where the arm is commanded to be, while none is under way; of a sequence: while it
          // lasts
  kBeginSequence,
  kEndSequence,  // a move under way is finished
  kAdoptModel,   // no move under way
  kHome,
};

[[nodiscard]] constexpr Modes modes_of(CommandKind kind) {
  switch (kind) {
    case CommandKind::kEnable:
      return Modes(Mode::kIdle);
    case CommandKind::kDisable:
      return Modes(Mode::kIdle, Mode::kHolding, Mode::kServoing, Mode::kSweeping, Mode::kHoming);
    case CommandKind::kReset:
      return Modes(Mode::kFaulted);
    case CommandKind::kHalt:
      return kWithTorque;
    case CommandKind::kMove:
      return Modes(Mode::kHolding, Mode::kServoing, Mode::kSweeping);
    case CommandKind::kHome:
    case CommandKind::kBeginSequence:
      return Modes(Mode::kHolding);
    case CommandKind::kStop:
    case CommandKind::kEndSequence:
    case CommandKind::kAdoptModel:
      break;
  }
  return kInAnyMode;
}

// A command that its mode does not allow is refused with kWrongMode.
struct Command {
  CommandKind kind = CommandKind::kStop;
  std::uint32_t serial = 0;
  Move move;                 // kMove
  bool of_sequence = false;  // the move is, which is refused once the sequence has ended
  std::size_t index = 0;     // kAdoptModel: into Link::models; kHome: the joint
};

// Why the controller is Faulted, or what it waits for while it is Starting.
struct Fault {
  Error error = Error::kNotFinite;
  std::optional<std::size_t> joint;
  std::uint32_t code = 0;  // the device's own, as in hal::DriveStatus
  std::string_view words;  // and what it means, or which of two buses fails
  hal::DeviceObject object = {};
  [[no_unique_address]] hal::DeviceDetails details = {};
};

// What became of a command.
struct CommandResult {
  std::uint32_t serial = 0;
  std::optional<Error> refused;
};

// What the tick publishes.
struct Snapshot {
  Mode mode = Mode::kStarting;
  std::optional<Fault> fault;
  std::uint32_t handled = 0;  // serial of the last command taken
  // Of the last commands taken, each at its serial modulo the size: more than the mailbox holds.
  std::array<CommandResult, 8> results{};
  JointVector positions;  // actual readings, where they are known
  JointVector commanded;
  bool moving = false;
  double left_s = 0;        // of the move under way, at most
  hal::Duration settled{};  // at rest within the tolerance for so long, up to now
  hal::Instant now;
  std::size_t model = 0;     // index of the model servoed with
  std::optional<Pose> X_RT;  // actual tool pose by that model; empty: a position is not known
  bool all_disabled = false;
  FixedVector<std::uint16_t, kMaxJoints> status_words;  // the drives' own
  std::uint8_t limits_active = 0;  // bit per joint: its drive limits the motion by itself
  std::uint8_t warning = 0;        // bit per joint: its drive warns
  std::uint8_t unsupervised = 0;   // bit per joint: its drive would keep its torque by itself
  std::uint8_t known = 0;          // bit per joint: its drive has told its position
  std::uint8_t homing = 0;         // bit per joint: its drive finds its reference
  std::uint8_t homed = 0;          // bit per joint: its drive has found it since it was set up
#ifndef ARMSIG_SMALL_IMAGE
  // Of each joint, as shares of the rated torque: now, and the largest of the last sequence.
  std::array<hal::Torque, kMaxJoints> torque{};
  std::array<double, kMaxJoints> largest_torque{};
#endif
  Histogram lateness;
  Histogram execution;

  // A number for what it waits for while it is Starting, of the error and its joint; 0: nothing.
  [[nodiscard]] std::uint32_t waits_for() const {
    if (hal::kSmallImage || mode != Mode::kStarting || !fault) return 0;
    const auto joint = static_cast<std::uint32_t>(fault->joint ? *fault->joint + 1 : 0);
    return (static_cast<std::uint32_t>(fault->error) + 1) << 8U | joint;
  }
};

// An object that a drive goes without, or has otherwise than wanted.
struct DriveGap {
  std::uint8_t joint = 0;  // from 0
  hal::DeviceObject object;
};
inline constexpr std::size_t kMostGaps = 24;  // of all drives that are told

// Of every drive that has one, in the order of the joints; a small image tells the first alone.
using DriveFaults = FixedVector<Fault, hal::kSmallImage ? 0 : kMaxJoints>;

// What a drive has said that stopped nothing.
struct DriveInformation {
  std::uint8_t joint = 0;  // from 0
  std::uint32_t code = 0;  // the device's own
  std::string_view words;  // and what it means
  [[no_unique_address]] hal::DeviceDetails details = {};
};
using DriveInformations = FixedVector<DriveInformation, DriveFaults::capacity()>;

// Sees every tick, from inside of it: to be bounded, and never to block.
class TickObserver {
 public:
  void take(const Snapshot& snapshot, hal::Duration lateness) { do_take(snapshot, lateness); }

 protected:
  ~TickObserver() = default;

 private:
  virtual void do_take(const Snapshot& snapshot, hal::Duration lateness) = 0;
};

struct Link {
  hal::Mailbox<Command, 4> commands;  // background to tick
  LatestValue<Snapshot> snapshot;     // tick to background
  LatestValue<Machine> machine;       // tick to background, whenever the drives have been set up
  LatestValue<FixedVector<DriveGap, kMostGaps>> gaps;  // before each machine
  LatestValue<DriveFaults> faults;                     // while there are any
  LatestValue<DriveInformations> information;          // of every drive that has said something
  // The background writes the one that the tick does not use, then sends kAdoptModel.
  std::array<Model, 2> models;
  TickObserver* observer = nullptr;  // set before the first tick
};

}  // namespace armsig::controller
