// SPDX-License-Identifier: MIT
// One or several units of Modbus RTU as a range sensor by libmodbus, on a serial line or a
// pseudo-terminal.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "hal/freshness.hpp"
#include "hal/mailbox.hpp"
#include "hal/modbus/round.hpp"
#include "hal/range_sensor.hpp"

namespace armsig::linux_hal {

// What turns the direction of an RS-485 transceiver.
enum class Direction : std::uint8_t {
  kAutomatic,  // the adapter or the transceiver does, by itself
  kRtsHigh,    // the driver of the port raises RTS while it sends (TIOCSRS485)
  kRtsLow,     // it lowers RTS while it sends
};

struct RtuRangeSensorConfiguration {
  std::string device;  // such as /dev/ttyUSB0
  int baud = 115200;
  char parity = 'E';  // 'N', 'E' or 'O'
  int stop_bits = 1;
  Direction direction = Direction::kAutomatic;
  modbus::Profile profile{};
  std::optional<modbus::ChannelProfile> channels{};  // where there are any, instead of `profile`
  hal::Duration poll_period = std::chrono::milliseconds(20);      // from round to round
  hal::Duration answer_timeout = std::chrono::milliseconds(100);  // of a request, to the last byte
  hal::FreshnessLimits freshness{};
};

// libmodbus waits for answers, so a thread of its own does the talking and hands over what came;
// poll() never waits. A device that is missing or was unplugged is opened again with a back-off.
// Pass poll() the time of SteadyClock.
class RtuRangeSensor final : public hal::RangeSensor {
 public:
  // The device need not exist yet. Allocates here and never again.
  // Errors: kProfileInvalid (profile or channels, or line settings that libmodbus does not know),
  // kSystemRefused (no thread). A driver that refuses the direction is told by poll(), as a port
  // that cannot be opened is.
  [[nodiscard]] static Result<std::unique_ptr<RtuRangeSensor>> start(
      const RtuRangeSensorConfiguration& configuration);

  ~RtuRangeSensor();
  RtuRangeSensor(const RtuRangeSensor&) = delete;
  RtuRangeSensor& operator=(const RtuRangeSensor&) = delete;

 private:
  struct ContextCloser {
    void operator()(void* context) const;
  };
  using Context = std::unique_ptr<void, ContextCloser>;  // modbus_t, kept out of this header

  RtuRangeSensor(const RtuRangeSensorConfiguration& configuration, Context context);

  Result<std::optional<hal::RangeReading>> do_poll(hal::Instant now) override;
  [[nodiscard]] std::uint8_t do_exception_code() const override { return exception_; }
  [[nodiscard]] std::string_view do_words(Error error) const override;
  [[nodiscard]] std::optional<hal::FailingUnit> do_failing_unit() const override {
    const hal::FailingUnit failing = failing_;
    return failing.unit == 0 ? std::nullopt : std::optional(failing);
  }

  struct Message {
    Result<hal::RangeReading> reading;
    hal::Instant came_at;
  };

  void talk();
  [[nodiscard]] bool connect();
  void sleep_until(hal::Instant time) const;
  void post(const Result<hal::RangeReading>& reading);
  [[nodiscard]] Result<hal::RangeReading> measure();
  [[nodiscard]] Result<void> ask(const modbus::ReadRequest& request);

  static constexpr std::size_t kMailboxReadings = 8;

  RtuRangeSensorConfiguration configuration_;
  Context context_;
  modbus::Round round_;  // of the thread
  hal::Freshness freshness_;
  hal::Mailbox<Message, kMailboxReadings> box_;
  std::atomic<std::uint8_t> exception_{0};
  std::atomic<hal::FailingUnit> failing_{};  // in the last round; unit 0: none
  std::atomic<int> port_errno_{0};           // why the port isn't open; 0: it is
  std::atomic<bool> direction_refused_{false};
  std::atomic<bool> stop_{false};
  bool connected_ = false;  // of the thread
  std::thread thread_;
};

}  // namespace armsig::linux_hal
