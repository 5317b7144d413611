// SPDX-License-Identifier: MIT
// Everything outside the tick, a bounded step at a time: sensor, sequences, store, consoles.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "firmware/controller/announcer.hpp"
#include "firmware/controller/check_sequence.hpp"
#include "firmware/controller/commit.hpp"
#include "firmware/controller/custody.hpp"
#include "firmware/controller/desk.hpp"
#include "firmware/controller/grid_sequence.hpp"
#include "firmware/controller/identification_sequence.hpp"
#include "firmware/controller/mover.hpp"
#include "firmware/controller/point_measurement.hpp"
#include "firmware/controller/references.hpp"
#include "hal/clock.hpp"

namespace armsig::controller {

class Background {
 public:
  // Loads the committed signature, if there is one, so that the first tick has it. `consoles` are
  // at most kMaxConsoles.
  Background(const Configuration& configuration, Instrument instrument, hal::Clock& clock,
             hal::NonvolatileMemory& memory, std::span<hal::Console* const> consoles, Link& link,
             Refinement* refinement = nullptr, CheckMemory* checks = nullptr);

  // True if the next step has something to compute.
  bool step();

  [[nodiscard]] const Snapshot& snapshot() const { return mover_.now(); }
  [[nodiscard]] const IdentificationSequence& identification() const { return identification_; }
  [[nodiscard]] const GridSequence& grid() const { return grid_; }
  [[nodiscard]] const CheckSequence& check() const { return check_; }
  // Bit per joint that is unreferenced.
  [[nodiscard]] std::uint8_t unreferenced() const { return references_.unreferenced(); }
  // At the end: keeps where `drives` are, if none has torque.
  void finish(const hal::JointDrives& drives) { references_.finish(drives); }
  // The signature servoed with; empty: the drawing.
  [[nodiscard]] const std::optional<SignatureRecord>& active() const { return custody_.active(); }

 private:
  void tell_changes();
  void look_at_machine(bool set_up);
  void tell_gaps();
  void tell_faults();
  void tell_information();

  const Configuration& configuration_;
  hal::Clock& clock_;
  Link& link_;
  Announcer announcer_;
  Mover mover_;
  PointMeasurement measurement_;
  IdentificationSequence identification_;
  GridSequence grid_;
  Custody custody_;
  CheckSequence check_;
  Commit commit_;
  References references_;
  hal::Duration longest_step_ = -hal::Duration(1);  // none is over yet
  Desk desk_;
  Mode told_mode_ = Mode::kStarting;
  std::uint32_t told_code_ = 0;  // of the fault told
  // Error and code of each joint's.
  std::array<std::optional<std::pair<Error, std::uint32_t>>, DriveFaults::capacity()> told_faults_;
  std::array<std::uint32_t, DriveInformations::capacity()> told_information_{};
  std::uint32_t told_wait_ = 0;  // as Snapshot::waits_for()
};

}  // namespace armsig::controller
