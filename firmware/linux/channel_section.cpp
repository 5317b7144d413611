// SPDX-License-Identifier: MIT
// A sensor that publishes one number a channel: where each stands, and what it means.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "firmware/controller/plausibility.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/linux/sensor_parts.hpp"

namespace armsig::daemon {
namespace {

namespace plausible = controller::plausible;
using modbus::Format;
using tool::add_names;
using tool::Dimension;
using tool::problem_at;
using tool::Read;
using tool::YamlMap;
using tool::YamlNode;
using Names = std::vector<std::string>;
using Sensor = linux_hal::RtuRangeSensorConfiguration;

Names field_names() { return {"unit", "function", "register", "format", "words"}; }

// What is absent keeps the value that it has.
Read<void> read_field(const YamlMap& map, modbus::Field& field) {
  constexpr int kLargestUnit = 247;
  Settings settings(map);
  settings.integer("unit", 1, kLargestUnit, field.unit)
      .integer("function", 3, 4, field.function)
      .integer("register", 0, kLargestRegister, field.first);
  if (auto done = settings.done(); !done) return done;
  if (auto format = read_format(map, field.format); !format) return format;
  return read_word_order(map, field.high_word_first);
}

// The register has to be somewhere, and its number has to end with the registers.
Read<void> check_register(const YamlMap& map, bool given, const modbus::Field& field) {
  if (!given) {
    ARMSIG_TRY(node, map.require("register"));
    (void)node;
  }
  if (field.first + modbus::registers_in(field.format) <= 0x10000) return {};
  return problem_at(map.node(), fmt::format("{}: two registers from 65535 on", map.name()),
                    "a register below 65535");
}

Read<void> read_values(const YamlMap& map, modbus::Channel& channel) {
  if (const YamlNode* valid = map.find("valid")) {
    ARMSIG_TRY(bounds, tool::read_numbers(*valid, "valid", 2));
    if (!(bounds[0] < bounds[1])) {
      return problem_at(*valid, fmt::format("valid: {:g} to {:g}", bounds[0], bounds[1]),
                        "the lowest value first, then the highest, as they stand in the register");
    }
    channel.lowest = bounds[0];
    channel.highest = bounds[1];
  }
  if (const YamlNode* invalid = map.find("invalid")) {
    ARMSIG_TRY(list, tool::read_list(*invalid, "invalid", 1, modbus::Channel::kMaxInvalid));
    channel.invalid.clear();
    for (const YamlNode& item : *list) {
      ARMSIG_TRY(number, tool::read_number(item, "invalid"));
      channel.invalid.push_back(number);
    }
  }
  return {};
}

// What a channel may say of itself, and `modbus` of all of them.
Read<void> read_channel(const YamlMap& map, bool distance, modbus::Channel& channel) {
  if (auto field = read_field(map, channel.field); !field) return field;
  if (auto values = read_values(map, channel); !values) return values;
  const Dimension dimension = distance ? Dimension::kLength : Dimension::kTime;
  ARMSIG_TRY(other, map.find_quantity("offset", distance ? Dimension::kTime : Dimension::kLength));
  if (other) {
    return problem_at(
        *other->key,
        fmt::format("{} of {}", other->key->text, distance ? "distances" : "times of flight"),
        distance ? "offset_mm or offset_m" : "offset_ms or offset_s");
  }
  Settings settings(map);
  settings.quantity("offset", dimension, channel.offset, false)
      .bound("offset", dimension, channel.offset,
             distance ? plausible::kOffset : plausible::kOffsetTime);
  return settings.done();
}

// Metres or seconds a step, and by which speed of sound the metres came about.
Read<void> read_measure(const YamlMap& map, modbus::ChannelProfile& profile, double& step) {
  const YamlNode* metres = map.find("metres_a_step");
  const YamlNode* seconds = map.find("seconds_a_step");
  if ((metres == nullptr) == (seconds == nullptr)) {
    return problem_at(metres == nullptr ? map.node() : *metres,
                      metres == nullptr ? "nothing says what the channels measure"
                                        : "the channels measure distances and times",
                      "metres_a_step or seconds_a_step");
  }
  profile.distance = metres != nullptr;
  bool compensated = false;
  Settings settings(map);
  settings.share(profile.distance ? "metres_a_step" : "seconds_a_step", step)
      .flag("compensated", compensated)
      .quantity("speed_of_sound", Dimension::kSpeed, profile.sound_m_s)
      .bound("speed_of_sound", Dimension::kSpeed, profile.sound_m_s, plausible::kSpeedOfSound);
  if (auto done = settings.done(); !done) return done;
  const bool fixed = profile.sound_m_s > 0;
  if (!profile.distance && (compensated || fixed)) {
    return problem_at(*seconds, "a time of flight knows no speed of sound",
                      "neither compensated nor speed_of_sound beside seconds_a_step");
  }
  if (profile.distance && compensated == fixed) {
    return problem_at(*metres,
                      fixed ? "distances that are compensated have no fixed speed of sound"
                            : "nothing says how the sensor computes its distances",
                      "compensated: yes where the sensor corrects for the air by itself, or the "
                      "speed_of_sound_m_per_s that it always computes by");
  }
  return read_path(map, profile.echo);
}

// `air` or `counter` of `modbus`: on the first channel's unit, unless it says otherwise.
Read<modbus::Field> read_other(const YamlMap& map, const modbus::Field& first, Format format) {
  modbus::Field field{.unit = first.unit,
                      .function = first.function,
                      .format = format,
                      .high_word_first = first.high_word_first};
  if (auto read = read_field(map, field); !read) return std::unexpected(read.error());
  if (auto check = check_register(map, false, field); !check) return std::unexpected(check.error());
  return field;
}

Read<void> read_air(const YamlNode& node, const controller::Sensor& array,
                    modbus::ChannelProfile& profile) {
  Names known = field_names();
  known.insert(known.end(), {"celsius_a_step", "fixed_c"});
  ARMSIG_TRY(map, YamlMap::open(node, "air", known));
  if (const YamlNode* fixed = map.find("fixed_c")) {
    if (node.keys.size() > 1) {
      return problem_at(node, "the air is both fixed and measured", "fixed_c alone, or a register");
    }
    ARMSIG_TRY(celsius, tool::read_number(*fixed, "fixed_c"));
    if (!(celsius >= array.lowest_air_celsius && celsius <= array.highest_air_celsius)) {
      return problem_at(*fixed, fmt::format("fixed_c: {:g}", celsius),
                        fmt::format("from {:g} to {:g}: what air_c of the sensor says",
                                    array.lowest_air_celsius, array.highest_air_celsius));
    }
    profile.fixed_air_celsius = celsius;
    return {};
  }
  ARMSIG_TRY(field, read_other(map, profile.channels[0].field, Format::kI16));
  ARMSIG_TRY(step, map.number("celsius_a_step"));
  field.step = step;
  Settings settings(map);
  settings.share("celsius_a_step", field.step)
      .bound("celsius_a_step", std::nullopt, field.step, plausible::kCelsiusAStep);
  profile.air = field;
  return settings.done();
}

Read<void> read_counter(const YamlNode& node, modbus::ChannelProfile& profile) {
  ARMSIG_TRY(map, YamlMap::open(node, "counter", field_names()));
  ARMSIG_TRY(field, read_other(map, profile.channels[0].field, Format::kU16));
  if (field.format == Format::kF32) {
    return problem_at(*map.find("format"), "format: \"f32\" of a counter", "u16, i16, u32 or i32");
  }
  profile.counter = field;
  return {};
}

// How often there is a new reading: by a counter, or by time.
Read<void> read_times(const YamlMap& map, const controller::Sensor& array, Sensor& sensor) {
  modbus::ChannelProfile& profile = *sensor.channels;
  const auto period = map.find_quantity("update_period", Dimension::kTime);
  if (!period) return std::unexpected(period.error());
  if (period->has_value() == profile.counter.has_value()) {
    return problem_at(period->has_value() ? *(*period)->key : map.node(),
                      period->has_value() ? "the counter says when a reading is new"
                                          : "nothing says when a reading is new",
                      "update_period_ms, how often the sensor measures, or a counter");
  }
  if (auto counts = refuse_stale(map, profile.counter.has_value()); !counts) return counts;
  Settings settings(map);
  settings.time("update_period", profile.update_period);
  const char* const name = profile.counter ? "poll_period" : "update_period";
  const hal::Duration longest = std::max(sensor.poll_period, profile.update_period);
  settings.bound(name, Dimension::kTime, hal::seconds(longest),
                 {plausible::kPollPeriod.lowest,
                  std::min(plausible::kPollPeriod.highest, hal::seconds(array.reading_timeout) / 2),
                  "reading_timeout has to last for two readings"});
  read_freshness(settings, longest, profile.counter.has_value(), sensor.freshness);
  bound_period(settings, name, longest, sensor.freshness);
  return settings.done();
}

// Units that do not answer must not make the others seem silent.
Read<void> check_silence(const YamlMap& map, const YamlNode& list, const Sensor& sensor) {
  const modbus::ChannelProfile& profile = *sensor.channels;
  std::set<int> units;
  for (const modbus::Channel& channel : profile.channels) units.insert(channel.field.unit);
  if (profile.air) units.insert(profile.air->unit);
  if (profile.counter) units.insert(profile.counter->unit);
  const double round_s = hal::seconds(std::max(sensor.poll_period, profile.update_period)) +
                         static_cast<double>(units.size()) * hal::seconds(sensor.answer_timeout);
  const double silent_s = hal::seconds(sensor.freshness.silent_after);
  if (silent_s >= round_s) return {};
  const auto told = map.find_quantity("silent_after", Dimension::kTime);
  return problem_at(told && *told ? *(*told)->value : list,
                    fmt::format("silent_after: {:.6g} s", silent_s),
                    fmt::format("{:.6g} s at least: a round of {} units that all wait for "
                                "answer_timeout takes as long",
                                round_s, units.size()));
}

Read<void> check_overlap(const YamlNode& node, const std::string& name, const modbus::Field& field,
                         const modbus::ChannelProfile& profile, std::size_t before) {
  for (std::size_t i = 0; i < before; ++i) {
    if (!modbus::overlap(profile.channels[i].field, field)) continue;
    return problem_at(node,
                      fmt::format("{} and channel {} are one register: unit {}, function {}, {}",
                                  name, i + 1, field.unit, field.function, field.first),
                      "a unit or a register of its own");
  }
  return {};
}

Read<void> check_overlaps(const YamlMap& map, const modbus::ChannelProfile& profile) {
  const std::size_t count = profile.channels.size();
  for (const char* name : {"air", "counter"}) {
    const auto& field = std::string_view(name) == "air" ? profile.air : profile.counter;
    if (!field) continue;
    auto check = check_overlap(*map.find(name), name, *field, profile, count);
    if (!check) return check;
  }
  if (modbus::requests_of(profile)) return {};
  return problem_at(map.node(), std::string(describe(Error::kProfileInvalid)),
                    "air and counter in registers of their own");
}

Read<void> read_list_of(const YamlNode& list, const YamlMap& map, const modbus::Channel& all,
                        modbus::ChannelProfile& profile) {
  Names known = field_names();
  known.insert(known.end(), {"valid", "invalid"});
  add_names(known, "offset", profile.distance ? Dimension::kLength : Dimension::kTime);
  for (const YamlNode& item : list.items) {
    const std::string name = fmt::format("channel {}", profile.channels.size() + 1);
    ARMSIG_TRY(own, YamlMap::open(item, name, known));
    modbus::Channel channel = all;
    if (auto read = read_channel(own, profile.distance, channel); !read) return read;
    const bool given = map.find("register") != nullptr || own.find("register") != nullptr;
    if (auto check = check_register(own, given, channel.field); !check) return check;
    auto overlap = check_overlap(item, name, channel.field, profile, profile.channels.size());
    if (!overlap) return overlap;
    profile.channels.push_back(channel);
  }
  return {};
}

Read<void> check_step(const YamlMap& map, const modbus::ChannelProfile& profile) {
  const bool all_float = std::ranges::all_of(profile.channels, [](const modbus::Channel& channel) {
    return channel.field.format == Format::kF32;
  });
  const controller::Bounds& whole =
      profile.distance ? plausible::kMetresAStep : plausible::kSecondsAStep;
  Settings settings(map);
  settings.bound(profile.distance ? "metres_a_step" : "seconds_a_step", std::nullopt,
                 profile.channels[0].field.step, all_float ? plausible::kStepOfFloat : whole);
  return settings.done();
}

}  // namespace

Read<void> refuse_stale(const YamlMap& map, bool counts) {
  ARMSIG_TRY(stale, map.find_quantity("stale_after", Dimension::kTime));
  if (!stale || counts) return {};
  return problem_at(*stale->key, "no reading is stale where nothing counts them",
                    "no stale_after, or a counter");
}

Read<void> read_format(const YamlMap& map, Format& format) {
  const YamlNode* node = map.find("format");
  if (node == nullptr) return {};
  constexpr std::pair<std::string_view, Format> kFormats[] = {{"u16", Format::kU16},
                                                              {"i16", Format::kI16},
                                                              {"u32", Format::kU32},
                                                              {"i32", Format::kI32},
                                                              {"f32", Format::kF32}};
  for (const auto& [name, meant] : kFormats) {
    if (node->text != name) continue;
    format = meant;
    return {};
  }
  return problem_at(*node, "format: " + tool::in_quotes(node->text), "u16, i16, u32, i32 or f32");
}

Read<void> read_channels(const YamlMap& map, const controller::Sensor& array, Sensor& sensor) {
  modbus::ChannelProfile& profile = sensor.channels.emplace();
  modbus::Channel all;
  if (auto measure = read_measure(map, profile, all.field.step); !measure) return measure;
  if (auto read = read_channel(map, profile.distance, all); !read) return read;
  const YamlNode& list = *map.find("channels");
  const std::size_t receivers = array.receivers.p_S.size();
  if (list.kind != YamlNode::Kind::kSequence || list.items.size() != receivers) {
    return problem_at(
        list,
        list.kind == YamlNode::Kind::kSequence
            ? fmt::format("{} channels", list.items.size())
            : fmt::format("channels: {}", tool::word_of(list.kind)),
        fmt::format("a list of {}, one for each receiver, in their order", receivers));
  }
  if (auto read = read_list_of(list, map, all, profile); !read) return read;
  if (auto step = check_step(map, profile); !step) return step;
  ARMSIG_TRY(air, map.require("air"));
  if (auto read = read_air(*air, array, profile); !read) return read;
  if (const YamlNode* counter = map.find("counter")) {
    if (auto read = read_counter(*counter, profile); !read) return read;
  }
  Settings settings(map);
  settings.integer("largest_gap", 0, static_cast<int>(modbus::kMaxRegisters), profile.largest_gap);
  if (auto done = settings.done(); !done) return done;
  if (auto overlaps = check_overlaps(map, profile); !overlaps) return overlaps;
  if (auto times = read_times(map, array, sensor); !times) return times;
  return check_silence(map, list, sensor);
}

}  // namespace armsig::daemon
