// SPDX-License-Identifier: MIT
// An instrument that publishes points or lengths in the registers of a Modbus TCP server.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/fixed_vector.hpp"
#include "hal/freshness.hpp"
#include "hal/length_instrument.hpp"
#include "hal/linux/back_off.hpp"
#include "hal/linux/file_descriptor.hpp"
#include "hal/modbus/number_registers.hpp"
#include "hal/modbus/tcp.hpp"
#include "hal/point_instrument.hpp"

namespace armsig::linux_hal {

struct RegisterClientConfiguration {
  std::string address;       // of the server: IPv4 or IPv6, as numbers
  std::uint16_t port = 502;  // of Modbus
  modbus::NumberProfile profile;
  hal::Duration poll_period = std::chrono::milliseconds(50);
  hal::Duration answer_timeout = std::chrono::milliseconds(200);  // then it is asked anew
  // How long before it can be read a reading can have been measured.
  hal::Duration age = std::chrono::milliseconds(100);
  hal::FreshnessLimits freshness{};
};

// The client of that server, without a thread: poll() sends what is due and takes what has arrived.
// One request at a time; a connection on which an answer does not come, or is none, is made anew.
// Pass poll() the time of SteadyClock.
template <typename Reading>
class RegisterClient final : public hal::ReadingSource<Reading> {
 public:
  // Preconditions: the address is one, modbus::request_of(profile) succeeds, and the profile has
  // the registers of three coordinates, or of as many lengths as there are anchors.
  explicit RegisterClient(const RegisterClientConfiguration& configuration);
  RegisterClient(const RegisterClient&) = delete;
  RegisterClient& operator=(const RegisterClient&) = delete;

 private:
  using Polled = Result<std::optional<Reading>>;

  Polled do_poll(hal::Instant now) override;
  [[nodiscard]] std::string_view do_words(Error error) const override;
  [[nodiscard]] std::uint32_t do_malformed() const override { return malformed_; }

  void connect(hal::Instant now);
  [[nodiscard]] bool is_connected(hal::Instant now);
  void drop(hal::Instant now, int reason);
  void ask(hal::Instant now);
  // What has come in, up to a whole answer.
  Polled receive(hal::Instant now);
  Polled take_answer(std::span<const std::uint8_t> answer, hal::Instant now);
  Polled take_numbers(const modbus::RegisterNumbers& numbers, hal::Instant asked_at,
                      hal::Instant now);
  Polled refuse(Error error, std::string_view words);

  RegisterClientConfiguration configuration_;
  modbus::ReadRequest request_;
  FileDescriptor socket_;
  BackOff reconnect_;
  bool connecting_ = false;
  hal::Instant connecting_since_;
  int errno_ = 0;  // why there is no connection
  hal::Freshness freshness_;
  FixedVector<std::uint8_t, modbus::kMostTcpBytes> answer_;  // so far
  std::uint16_t transaction_ = 0;
  std::optional<hal::Instant> asked_at_;  // the request that is not answered yet
  hal::Instant ask_at_;                   // when the next one is due
  hal::Instant used_asked_at_;            // the last request that brought a reading
  std::uint32_t unnumbered_ = 0;          // the number of the next reading that has none
  std::uint32_t malformed_ = 0;           // since the start
  std::string_view refused_words_;
};

using ModbusPoints = RegisterClient<hal::PointReading>;
using ModbusLengths = RegisterClient<hal::LengthReading>;

}  // namespace armsig::linux_hal
