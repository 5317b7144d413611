// SPDX-License-Identifier: MIT
// The range sensor as a CANopen node: TPDO1 opens a reading (status u8, bit j: receiver j valid;
// sequence u8; air temperature i16 in 0.1 degrees C; CRC-32 u32), TPDO2 to TPDO4 bring the flight
// times in order (u32 in nanoseconds, one or two in each frame, as its length says).
//
// Frames get lost, and what is left of two readings must never pass for one. The CRC is of the four
// bytes before it and of the flight times as they are sent. A sensor may leave it out (TPDO1 of
// four bytes): then all frames of a reading must come within kReadingWindow, and the sensor must
// leave more than that between two readings.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/fixed_vector.hpp"
#include "hal/canopen/bus_load.hpp"
#include "hal/canopen/master.hpp"
#include "hal/canopen/protocol.hpp"
#include "hal/freshness.hpp"
#include "hal/range_sensor.hpp"

namespace armsig::canopen {

// Three PDOs of the predefined connection set with two flight times each.
inline constexpr std::size_t kMaxCanReceivers = 6;

inline constexpr hal::Duration kReadingWindow = std::chrono::milliseconds(5);

// The CRC of a reading's opening (without the CRC) with its flight times.
[[nodiscard]] std::uint32_t reading_crc(const hal::CanFrame& opening,
                                        std::span<const std::uint32_t> flights_ns);

struct RangeNodeConfiguration {
  NodeId node = 32;
  std::size_t receivers = 4;
  bool echo = false;  // flight times are there and back
  hal::FreshnessLimits freshness{};
};

// Errors: kNodeOutOfRange, kProfileInvalid (no receiver, or more than kMaxCanReceivers).
[[nodiscard]] Result<void> check(const RangeNodeConfiguration& configuration);

// What the sensor sends at one reading a `period`, for the bus load.
[[nodiscard]] FixedVector<PeriodicFrame, 4> traffic(const RangeNodeConfiguration& configuration,
                                                    hal::Duration period);

// Fed by the master that shares its bus (or by whoever reads the bus), polled by the controller. If
// readings come faster than polls, the newest counts.
class RangeSensor final : public hal::RangeSensor, public FrameSink {
 public:
  // Precondition: check(configuration).
  explicit RangeSensor(const RangeNodeConfiguration& configuration);

 private:
  void do_take(const hal::ReceivedCanFrame& received) override;
  Result<std::optional<hal::RangeReading>> do_poll(hal::Instant now) override;

  void open(const hal::ReceivedCanFrame& received);
  void append(const hal::ReceivedCanFrame& received, std::uint32_t pdo);
  void finish(hal::Instant last);
  void spoil();

  RangeNodeConfiguration configuration_;
  hal::Freshness freshness_;
  hal::RangeReading assembling_;
  hal::CanFrame opening_;
  FixedVector<std::uint32_t, kMaxCanReceivers> flights_ns_;
  std::uint32_t next_pdo_ = 0;  // number of the TPDO awaited, 0: none is, a TPDO1 must come first
  std::optional<hal::RangeReading> ready_;
  std::optional<Error> error_;
};

}  // namespace armsig::canopen
