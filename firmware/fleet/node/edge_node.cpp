// SPDX-License-Identifier: MIT
#include "firmware/fleet/node/edge_node.hpp"

#include <algorithm>
#include <utility>

#include "firmware/fleet/wire/row_codec.hpp"

namespace armsig::fleet {
namespace {

static_assert(kLongestRowBytes <= Journal::kLongestRow);

constexpr std::uint64_t kLongestBurst_ms = 1'000;
// Of a thousand cabinets that come back at once each has to send less than it could.
constexpr unsigned kLeastWindow = 10;

std::uint64_t doubled(std::uint64_t ms, unsigned times, std::uint64_t longest) {
  return std::min(longest, ms << std::min(times, 20U));
}

}  // namespace

EdgeNode::EdgeNode(EdgeSettings settings, Journal& journal, Transport& transport,
                   std::uint64_t seed)
    : settings_(std::move(settings)),
      journal_(journal),
      transport_(transport),
      random_(seed | 1U),
      window_(settings_.unacknowledged) {
  const auto topic = [&](const char* verb) {
    return "spBv1.0/" + settings_.group + "/" + verb + "/" + settings_.node;
  };
  birth_topic_ = topic("NBIRTH");
  data_topic_ = topic("NDATA");
  death_topic_ = topic("NDEATH");
  command_topic_ = topic("NCMD");
  state_topic_ = "spBv1.0/STATE/" + settings_.host;
}

void EdgeNode::tick(const Now& now) {
  if (state_ == State::kApart && now.steady_ms >= due_ms_) {
    state_ = State::kConnecting;
    due_ms_ = now.steady_ms + settings_.connect_timeout_ms;
    ++bd_seq_;
    const Payload death = encode_death(now.utc_ms, bd_seq_);
    transport_.connect({death_topic_, {death.data(), death.size()}});
  } else if (state_ == State::kConnecting && now.steady_ms >= due_ms_) {
    transport_.disconnect();
    apart(now);
  } else if (state_ == State::kBorn) {
    send_rows(now);
  }
}

void EdgeNode::connected(const Now& now, bool accepted) {
  if (state_ != State::kConnecting) return;
  if (!accepted) {
    transport_.disconnect();
    apart(now);
    return;
  }
  state_ = State::kWaiting;
  // The host's state is retained and comes by its subscription: the commands are heard before.
  transport_.subscribe(command_topic_, 1);
  transport_.subscribe(state_topic_, 1);
}

void EdgeNode::lost(const Now& now) {
  if (state_ != State::kApart) apart(now);
}

// Jitter: a thousand cabinets that lost one broker must not come back in one moment.
void EdgeNode::apart(const Now& now) {
  state_ = State::kApart;
  due_ms_ = now.steady_ms + less_a_random_part(doubled(settings_.reconnect_ms, failures_,
                                                       settings_.longest_reconnect_ms));
  ++failures_;
}

void EdgeNode::leave(const Now& now) {
  if (state_ == State::kApart) return;
  if (state_ == State::kBorn) {
    const Payload death = encode_death(now.utc_ms, bd_seq_);
    (void)transport_.publish(death_topic_, {death.data(), death.size()}, 1);
  }
  transport_.disconnect();
  apart(now);
}

void EdgeNode::message(const Now& now, std::string_view topic, std::span<const std::byte> payload) {
  if (state_ != State::kWaiting && state_ != State::kBorn) return;
  if (topic == state_topic_) {
    if (const auto state = decode_state(payload)) host_state(now, *state);
  } else if (topic == command_topic_ && state_ == State::kBorn) {
    if (const auto asked = decode_command(payload)) command(now, *asked);
  }
}

void EdgeNode::host_state(const Now& now, const HostState& state) {
  if (state.timestamp_ms < host_time_ms_) return;
  host_time_ms_ = state.timestamp_ms;
  if (state.online && state_ == State::kWaiting) {
    birth(now);
  } else if (!state.online && state_ == State::kBorn) {
    leave(now);
  }
}

void EdgeNode::birth(const Now& now) {
  const Payload payload = encode_birth(now.utc_ms, bd_seq_, current_);
  if (!transport_.publish(birth_topic_, {payload.data(), payload.size()}, 0)) {
    transport_.disconnect();
    apart(now);
    return;
  }
  state_ = State::kBorn;
  failures_ = 0;
  seq_ = 1;
  before_birth_ = journal_.last();
  live_time_ms_ = now.utc_ms;
  allowance_ms_ = now.steady_ms;
  send_from_acknowledged(now);
}

void EdgeNode::command(const Now& now, const Command& command) {
  if (command.rebirth) {
    birth(now);
    return;
  }
  if (!command.acknowledged || command.acknowledged->journal != journal_.name()) return;
  const std::uint64_t number = command.acknowledged->number;
  const std::uint64_t before = journal_.acknowledged();
  if (number > journal_.last() || number == before) return;
  // Where it can't be written down, rows are sent once more after a restart, no worse.
  (void)journal_.acknowledge(number);
  timeouts_ = 0;
  if (number < before) {  // the host has gone back to an earlier state
    send_from_acknowledged(now);
    return;
  }
  progress_ms_ = now.steady_ms;
  cursor_ = std::max(cursor_, number);
  const unsigned on_their_way = in_flight_;
  in_flight_ = static_cast<unsigned>(std::min<std::uint64_t>(in_flight_, cursor_ - number));
  // As many more as have arrived: twice as many each time that all of them do.
  window_ = std::min(settings_.unacknowledged, window_ + (on_their_way - in_flight_));
}

void EdgeNode::send_from_acknowledged(const Now& now) {
  cursor_ = journal_.acknowledged();
  in_flight_ = 0;
  progress_ms_ = now.steady_ms;
}

void EdgeNode::send_rows(const Now& now) {
  const std::uint64_t patience =
      doubled(settings_.answer_timeout_ms, timeouts_, settings_.longest_timeout_ms);
  if (in_flight_ == 0) {
    progress_ms_ = now.steady_ms;
  } else if (now.steady_ms - progress_ms_ >= patience) {
    ++timeouts_;
    window_ = std::max(kLeastWindow, window_ / 4);
    send_from_acknowledged(now);
  }
  const std::uint64_t waited = std::min(now.steady_ms - allowance_ms_, kLongestBurst_ms);
  std::uint64_t allowed = waited * settings_.rows_per_second / 1'000;
  if (allowed == 0) return;
  allowance_ms_ = now.steady_ms;
  for (; allowed > 0 && in_flight_ < window_; --allowed) {
    const auto row = journal_.after(cursor_);
    if (!row || !*row || !send(now, **row)) return;
  }
}

// A row is the present where it is sent for the first time, was written in this session, and is not
// older than the one before: everything else is history, whatever the clock did.
bool EdgeNode::send(const Now& now, const Journal::Row& row) {
  RowMessage message{.journal = journal_.name(),
                     .number = row.number,
                     .previous = row.previous,
                     .dropped = journal_.dropped(),
                     .time_ms = row.time_ms,
                     .historical = row.number <= before_birth_ || row.number <= sent_ ||
                                   row.time_ms < live_time_ms_,
                     .readings = {}};
  // A row that nobody can read any more is passed on as an empty one: its number is used.
  if (const auto readings = readings_of({row.bytes.data(), row.bytes.size()})) {
    message.readings = *readings;
  }
  const Payload payload = encode_row(now.utc_ms, seq_, message);
  if (!transport_.publish(data_topic_, {payload.data(), payload.size()}, 0)) return false;
  ++seq_;
  ++in_flight_;
  cursor_ = row.number;
  sent_ = std::max(sent_, row.number);
  if (!message.historical) live_time_ms_ = row.time_ms;
  return true;
}

const Value* EdgeNode::told(Item item) const {
  for (const Reading& reading : current_) {
    if (reading.item == item) return &reading.value;
  }
  return nullptr;
}

void EdgeNode::remember(std::span<const Reading> readings) {
  for (const Reading& reading : readings) {
    Reading* known =
        std::ranges::find(current_.begin(), current_.end(), reading.item, &Reading::item);
    if (known != current_.end()) {
      known->value = reading.value;
    } else {
      current_.push_back(reading);
    }
  }
}

Result<void> EdgeNode::report(const Now& now, std::span<const Reading> readings) {
  Readings changed;
  for (const Reading& reading : readings) {
    const Value* before = told(reading.item);
    if (before == nullptr || *before != reading.value) changed.push_back(reading);
  }
  std::span<const Reading> left(changed.data(), changed.size());
  while (!left.empty()) {
    RowBytes row;
    std::size_t taken = 0;
    while (taken < left.size() && add_reading(row, left[taken])) ++taken;
    if (taken == 0) return std::unexpected(Error::kCapacityExceeded);
    const auto kept = journal_.append(now.utc_ms, {row.data(), row.size()});
    if (!kept) return std::unexpected(kept.error());
    remember(left.first(taken));
    left = left.subspan(taken);
  }
  return {};
}

Result<void> EdgeNode::report_together(const Now& now, std::span<const Reading> readings) {
  const bool changed = std::ranges::any_of(readings, [&](const Reading& reading) {
    const Value* before = told(reading.item);
    return before == nullptr || *before != reading.value;
  });
  return changed ? record(now, readings) : Result<void>();
}

Result<void> EdgeNode::record(const Now& now, std::span<const Reading> readings) {
  RowBytes row;
  for (const Reading& reading : readings) {
    if (!add_reading(row, reading)) return std::unexpected(Error::kCapacityExceeded);
  }
  const auto kept = journal_.append(now.utc_ms, {row.data(), row.size()});
  if (!kept) return std::unexpected(kept.error());
  remember(readings);
  return {};
}

std::uint64_t EdgeNode::less_a_random_part(std::uint64_t ms) {
  random_ ^= random_ << 13U;  // xorshift64 (Marsaglia 2003)
  random_ ^= random_ >> 7U;
  random_ ^= random_ << 17U;
  return ms - random_ % (ms / 2 + 1);
}

}  // namespace armsig::fleet
