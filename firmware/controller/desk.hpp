// SPDX-License-Identifier: MIT
// The operators' desk: takes one request after the other from the consoles, and answers each of
// them, some at once and some when what was asked for is done.
#pragma once

#include <optional>

#include "firmware/controller/announcer.hpp"
#include "firmware/controller/verbs.hpp"

namespace armsig::controller {

class Desk {
 public:
  // Both must outlive it.
  Desk(const Announcer& announcer, const Controls& controls);

  // A few samples of a line, and at most one request. While an answer waits for the tick no further
  // request is taken.
  void step();
  // The change of the store that an operator asked for is over.
  void stored(const Result<void>& result);
  [[nodiscard]] bool is_computing() const {
    return controls_.planning.has_value() || controls_.looking.has_value();
  }
  // Something that was asked for is under way.
  [[nodiscard]] bool is_busy() const { return waiting_ || controls_.are_busy(); }

 private:
  struct Client {
    std::size_t console = 0;
    hal::ConsoleClient id = 0;
  };
  struct Waiting {
    Client client;
    Ticket ticket = 0;
    std::optional<double> missed_rad = {};  // orientation, by the line that was sent
  };

  void step_planning();
  template <typename Planning>
  void step(std::optional<Planning>& planning);
  void take_request();
  [[nodiscard]] Result<Answer> serve(const hal::ConsoleLine& line, Line& out);
  void settle(const Client& client, const Result<Answer>& answer, const Line& out);
  void reply(const Client& client, const Result<void>& verdict, const Line& out) const;

  const Announcer& announcer_;
  Controls controls_;
  std::size_t turn_ = 0;            // the console to be read first
  std::optional<Waiting> waiting_;  // for the tick
  Client planning_for_;
  std::optional<Client> storing_for_;
  Line out_;
};

}  // namespace armsig::controller
