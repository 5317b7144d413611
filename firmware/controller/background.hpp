// SPDX-License-Identifier: MIT
// Everything outside the tick, a bounded step at a time: sensor, sequences, store, consoles.
#pragma once

#include <optional>
#include <span>

#include "firmware/controller/announcer.hpp"
#include "firmware/controller/grid_sequence.hpp"
#include "firmware/controller/identification_sequence.hpp"
#include "firmware/controller/mover.hpp"
#include "firmware/controller/point_measurement.hpp"
#include "firmware/controller/signature_store.hpp"
#include "hal/clock.hpp"

namespace armsig::controller {

class Background {
 public:
  // Loads the committed signature, if there is one, so that the first tick has it. `consoles` are
  // at most kMaxConsoles.
  Background(const Configuration& configuration, hal::RangeSensor& sensor, hal::Clock& clock,
             hal::NonvolatileMemory& memory, std::span<hal::Console* const> consoles, Link& link);

  // True if the next step has something to compute.
  bool step();

  [[nodiscard]] const Snapshot& snapshot() const { return mover_.now(); }
  [[nodiscard]] const IdentificationSequence& identification() const { return identification_; }
  [[nodiscard]] const GridSequence& grid() const { return grid_; }
  // The signature servoed with; empty: the drawing.
  [[nodiscard]] const std::optional<SignatureRecord>& active() const { return active_; }

 private:
  struct Client {
    std::size_t console = 0;
    hal::ConsoleClient id = 0;
  };
  // What of the store's work is under way.
  enum class Storing : std::uint8_t { kNothing, kWriting, kAdopting };
  using Verdict = Result<void>;

  void tell_changes();
  void step_store();
  void load();
  void adopt();
  void step_consoles();
  void answer(const hal::ConsoleLine& line);
  [[nodiscard]] Verdict serve(const Request& request);
  [[nodiscard]] Verdict command(CommandKind kind);
  [[nodiscard]] Verdict move(const Request& request);
  [[nodiscard]] Verdict move_joints(const Request& request, double pace);
  [[nodiscard]] Verdict move_tool(const Request& request, double pace);
  [[nodiscard]] Verdict identify();
  [[nodiscard]] Verdict touch_grid();
  [[nodiscard]] Verdict accept();
  [[nodiscard]] Verdict rollback();
  [[nodiscard]] Verdict log(const Request& request);
  void tell_status();
  void tell_signature();
  [[nodiscard]] Verdict tell_candidate();
  void reply(const Verdict& verdict);
  [[nodiscard]] bool is_busy() const {
    return identification_.is_running() || grid_.is_running() || storing_ != Storing::kNothing;
  }

  const Configuration& configuration_;
  hal::Clock& clock_;
  Link& link_;
  Announcer announcer_;
  Mover mover_;
  PointMeasurement measurement_;
  IdentificationSequence identification_;
  GridSequence grid_;
  SignatureStore store_;
  std::optional<SignatureRecord> active_;
  std::size_t model_ = 0;  // to be adopted
  hal::Duration longest_step_{};
  std::size_t turn_ = 0;  // the console to be read first
  Client client_;
  std::optional<Client> storing_for_;  // who waits for accept or rollback
  std::optional<Client> waiting_;      // who waits for the tick to take a command
  Line out_;
  std::optional<Error> store_error_;
  Storing storing_ = Storing::kNothing;
  Mode told_mode_ = Mode::kStarting;
  std::uint32_t told_code_ = 0;  // of the fault told
  bool waits_ = false;           // of the request being served: for the tick
  bool stores_ = false;          // of the request being served: for the store
};

}  // namespace armsig::controller
