// SPDX-License-Identifier: MIT
#include "hal/modbus/channels.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/check.hpp"
#include "core/base/dry_air.hpp"

namespace armsig::modbus {
namespace {

using Fields = FixedVector<Field, kMaxFields>;

bool is_sane(const Field& field) {
  return field.unit >= 1 && field.unit <= kLargestUnit &&
         (field.function == 3 || field.function == 4) && end_of(field) <= kRegisters &&
         field.step > 0 && std::isfinite(field.step);
}

bool is_sane(const Channel& channel) {
  return is_sane(channel.field) && std::isfinite(channel.offset) &&
         channel.lowest <= channel.highest;
}

bool is_sane(const ChannelProfile& profile) {
  return !profile.channels.empty() &&
         std::ranges::all_of(profile.channels, [](const Channel& c) { return is_sane(c); }) &&
         (!profile.air || is_sane(*profile.air)) && std::isfinite(profile.fixed_air_celsius) &&
         (!profile.counter ||
          (is_sane(*profile.counter) && profile.counter->format != Format::kF32)) &&
         profile.sound_m_s >= 0 && std::isfinite(profile.sound_m_s) &&
         profile.update_period >= hal::Duration{};
}

bool stands_before(const Field& a, const Field& b) {
  if (a.unit != b.unit) return a.unit < b.unit;
  if (a.function != b.function) return a.function < b.function;
  return a.first < b.first;
}

Fields sorted_fields(const ChannelProfile& profile) {
  Fields fields;
  for (const Channel& channel : profile.channels) fields.push_back(channel.field);
  if (profile.air) fields.push_back(*profile.air);
  if (profile.counter) fields.push_back(*profile.counter);
  std::sort(fields.begin(), fields.end(), stands_before);
  return fields;
}

bool joins(const ReadRequest& request, const Field& field, std::size_t largest_gap) {
  const std::size_t end = std::size_t{request.registers.first} + request.registers.count;
  return request.unit == field.unit && request.function == field.function &&
         field.first <= end + largest_gap &&
         end_of(field) - request.registers.first <= kMaxRegisters;
}

}  // namespace

Result<Requests> requests_of(const ChannelProfile& profile) {
  if (!is_sane(profile)) return std::unexpected(Error::kProfileInvalid);
  const Fields fields = sorted_fields(profile);
  Requests requests;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const Field& field = fields[i];
    if (i > 0 && overlap(fields[i - 1], field)) return std::unexpected(Error::kProfileInvalid);
    if (!requests.empty() && joins(requests.back(), field, profile.largest_gap)) {
      RegisterRange& range = requests.back().registers;
      range.count = static_cast<std::uint16_t>(end_of(field) - range.first);
      continue;
    }
    requests.push_back({field.unit, field.function, {field.first, registers_in(field.format)}});
  }
  return requests;
}

bool overlap(const Field& a, const Field& b) {
  return a.unit == b.unit && a.function == b.function && a.first < end_of(b) && b.first < end_of(a);
}

bool covers(const ReadRequest& request, const Field& field) {
  return request.unit == field.unit && request.function == field.function &&
         field.first >= request.registers.first &&
         end_of(field) <= std::size_t{request.registers.first} + request.registers.count;
}

double number_in(const Field& field, const ReadRequest& request,
                 std::span<const std::uint16_t> registers) {
  ARMSIG_CHECK(covers(request, field));
  ARMSIG_CHECK(registers.size() == request.registers.count);
  const std::size_t at = std::size_t{field.first} - request.registers.first;
  if (field.format == Format::kU16) return registers[at];
  if (field.format == Format::kI16) return static_cast<std::int16_t>(registers[at]);
  const std::uint32_t high = registers[at + (field.high_word_first ? 0 : 1)];
  const std::uint32_t low = registers[at + (field.high_word_first ? 1 : 0)];
  const std::uint32_t both = (high << 16U) | low;
  if (field.format == Format::kU32) return both;
  if (field.format == Format::kI32) return static_cast<std::int32_t>(both);
  return static_cast<double>(std::bit_cast<float>(both));
}

double speed_of(const ChannelProfile& profile, double air_celsius) {
  return profile.sound_m_s > 0 ? profile.sound_m_s : speed_in_dry_air(air_celsius);
}

hal::ReceiverReading reading_of(const ChannelProfile& profile, const Channel& channel,
                                double number, double speed_m_s) {
  const bool heard = std::isfinite(number) && number >= channel.lowest &&
                     number <= channel.highest &&
                     std::ranges::none_of(channel.invalid, [&](double no) { return no == number; });
  if (!heard) return {};
  const double way = number * channel.field.step * (profile.echo ? 0.5 : 1.0) + channel.offset;
  const double flight_s = profile.distance ? way / speed_m_s : way;
  if (!(flight_s > 0 && std::isfinite(flight_s))) return {};
  return {.valid = true, .flight_s = flight_s};
}

}  // namespace armsig::modbus
