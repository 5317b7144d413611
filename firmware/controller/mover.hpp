// SPDX-License-Identifier: MIT
// The background's hand on the tick: sends commands, and knows what became of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/controller/link.hpp"

namespace armsig::controller {

// Names a command that was sent, for whoever sent it to ask what became of it.
using Ticket = std::uint32_t;

class Mover {
 public:
  // Whose move it is.
  enum class Of : std::uint8_t { kOperator, kSequence };

  explicit Mover(Link& link) : link_(link) {}

  // To be called first in every step of the background.
  const Snapshot& refresh() {
    snapshot_ = &link_.snapshot.read();
    return *snapshot_;
  }
  [[nodiscard]] const Snapshot& now() const { return *snapshot_; }

  // Empty if the mailbox is full: the tick has stopped.
  std::optional<Ticket> send(Command command) {
    command.serial = serial_ + 1;
    if (!link_.commands.post(command)) return std::nullopt;
    return ++serial_;
  }
  std::optional<Ticket> send(CommandKind kind) {
    Command command;
    command.kind = kind;
    return send(command);
  }
  // A sequence whose moves are `pace` times as fast as they may be, in (0, 1]. A small image knows
  // no other pace than 1.
  std::optional<Ticket> begin_sequence([[maybe_unused]] double pace = 1) {
#ifndef ARMSIG_SMALL_IMAGE
    pace_ = pace;
#endif
    return send(CommandKind::kBeginSequence);
  }
#ifdef ARMSIG_SMALL_IMAGE
  [[nodiscard]] static constexpr double sequence_pace() { return 1; }
#else
  [[nodiscard]] double sequence_pace() const { return pace_; }
#endif
  // A function of its own: the command would stand on the stack below the planning of the move.
  [[gnu::noinline]] std::optional<Ticket> send(const Move& move, Of of = Of::kOperator) {
    Command command;
    command.kind = CommandKind::kMove;
    command.move = move;
    command.of_sequence = of == Of::kSequence;
    return send(command);
  }

  // Whether the tick has taken the command; then its refusal, if there was one. To be asked in
  // every step of the background until it is handled: the tick remembers the last results only.
  [[nodiscard]] bool is_handled(Ticket ticket) const {
    return static_cast<std::int32_t>(snapshot_->handled - ticket) >= 0;
  }
  [[nodiscard]] std::optional<Error> refusal(Ticket ticket) const {
    const CommandResult& result = snapshot_->results[ticket % snapshot_->results.size()];
    return result.serial == ticket ? result.refused : std::nullopt;
  }
  // Whether the move of the ticket is over and the arm has stood still for `settle`.
  [[nodiscard]] bool has_arrived(Ticket ticket, hal::Duration settle) const {
    return is_handled(ticket) && !snapshot_->moving && snapshot_->settled >= settle;
  }
  // The joint that is furthest from where it is commanded to be.
  [[nodiscard]] std::size_t furthest_joint() const {
    std::size_t furthest = 0;
    double error = -1;
    for (std::size_t joint = 0; joint < snapshot_->positions.size(); ++joint) {
      const double off = std::abs(snapshot_->commanded[joint] - snapshot_->positions[joint]);
      if (off > error) furthest = joint;
      error = std::max(error, off);
    }
    return furthest;
  }

 private:
  Link& link_;
  const Snapshot* snapshot_ = &link_.snapshot.read();
  std::uint32_t serial_ = 0;
#ifndef ARMSIG_SMALL_IMAGE
  double pace_ = 1;
#endif
};

}  // namespace armsig::controller
