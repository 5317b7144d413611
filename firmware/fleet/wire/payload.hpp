// SPDX-License-Identifier: MIT
// The messages between cabinet and host as bytes of Sparkplug B, and back.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "core/base/error.hpp"
#include "firmware/fleet/wire/items.hpp"

namespace armsig::fleet {

inline constexpr std::size_t kLongestPayload = 6144;
using Payload = FixedVector<std::byte, kLongestPayload>;

inline constexpr std::string_view kBdSeqName = "bdSeq";
inline constexpr std::string_view kRebirthName = "Node Control/Rebirth";
inline constexpr std::string_view kAcknowledgedJournalName = "Node Control/Acknowledged Journal";
inline constexpr std::string_view kAcknowledgedRowName = "Node Control/Acknowledged Row";

// One row of a journal on its way.
struct RowMessage {
  std::uint64_t journal = 0;
  std::uint64_t number = 0;
  std::uint64_t previous = 0;
  std::uint64_t dropped = 0;
  std::uint64_t time_ms = 0;
  bool historical = false;
  Readings readings;
};

// NBIRTH: every item there is, those without a value in `current` as null; seq is 0.
[[nodiscard]] Payload encode_birth(std::uint64_t now_ms, std::uint8_t bd_seq,
                                   const Readings& current);
// NDEATH: bdSeq alone, no seq.
[[nodiscard]] Payload encode_death(std::uint64_t now_ms, std::uint8_t bd_seq);
// NDATA, by aliases.
[[nodiscard]] Payload encode_row(std::uint64_t now_ms, std::uint8_t seq, const RowMessage& row);
// NCMD.
[[nodiscard]] Payload encode_rebirth(std::uint64_t now_ms);
[[nodiscard]] Payload encode_acknowledgement(std::uint64_t now_ms, std::uint64_t journal,
                                             std::uint64_t number);

// What an NCMD asks for; a command that is none of ours asks for nothing.
struct Command {
  bool rebirth = false;
  struct Acknowledged {
    std::uint64_t journal = 0;
    std::uint64_t number = 0;
  };
  std::optional<Acknowledged> acknowledged;
};
// Errors: kRecordCorrupt.
[[nodiscard]] Result<Command> decode_command(std::span<const std::byte> bytes);

// What a host reads of an NBIRTH, NDATA or NDEATH. Metrics of other names are passed over; a birth
// that gives one of our names another number or type is refused.
struct Report {
  std::optional<std::uint64_t> seq;
  std::optional<std::uint64_t> bd_seq;
  std::uint64_t time_ms = 0;  // of the first metric with one, or of the message
  bool historical = false;
  Readings readings;

  [[nodiscard]] const Value* find(Item item) const;
  [[nodiscard]] std::optional<std::uint64_t> integer(Item item) const;
};
// Errors: kRecordCorrupt.
[[nodiscard]] Result<Report> decode_report(std::span<const std::byte> bytes);

// The retained message of a host: {"online": true, "timestamp": 1668114759262}.
struct HostState {
  bool online = false;
  std::uint64_t timestamp_ms = 0;
};
// Errors: kRecordCorrupt.
[[nodiscard]] Result<HostState> decode_state(std::span<const std::byte> bytes);

}  // namespace armsig::fleet
