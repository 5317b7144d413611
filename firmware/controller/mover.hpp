// SPDX-License-Identifier: MIT
// The background's hand on the tick: sends commands, and knows what became of them.
#pragma once

#include <optional>

#include "firmware/controller/link.hpp"

namespace armsig::controller {

class Mover {
 public:
  explicit Mover(Link& link) : link_(link) {}

  // To be called first in every step of the background.
  const Snapshot& refresh() {
    snapshot_ = &link_.snapshot.read();
    return *snapshot_;
  }
  [[nodiscard]] const Snapshot& now() const { return *snapshot_; }

  // False if the mailbox is full: the tick has stopped.
  bool send(Command command) {
    command.serial = serial_ + 1;
    if (!link_.commands.post(command)) return false;
    ++serial_;
    return true;
  }
  bool send(CommandKind kind) {
    Command command;
    command.kind = kind;
    return send(command);
  }
  // A function of its own: the command would stand on the stack below the planning of the move.
  [[gnu::noinline]] bool send(const Move& move) {
    Command command;
    command.kind = CommandKind::kMove;
    command.move = move;
    return send(command);
  }

  // Whether the tick has taken the last command; then its refusal, if there was one.
  [[nodiscard]] bool is_handled() const { return snapshot_->handled == serial_; }
  [[nodiscard]] std::optional<Error> refusal() const { return snapshot_->refused; }
  // Whether the last move is over and the arm has stood still for `settle`.
  [[nodiscard]] bool has_arrived(hal::Duration settle) const {
    return is_handled() && !snapshot_->moving && snapshot_->settled >= settle;
  }

 private:
  Link& link_;
  const Snapshot* snapshot_ = &link_.snapshot.read();
  std::uint32_t serial_ = 0;
};

}  // namespace armsig::controller
