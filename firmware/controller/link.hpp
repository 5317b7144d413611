// SPDX-License-Identifier: MIT
// All that passes between the servo tick and the background.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

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
  kEnable,         // Idle, every drive without torque
  kDisable,        // any mode but Starting and Faulted
  kReset,          // Faulted
  kStop,           // any mode: quick stop, Faulted with kEmergencyStop
  kHalt,           // Holding, Servoing, Sweeping: the move and the sequence end in a ramp
  kMove,           // Holding, or Sweeping at rest
  kBeginSequence,  // Holding
  kEndSequence,    // any mode; a move under way is finished
  kAdoptModel,     // no move under way
};

// A command that its mode does not allow is refused with kWrongMode.
struct Command {
  CommandKind kind = CommandKind::kStop;
  std::uint32_t serial = 0;
  Move move;              // kMove
  std::size_t model = 0;  // kAdoptModel: index into Link::models
};

// Why the controller is Faulted.
struct Fault {
  Error error = Error::kNotFinite;
  std::optional<std::size_t> joint;
  std::uint32_t code = 0;  // the device's own, as in hal::DriveStatus
};

// What the tick publishes.
struct Snapshot {
  Mode mode = Mode::kStarting;
  std::optional<Fault> fault;
  std::uint32_t handled = 0;     // serial of the last command taken
  std::optional<Error> refused;  // and why it was refused
  JointVector positions;         // actual readings
  JointVector commanded;
  bool moving = false;
  double left_s = 0;        // of the move under way
  hal::Duration settled{};  // at rest within the tolerance for so long, up to now
  hal::Instant now;
  std::size_t model = 0;  // index of the model servoed with
  Pose X_RT;              // actual tool pose by that model
  bool all_disabled = false;
  Histogram lateness;
  Histogram execution;
};

struct Link {
  hal::Mailbox<Command, 4> commands;  // background to tick
  LatestValue<Snapshot> snapshot;     // tick to background
  LatestValue<Machine> machine;       // tick to background, whenever the drives have been set up
  // The background writes the one that the tick does not use, then sends kAdoptModel.
  std::array<Model, 2> models;
};

}  // namespace armsig::controller
