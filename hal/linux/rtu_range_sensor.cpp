// SPDX-License-Identifier: MIT
#include "hal/linux/rtu_range_sensor.hpp"

#include <linux/serial.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <system_error>

#include <modbus.h>

#include "hal/linux/back_off.hpp"
#include "hal/linux/steady_clock.hpp"
#include "hal/modbus/rtu.hpp"

namespace armsig::linux_hal {
namespace {

// The thread looks this often whether it is to stop.
constexpr hal::Duration kLongestSleep = std::chrono::milliseconds(50);

modbus_t* as_modbus(void* context) { return static_cast<modbus_t*>(context); }

// What libmodbus's errno says about the sensor. Timeouts are kSensorSilent.
Error sensor_error(int number) {
  switch (number) {
    case ETIMEDOUT:
    case EINTR:
      return Error::kSensorSilent;
    case EMBBADCRC:
      return Error::kSensorBadCrc;
    case EMBBADSLAVE:
      return Error::kSensorWrongUnit;
    case EMBBADDATA:
    case EMBBADEXC:
    case EMBUNKEXC:
    case EMBMDATA:
      return Error::kSensorMalformed;
    default:
      return number > MODBUS_ENOBASE && number < EMBBADCRC ? Error::kSensorException
                                                           : Error::kSensorPortGone;
  }
}

// The whole answer is waited for as long, not each byte of it anew: libmodbus would wait half a
// second for one that was lost.
void set_answer_timeout(modbus_t* context, hal::Duration timeout) {
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(timeout);
  const auto rest = std::chrono::duration_cast<std::chrono::microseconds>(timeout - whole);
  modbus_set_response_timeout(context, static_cast<std::uint32_t>(whole.count()),
                              static_cast<std::uint32_t>(rest.count()));
  modbus_set_byte_timeout(context, 0, 0);
}

bool turn_direction(int port, Direction direction) {
  if (direction == Direction::kAutomatic) return true;
  serial_rs485 settings{};
  if (::ioctl(port, TIOCGRS485, &settings) != 0) return false;
  const bool high = direction == Direction::kRtsHigh;
  settings.flags |= SER_RS485_ENABLED | (high ? SER_RS485_RTS_ON_SEND : SER_RS485_RTS_AFTER_SEND);
  settings.flags &=
      ~(SER_RS485_RX_DURING_TX | (high ? SER_RS485_RTS_AFTER_SEND : SER_RS485_RTS_ON_SEND));
  return ::ioctl(port, TIOCSRS485, &settings) == 0;
}

}  // namespace

void RtuRangeSensor::ContextCloser::operator()(void* context) const {
  modbus_close(as_modbus(context));
  modbus_free(as_modbus(context));
}

Result<std::unique_ptr<RtuRangeSensor>> RtuRangeSensor::start(
    const RtuRangeSensorConfiguration& configuration) {
  constexpr int kDataBits = 8;
  const auto requests =
      modbus::requests_of({.profile = configuration.profile, .channels = configuration.channels});
  if (!requests) return std::unexpected(requests.error());
  Context context(modbus_new_rtu(configuration.device.c_str(), configuration.baud,
                                 configuration.parity, kDataBits, configuration.stop_bits));
  if (context == nullptr) return std::unexpected(Error::kProfileInvalid);
  set_answer_timeout(as_modbus(context.get()), configuration.answer_timeout);
  std::unique_ptr<RtuRangeSensor> sensor(new RtuRangeSensor(configuration, std::move(context)));
  try {
    sensor->thread_ = std::thread([raw = sensor.get()] { raw->talk(); });
  } catch (const std::system_error&) {
    return std::unexpected(Error::kSystemRefused);
  }
  return sensor;
}

RtuRangeSensor::RtuRangeSensor(const RtuRangeSensorConfiguration& configuration, Context context)
    : configuration_(configuration),
      context_(std::move(context)),
      round_({.profile = configuration.profile, .channels = configuration.channels}),
      freshness_(configuration.freshness) {}

RtuRangeSensor::~RtuRangeSensor() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void RtuRangeSensor::sleep_until(hal::Instant time) const {
  SteadyClock clock;
  while (!stop_ && monotonic_now() < time) {
    clock.wait_until(std::min(time, monotonic_now() + kLongestSleep));
  }
}

// The port open, and its direction turned as configured.
bool RtuRangeSensor::connect() {
  modbus_t* context = as_modbus(context_.get());
  direction_refused_ = false;
  port_errno_ = modbus_connect(context) == 0 ? 0 : std::max(errno, 1);
  if (port_errno_ != 0) return false;
  if (turn_direction(modbus_get_socket(context), configuration_.direction)) return true;
  direction_refused_ = true;
  port_errno_ = std::max(errno, 1);
  modbus_close(context);
  return false;
}

// A full box means that nobody polls; what it holds is old then, and so is this soon.
void RtuRangeSensor::post(const Result<hal::RangeReading>& reading) {
  (void)box_.post({reading, monotonic_now()});
}

void RtuRangeSensor::talk() {
  BackOff reopen;
  while (!stop_) {
    const hal::Instant begin = monotonic_now();
    if (!connected_) {
      connected_ = connect();
      if (connected_) {
        reopen.succeed();
      } else {
        reopen.fail(begin);
        post(std::unexpected(Error::kSensorPortGone));
        sleep_until(reopen.due_at());
        continue;
      }
    }
    const auto reading = measure();
    if (reading || reading.error() != Error::kSensorSilent) post(reading);
    if (!reading && reading.error() == Error::kSensorPortGone) {
      modbus_close(as_modbus(context_.get()));
      connected_ = false;
    }
    hal::Instant next = begin + configuration_.poll_period;
    // Without a counter, two rounds are as far apart as two readings of the sensor, whichever of
    // their requests took long.
    if (configuration_.channels && !configuration_.channels->counter) {
      next = std::max(next, monotonic_now() + configuration_.channels->update_period);
    }
    sleep_until(next);
  }
}

Result<hal::RangeReading> RtuRangeSensor::measure() {
  const hal::Duration pause = modbus::frame_pause(static_cast<std::uint32_t>(configuration_.baud));
  round_.begin(monotonic_now());
  auto request = round_.next();
  while (request && !stop_) {
    if (const auto asked = ask(*request); !asked) {
      if (asked.error() == Error::kSensorPortGone) return std::unexpected(asked.error());
      round_.fail(asked.error());
    }
    request = round_.next();
    if (request) sleep_until(monotonic_now() + pause);
  }
  if (request) return std::unexpected(Error::kSensorSilent);
  failing_ = round_.failing_unit().value_or(hal::FailingUnit{});
  return round_.finish(monotonic_now());
}

// Asks, and takes the answer into the round. Errors: what became of it.
Result<void> RtuRangeSensor::ask(const modbus::ReadRequest& request) {
  modbus_t* context = as_modbus(context_.get());
  const modbus::RegisterRange& range = request.registers;
  std::array<std::uint16_t, modbus::kMaxRegisters> registers{};
  constexpr std::uint8_t kHoldingRegisters = 3;
  const auto read =
      request.function == kHoldingRegisters ? &modbus_read_registers : &modbus_read_input_registers;
  // What a late or broken answer left behind must not be taken for the next one.
  modbus_flush(context);
  modbus_set_slave(context, request.unit);
  if (read(context, range.first, range.count, registers.data()) == range.count) {
    round_.take(std::span(registers).first(range.count));
    return {};
  }
  const int number = errno;
  const Error error = sensor_error(number);
  if (error == Error::kSensorException) {
    exception_ = static_cast<std::uint8_t>(number - MODBUS_ENOBASE);
  }
  if (error == Error::kSensorPortGone) port_errno_ = number;
  return std::unexpected(error);
}

Result<std::optional<hal::RangeReading>> RtuRangeSensor::do_poll(hal::Instant now) {
  // One message a call, but repeated sequences are passed over.
  while (const auto message = box_.take()) {
    const Result<hal::RangeReading>& reading = message->reading;
    if (!reading) return std::unexpected(reading.error());
    if (freshness_.take(reading->sequence, message->came_at)) return *reading;
  }
  if (const auto overdue = freshness_.overdue(now)) {
    return std::unexpected(port_errno_ == 0 ? *overdue : Error::kSensorPortGone);
  }
  return std::nullopt;
}

std::string_view RtuRangeSensor::do_words(Error error) const {
  if (error == Error::kSensorException) return modbus::describe_exception(exception_);
  // An answer that begins with the request is none that libmodbus can read.
  if (error == Error::kSensorBadCrc) return "noise, or an RS-485 adapter that echoes requests";
  if (error != Error::kSensorPortGone) return {};
  if (direction_refused_) return "its driver turns no RS-485 direction (TIOCSRS485)";
  const char* const words = ::strerrordesc_np(port_errno_);
  return words == nullptr ? std::string_view() : words;
}

}  // namespace armsig::linux_hal
