// SPDX-License-Identifier: MIT
// One cabinet as an edge node of Sparkplug B: when it may speak, in which order, and what it sends
// again until the host has it. A value of its own over a journal, a transport and the times that it
// is told; it takes two commands, rebirth and acknowledged row, and nothing else.
#pragma once

#include <string>

#include "firmware/fleet/journal/journal.hpp"
#include "firmware/fleet/node/transport.hpp"
#include "firmware/fleet/wire/items.hpp"
#include "firmware/fleet/wire/payload.hpp"

namespace armsig::fleet {

struct Now {
  std::uint64_t steady_ms = 0;
  std::uint64_t utc_ms = 0;  // of the computer's clock, which may be wrong and may jump
};

struct EdgeSettings {
  std::string group;
  std::string node;
  std::string host;
  unsigned rows_per_second = 50;           // sent at most
  unsigned unacknowledged = 500;           // rows on their way at most
  unsigned answer_timeout_ms = 5'000;      // then they are sent again, from the oldest;
  unsigned longest_timeout_ms = 300'000;   // each time in vain after twice as long, to this
  unsigned reconnect_ms = 1'000;           // after a lost connection; doubles likewise,
  unsigned longest_reconnect_ms = 60'000;  // each less a random part, to half
  unsigned connect_timeout_ms = 10'000;
};

class EdgeNode {
 public:
  enum class State : std::uint8_t {
    kApart,  // no connection, and waiting to try
    kConnecting,
    kWaiting,  // connected; the host is not there
    kBorn,
  };

  // Both outlive the node. `seed` is of the random part of waiting.
  EdgeNode(EdgeSettings settings, Journal& journal, Transport& transport, std::uint64_t seed);

  // Often: connects, sends rows, and sends them again.
  void tick(const Now& now);
  // Of the transport: the broker's answer to connect; the connection is gone; a message.
  void connected(const Now& now, bool accepted);
  void lost(const Now& now);
  void message(const Now& now, std::string_view topic, std::span<const std::byte> payload);

  // Keeps those of `readings` that differ from what was told before, in as many rows as they need.
  // Errors: those of the journal; what was not kept counts as not told.
  [[nodiscard]] Result<void> report(const Now& now, std::span<const Reading> readings);
  // Keeps all of `readings` in one row where any of them has changed: they hold together alone.
  // Errors: those of record().
  [[nodiscard]] Result<void> report_together(const Now& now, std::span<const Reading> readings);
  // Keeps all of `readings` in one row, changed or not: an event, as a check is. Errors:
  // kCapacityExceeded, those of the journal.
  [[nodiscard]] Result<void> record(const Now& now, std::span<const Reading> readings);

  // Ends the session in the intended way: NDEATH, then DISCONNECT; tick() begins anew.
  void leave(const Now& now);

  [[nodiscard]] State state() const { return state_; }

 private:
  void apart(const Now& now);
  void birth(const Now& now);
  void host_state(const Now& now, const HostState& state);
  void command(const Now& now, const Command& command);
  void send_from_acknowledged(const Now& now);
  void send_rows(const Now& now);
  [[nodiscard]] bool send(const Now& now, const Journal::Row& row);
  void remember(std::span<const Reading> readings);
  [[nodiscard]] const Value* told(Item item) const;
  [[nodiscard]] std::uint64_t less_a_random_part(std::uint64_t ms);

  EdgeSettings settings_;
  Journal& journal_;
  Transport& transport_;
  std::uint64_t random_;
  std::string birth_topic_;
  std::string data_topic_;
  std::string death_topic_;
  std::string command_topic_;
  std::string state_topic_;

  State state_ = State::kApart;
  Readings current_;
  std::uint8_t bd_seq_ = 255;       // of the session; the first is 0
  std::uint8_t seq_ = 0;            // of the next message
  std::uint64_t host_time_ms_ = 0;  // of the newest state of the host
  std::uint64_t due_ms_ = 0;        // kApart: to connect; kConnecting: to give up
  unsigned failures_ = 0;           // sessions in a row without a birth
  std::uint64_t cursor_ = 0;        // the row sent last
  std::uint64_t sent_ = 0;          // the highest ever sent by this process
  std::uint64_t before_birth_ = 0;  // rows up to here are history
  std::uint64_t live_time_ms_ = 0;  // of the last row that was sent as the present
  unsigned in_flight_ = 0;
  unsigned window_ = 0;    // rows on their way at most at present
  unsigned timeouts_ = 0;  // in a row
  std::uint64_t progress_ms_ = 0;
  std::uint64_t allowance_ms_ = 0;  // rows may be sent for the time since
};

}  // namespace armsig::fleet
