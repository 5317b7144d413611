// SPDX-License-Identifier: MIT
#include "firmware/fleet/wire/payload.hpp"

#include <pb_decode.h>
#include <pb_encode.h>

#include <algorithm>
#include <charconv>
#include <cstring>

#include "core/base/check.hpp"
#include "sparkplug.pb.h"

namespace armsig::fleet {
namespace {

using Message = armsig_sparkplug_Payload;
using Metric = armsig_sparkplug_Metric;

// One at a time: the messages are of one thread, and too large for its stack on small machines.
Message& blank() {
  static Message message;
  message = Message{};
  return message;
}

void set_time(Message& message, std::uint64_t now_ms) {
  message.has_timestamp = true;
  message.timestamp = now_ms;
}

Metric& add(Message& message, std::uint64_t time_ms, Datatype type) {
  ARMSIG_CHECK(message.metrics_count < std::size(message.metrics));
  Metric& metric = message.metrics[message.metrics_count++];
  metric.has_timestamp = true;
  metric.timestamp = time_ms;
  metric.has_datatype = true;
  metric.datatype = static_cast<std::uint32_t>(type);
  return metric;
}

void set_name(Metric& metric, std::string_view name) {
  ARMSIG_CHECK(name.size() < sizeof metric.name);
  metric.has_name = true;
  name.copy(metric.name, name.size());
}

void set_alias(Metric& metric, Item item) {
  metric.has_alias = true;
  metric.alias = static_cast<std::uint64_t>(item);
}

void set_long(Metric& metric, std::uint64_t value) {
  metric.which_value = armsig_sparkplug_Metric_long_value_tag;
  metric.value.long_value = value;
}

void set_value(Metric& metric, Datatype type, const Value& value) {
  if (std::holds_alternative<std::monostate>(value)) {
    metric.has_is_null = true;
    metric.is_null = true;
  } else if (const auto* integer = std::get_if<std::uint64_t>(&value)) {
    if (type == Datatype::kUInt32) {
      metric.which_value = armsig_sparkplug_Metric_int_value_tag;
      metric.value.int_value = static_cast<std::uint32_t>(*integer);
    } else {
      set_long(metric, *integer);
    }
  } else if (const auto* real = std::get_if<double>(&value)) {
    metric.which_value = armsig_sparkplug_Metric_double_value_tag;
    metric.value.double_value = *real;
  } else if (const auto* flag = std::get_if<bool>(&value)) {
    metric.which_value = armsig_sparkplug_Metric_boolean_value_tag;
    metric.value.boolean_value = *flag;
  } else if (const auto* text = std::get_if<Text>(&value)) {
    metric.which_value = armsig_sparkplug_Metric_string_value_tag;
    text->view().copy(metric.value.string_value, text->view().size());
    metric.value.string_value[text->view().size()] = '\0';
  }
}

Payload bytes_of(const Message& message) {
  Payload payload;
  payload.resize(Payload::capacity());
  pb_ostream_t stream =
      pb_ostream_from_buffer(reinterpret_cast<pb_byte_t*>(payload.data()), Payload::capacity());
  ARMSIG_CHECK(pb_encode(&stream, armsig_sparkplug_Payload_fields, &message));
  payload.resize(stream.bytes_written);
  return payload;
}

// Null where the bytes are no message, or one with more than there is room for.
const Message* decoded(std::span<const std::byte> bytes) {
  Message& message = blank();
  pb_istream_t stream =
      pb_istream_from_buffer(reinterpret_cast<const pb_byte_t*>(bytes.data()), bytes.size());
  return pb_decode(&stream, armsig_sparkplug_Payload_fields, &message) ? &message : nullptr;
}

Value value_of(const Metric& metric) {
  if (metric.has_is_null && metric.is_null) return {};
  switch (metric.which_value) {
    case armsig_sparkplug_Metric_int_value_tag:
      return std::uint64_t{metric.value.int_value};
    case armsig_sparkplug_Metric_long_value_tag:
      return std::uint64_t{metric.value.long_value};
    case armsig_sparkplug_Metric_double_value_tag:
      return metric.value.double_value;
    case armsig_sparkplug_Metric_boolean_value_tag:
      return metric.value.boolean_value;
    case armsig_sparkplug_Metric_string_value_tag:
      return Text(metric.value.string_value);
    default:
      return {};
  }
}

std::optional<std::uint64_t> long_of(const Metric& metric) {
  const Value value = value_of(metric);
  const auto* integer = std::get_if<std::uint64_t>(&value);
  return integer != nullptr ? std::optional(*integer) : std::nullopt;
}

bool is_named(const Metric& metric, std::string_view name) {
  return metric.has_name && name == metric.name;
}

// Takes one metric of an item of ours; false where it contradicts our table.
bool take(const Metric& metric, Report& report) {
  std::optional<Item> item;
  if (metric.has_name) {
    item = item_of(std::string_view(metric.name));
    if (!item) return true;
    if (metric.has_alias && metric.alias != static_cast<std::uint64_t>(*item)) return false;
  } else if (metric.has_alias) {
    item = item_of(metric.alias);
  }
  if (!item) return true;
  const Value value = value_of(metric);
  if (!suits(*item, value) || report.find(*item) != nullptr || report.readings.full()) {
    return false;
  }
  if (report.readings.empty() && metric.has_timestamp) report.time_ms = metric.timestamp;
  report.historical = report.historical || (metric.has_is_historical && metric.is_historical);
  report.readings.push_back({*item, value});
  return true;
}

}  // namespace

Payload encode_birth(std::uint64_t now_ms, std::uint8_t bd_seq, const Readings& current) {
  Message& message = blank();
  set_time(message, now_ms);
  message.has_seq = true;
  Metric& session = add(message, now_ms, Datatype::kInt64);
  set_name(session, kBdSeqName);
  set_long(session, bd_seq);
  Metric& rebirth = add(message, now_ms, Datatype::kBoolean);
  set_name(rebirth, kRebirthName);
  set_value(rebirth, Datatype::kBoolean, false);
  for (const ItemInfo& known : kItems) {
    Metric& metric = add(message, now_ms, known.type);
    set_name(metric, known.name);
    set_alias(metric, known.item);
    Value value;
    for (const Reading& reading : current) {
      if (reading.item == known.item) value = reading.value;
    }
    set_value(metric, known.type, value);
  }
  return bytes_of(message);
}

Payload encode_death(std::uint64_t now_ms, std::uint8_t bd_seq) {
  Message& message = blank();
  set_time(message, now_ms);
  Metric& session = add(message, now_ms, Datatype::kInt64);
  set_name(session, kBdSeqName);
  set_long(session, bd_seq);
  return bytes_of(message);
}

Payload encode_row(std::uint64_t now_ms, std::uint8_t seq, const RowMessage& row) {
  Message& message = blank();
  set_time(message, now_ms);
  message.has_seq = true;
  message.seq = seq;
  const auto add_item = [&](Item item, const Value& value) {
    Metric& metric = add(message, row.time_ms, info(item).type);
    set_alias(metric, item);
    if (row.historical) {
      metric.has_is_historical = true;
      metric.is_historical = true;
    }
    set_value(metric, info(item).type, value);
  };
  add_item(Item::kJournal, row.journal);
  add_item(Item::kNumber, row.number);
  add_item(Item::kPrevious, row.previous);
  add_item(Item::kDropped, row.dropped);
  for (const Reading& reading : row.readings) {
    if (reading.item > Item::kDropped) add_item(reading.item, reading.value);
  }
  return bytes_of(message);
}

Payload encode_rebirth(std::uint64_t now_ms) {
  Message& message = blank();
  set_time(message, now_ms);
  Metric& rebirth = add(message, now_ms, Datatype::kBoolean);
  set_name(rebirth, kRebirthName);
  set_value(rebirth, Datatype::kBoolean, true);
  return bytes_of(message);
}

Payload encode_acknowledgement(std::uint64_t now_ms, std::uint64_t journal, std::uint64_t number) {
  Message& message = blank();
  set_time(message, now_ms);
  Metric& name = add(message, now_ms, Datatype::kUInt64);
  set_name(name, kAcknowledgedJournalName);
  set_long(name, journal);
  Metric& row = add(message, now_ms, Datatype::kUInt64);
  set_name(row, kAcknowledgedRowName);
  set_long(row, number);
  return bytes_of(message);
}

Result<Command> decode_command(std::span<const std::byte> bytes) {
  const Message* message = decoded(bytes);
  if (message == nullptr) return std::unexpected(Error::kRecordCorrupt);
  Command command;
  std::optional<std::uint64_t> journal;
  std::optional<std::uint64_t> number;
  for (const Metric& metric : std::span(message->metrics, message->metrics_count)) {
    if (is_named(metric, kRebirthName)) command.rebirth = value_of(metric) == Value(true);
    if (is_named(metric, kAcknowledgedJournalName)) journal = long_of(metric);
    if (is_named(metric, kAcknowledgedRowName)) number = long_of(metric);
  }
  if (journal && number) command.acknowledged = {*journal, *number};
  return command;
}

const Value* Report::find(Item item) const {
  for (const Reading& reading : readings) {
    if (reading.item == item) return &reading.value;
  }
  return nullptr;
}

std::optional<std::uint64_t> Report::integer(Item item) const {
  const Value* value = find(item);
  const auto* integer = value != nullptr ? std::get_if<std::uint64_t>(value) : nullptr;
  return integer != nullptr ? std::optional(*integer) : std::nullopt;
}

Result<Report> decode_report(std::span<const std::byte> bytes) {
  const Message* message = decoded(bytes);
  if (message == nullptr) return std::unexpected(Error::kRecordCorrupt);
  Report report;
  report.time_ms = message->timestamp;
  if (message->has_seq) report.seq = message->seq;
  for (const Metric& metric : std::span(message->metrics, message->metrics_count)) {
    if (is_named(metric, kBdSeqName)) {
      report.bd_seq = long_of(metric);
    } else if (!take(metric, report)) {
      return std::unexpected(Error::kRecordCorrupt);
    }
  }
  return report;
}

// Only what the specification writes: an object of these two keys.
Result<HostState> decode_state(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  constexpr std::size_t kLongest = 256;
  if (text.size() > kLongest) return std::unexpected(Error::kRecordCorrupt);
  const auto after = [&](std::string_view key) -> std::string_view {
    const std::size_t at = text.find(key);
    if (at == std::string_view::npos) return {};
    const std::size_t begin = text.find_first_not_of(" \t\r\n:", at + key.size());
    return begin == std::string_view::npos ? std::string_view{} : text.substr(begin);
  };
  HostState state;
  const std::string_view online = after("\"online\"");
  state.online = online.starts_with("true");
  const std::string_view time = after("\"timestamp\"");
  const auto [end, error] =
      std::from_chars(time.data(), time.data() + time.size(), state.timestamp_ms);
  if ((!state.online && !online.starts_with("false")) || time.empty() || error != std::errc{}) {
    return std::unexpected(Error::kRecordCorrupt);
  }
  return state;
}

}  // namespace armsig::fleet
