// SPDX-License-Identifier: MIT
// The direction of an RS-485 transceiver, by a driver that can turn it: ioctl() of this program
// keeps what such a driver would.
#include <linux/serial.h>
#include <stdarg.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "hal/linux/rtu_range_sensor.hpp"
#include "hal/linux/steady_clock.hpp"
#include "host_tests/support/pty_server.hpp"

namespace {

struct Driver {
  std::mutex mutex;
  serial_rs485 settings{};
  unsigned turned = 0;
};
Driver& driver() {
  static Driver driver;
  return driver;
}

}  // namespace

extern "C" int ioctl(int file, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  if (request != TIOCGRS485 && request != TIOCSRS485) {
    return static_cast<int>(syscall(SYS_ioctl, file, request, argument));
  }
  const std::lock_guard lock(driver().mutex);
  auto& settings = *static_cast<serial_rs485*>(argument);
  if (request == TIOCGRS485) {
    settings = driver().settings;
  } else {
    driver().settings = settings;
    ++driver().turned;
  }
  return 0;
}

namespace armsig::linux_hal {
namespace {

using std::chrono::milliseconds;

// The flags that the driver has been given, when the sensor has begun to ask.
std::uint32_t flags_for(Direction direction, std::uint32_t before) {
  {
    const std::lock_guard lock(driver().mutex);
    driver().settings = {};
    driver().settings.flags = before;
    driver().settings.delay_rts_before_send = 3;
  }
  std::atomic<bool> asked{false};
  test::PtyServer line([&](const auto&) {
    asked = true;
    return test::PtyServer::Bytes();
  });
  const auto sensor = RtuRangeSensor::start({.device = line.device, .direction = direction});
  EXPECT_TRUE(sensor);
  for (int i = 0; i < 3000 && !asked; ++i) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_TRUE(asked);
  const std::lock_guard lock(driver().mutex);
  EXPECT_EQ(driver().settings.delay_rts_before_send, 3U) << "what else was set stays";
  return driver().settings.flags;
}

TEST(Rs485Direction, is_turned_by_the_driver_before_anything_is_sent) {
  EXPECT_EQ(flags_for(Direction::kRtsHigh, SER_RS485_RTS_AFTER_SEND | SER_RS485_RX_DURING_TX),
            SER_RS485_ENABLED | SER_RS485_RTS_ON_SEND);
  EXPECT_EQ(flags_for(Direction::kRtsLow, SER_RS485_RTS_ON_SEND),
            SER_RS485_ENABLED | SER_RS485_RTS_AFTER_SEND);
  EXPECT_EQ(driver().turned, 2U);
}

TEST(Rs485Direction, is_left_as_it_is_where_the_adapter_turns_it) {
  const unsigned before = driver().turned;
  EXPECT_EQ(flags_for(Direction::kAutomatic, SER_RS485_RTS_ON_SEND),
            static_cast<std::uint32_t>(SER_RS485_RTS_ON_SEND));
  EXPECT_EQ(driver().turned, before);
}

}  // namespace
}  // namespace armsig::linux_hal
