// SPDX-License-Identifier: MIT
// The controller on core 0 of the R5F: drives and range sensor on CAN0, console on UART0.
#include <array>

#include "core/base/check.hpp"
#include "firmware/cabinet_r5f/configuration.hpp"
#include "firmware/cabinet_r5f/platform.hpp"
#include "firmware/controller/controller.hpp"
#include "hal/canopen/master.hpp"
#include "hal/r5f/bank_memory.hpp"
#include "hal/r5f/can_controller.hpp"
#include "hal/r5f/cycle_clock.hpp"
#include "hal/r5f/uart.hpp"
#include "hal/serial_console.hpp"
#include "toolchain/boards/stack.hpp"

namespace armsig::cabinet {
namespace {

constexpr std::uintptr_t kUart0 = 0xFF00'0000;
constexpr std::uintptr_t kCan0 = 0xFF06'0000;

// What the drives are told and the bus load is computed from is what the controller talks at.
static_assert(kBitsPerSecond == r5f::CanController::kBitsPerSecond);

[[gnu::section(".bank")]] r5f::BankMemory::Bank bank;

// These two have their own frames, for what they are made of is large.
[[gnu::noinline]] canopen::Master& master(hal::CanBus& bus, canopen::RangeSensor& sensor) {
  const auto drives = canopen::check(drive_configuration());
  ARMSIG_CHECK(drives);
  [[gnu::section(".bss.near")]] static canopen::Master master(*drives, bus, &sensor);
  return master;
}

[[gnu::noinline]] controller::Controller& controller_of(hal::JointDrives& drives,
                                                        hal::RangeSensor& sensor, hal::Clock& clock,
                                                        hal::NonvolatileMemory& memory,
                                                        hal::Console& console) {
  static const std::array<hal::Console*, 1> consoles{&console};
  const controller::Configuration configuration = controller_configuration();
  ARMSIG_CHECK(controller::check(configuration));
  static controller::Controller controller(configuration, drives, sensor, clock, memory, consoles);
  return controller;
}

[[noreturn]] void run() {
  static r5f::CycleClock clock;
  [[gnu::section(".bss.near")]] static r5f::Uart uart(kUart0, r5f::Parity::kNone);
  static hal::SerialConsole console(uart);
  static r5f::CanController bus(kCan0, clock, forced_can_state());
  static r5f::BankMemory memory(bank, lost_power());
  [[gnu::section(".bss.near")]] static canopen::RangeSensor sensor(sensor_configuration());
  controller::Controller& controller =
      controller_of(master(bus, sensor), sensor, clock, memory, console);
  hal::Watchdog& dog = watchdog();

  console.broadcast("# armsig");
  if (dog.caused_reset()) console.broadcast("# reset by the watchdog");
  hal::Instant next = clock.now();
  for (;;) {
    controller.tick(clock.wait_until(next));
    dog.kick();
    // The background has the first half of each period; the other half is for a step that began in
    // the first, and for the drives' answers.
    do controller.background();
    while (clock.now() < next + kPeriod / 2);
    // Ticks that a long step has cost are left out, not made up for: drives expect one SYNC a
    // period.
    do next += kPeriod;
    while (next + kPeriod / 2 < clock.now());
  }
}

}  // namespace
}  // namespace armsig::cabinet

extern "C" [[noreturn]] void armsig_main() {
  // A symbol for the check of the image: how much of its RAM is the measurement log.
  asm volatile(".global armsig_log_bytes\n.set armsig_log_bytes, %c0"
               :
               : "i"(sizeof(armsig::controller::MeasurementLog)));
  armsig::cabinet::run();
}
