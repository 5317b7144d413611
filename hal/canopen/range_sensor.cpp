// SPDX-License-Identifier: MIT
#include "hal/canopen/range_sensor.hpp"

#include <utility>

#include "core/base/check.hpp"
#include "core/base/crc32.hpp"

namespace armsig::canopen {
namespace {

constexpr std::uint8_t kOpeningBytes = 4;
constexpr std::uint8_t kCrcBytes = 4;
constexpr std::uint8_t kFlightBytes = 4;
constexpr std::uint32_t kPdoStep = 0x100;  // from one TPDO's identifier to the next one's

}  // namespace

Result<void> check(const RangeNodeConfiguration& configuration) {
  if (configuration.node == 0 || configuration.node > kLargestNode) {
    return std::unexpected(Error::kNodeOutOfRange);
  }
  if (configuration.receivers == 0 || configuration.receivers > kMaxCanReceivers) {
    return std::unexpected(Error::kProfileInvalid);
  }
  return {};
}

std::uint32_t reading_crc(const hal::CanFrame& opening, std::span<const std::uint32_t> flights_ns) {
  std::uint32_t crc = crc32(std::as_bytes(std::span(opening.data).first(kOpeningBytes)));
  for (const std::uint32_t flight_ns : flights_ns) {
    hal::CanFrame bytes;
    store(bytes, 0, flight_ns);
    crc = crc32(std::as_bytes(std::span(bytes.data).first(kFlightBytes)), crc);
  }
  return crc;
}

FixedVector<PeriodicFrame, 4> traffic(const RangeNodeConfiguration& configuration,
                                      hal::Duration period) {
  FixedVector<PeriodicFrame, 4> frames{{kOpeningBytes + kCrcBytes, period}};
  for (std::size_t first = 0; first < configuration.receivers; first += 2) {
    const bool pair = first + 1 < configuration.receivers;
    frames.push_back({static_cast<std::uint8_t>(kFlightBytes * (pair ? 2 : 1)), period});
  }
  return frames;
}

RangeSensor::RangeSensor(const RangeNodeConfiguration& configuration)
    : configuration_(configuration), freshness_(configuration.freshness) {
  ARMSIG_CHECK(check(configuration));
}

void RangeSensor::do_take(const hal::ReceivedCanFrame& received) {
  const hal::CanFrame& frame = received.frame;
  if (frame.extended || frame.remote || (frame.id & kNodeMask) != configuration_.node) return;
  const std::uint32_t function = frame.id & kFunctionMask;
  if (function == kTransmitPdo1Id) {
    open(received);
  } else if (function == kTransmitPdo2Id || function == kTransmitPdo3Id ||
             function == kTransmitPdo4Id) {
    append(received, (function - kTransmitPdo1Id) / kPdoStep + 1);
  }
}

void RangeSensor::spoil() {
  error_ = Error::kSensorMalformed;
  next_pdo_ = 0;
}

void RangeSensor::open(const hal::ReceivedCanFrame& received) {
  const hal::CanFrame& frame = received.frame;
  if (next_pdo_ != 0) error_ = Error::kSensorMalformed;  // the reading before never ended
  if (frame.length != kOpeningBytes && frame.length != kOpeningBytes + kCrcBytes) {
    spoil();
    return;
  }
  opening_ = frame;
  flights_ns_.clear();
  assembling_ = {};
  assembling_.sequence = frame.data[1];
  assembling_.air_celsius = 0.1 * static_cast<std::int16_t>(load<std::uint16_t>(frame, 2));
  assembling_.at = received.at;
  next_pdo_ = 2;
}

void RangeSensor::append(const hal::ReceivedCanFrame& received, std::uint32_t pdo) {
  const hal::CanFrame& frame = received.frame;
  const std::size_t count = frame.length / kFlightBytes;
  if (pdo != next_pdo_ || frame.length % kFlightBytes != 0 || count == 0 ||
      flights_ns_.size() + count > configuration_.receivers) {
    spoil();
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    flights_ns_.push_back(load<std::uint32_t>(frame, kFlightBytes * i));
  }
  ++next_pdo_;
  if (flights_ns_.size() == configuration_.receivers) finish(received.at);
}

void RangeSensor::finish(hal::Instant last) {
  next_pdo_ = 0;
  const bool whole = opening_.length == kOpeningBytes
                         ? last - assembling_.at <= kReadingWindow
                         : load<std::uint32_t>(opening_, kOpeningBytes) ==
                               reading_crc(opening_, {flights_ns_.data(), flights_ns_.size()});
  if (!whole) {
    spoil();
    return;
  }
  for (std::size_t j = 0; j < flights_ns_.size(); ++j) {
    assembling_.receivers.push_back({(opening_.data[0] >> j & 1U) != 0,
                                     flights_ns_[j] * 1e-9 * (configuration_.echo ? 0.5 : 1.0)});
  }
  if (freshness_.take(assembling_.sequence, assembling_.at)) ready_ = assembling_;
}

Result<std::optional<hal::RangeReading>> RangeSensor::do_poll(hal::Instant now) {
  if (error_) return std::unexpected(*std::exchange(error_, std::nullopt));
  if (ready_) return std::exchange(ready_, std::nullopt);
  if (const auto overdue = freshness_.overdue(now)) return std::unexpected(*overdue);
  return std::nullopt;
}

}  // namespace armsig::canopen
