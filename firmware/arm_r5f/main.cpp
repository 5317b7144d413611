// SPDX-License-Identifier: MIT
// The emulated arm on core 1 of the R5F, for the controller on core 0: six drives and the range
// sensor on CAN1, requests on UART1. From the same sources as the bench on Linux (hal/simulated).
// Also what harms the controller on request: a bus that has errors, a core that hangs, a console
// line that overruns.
#include <array>

#include "core/base/check.hpp"
#include "firmware/arm_r5f/world.hpp"
#include "firmware/cabinet_r5f/emulated_world.hpp"
#include "firmware/controller/text.hpp"
#include "hal/cia402/scaling.hpp"
#include "hal/r5f/can_controller.hpp"
#include "hal/r5f/cycle_clock.hpp"
#include "hal/r5f/registers.hpp"
#include "hal/r5f/uart.hpp"
#include "hal/serial_console.hpp"
#include "hal/simulated/drive.hpp"
#include "hal/simulated/range_node.hpp"
#include "toolchain/boards/r5f/protection.hpp"

namespace armsig::arm_r5f {
namespace {

constexpr std::uintptr_t kUart1 = 0xFF01'0000;
constexpr std::uintptr_t kCan1 = 0xFF07'0000;

constexpr std::size_t kJoints = 6;
constexpr std::uint8_t kSensorNode = 32;
constexpr std::uint64_t kSeed = 1;
constexpr hal::Duration kPingPeriod = std::chrono::milliseconds(20);
constexpr double kCountsPerRadian = kCountsPerRevolution * kGearRatio / (2 * kPi);
// Longest time without a kick until the watchdog that this core plays bites.
constexpr hal::Duration kWatchdog = std::chrono::milliseconds(300);

class EmulatedArm {
 public:
  EmulatedArm(hal::CanBus& bus, hal::Instant now)
      : arm_(arm()),
        bus_(bus),
        node_(kSensorNode, bus, now),
        field_(field(kSeed), simulated::Random(kSeed)),
        next_ping_(now),
        now_(now) {
    const JointVector readings = start();
    for (std::size_t i = 0; i < kJoints; ++i) {
      // The controller's core may be held up by the emulator: any number of SYNCs may be late.
      drives_[i].emplace(
          simulated::DriveConfiguration{.node = static_cast<std::uint8_t>(i + 1),
                                        .motion = {.start = kCountsPerRadian * readings[i]},
                                        .sync_loss_periods = 0},
          bus, now);
    }
  }

  void run(hal::Instant now) {
    (void)bus_.status();
    while (const auto received = bus_.receive()) {
      advance(received->at);
      for (auto& drive : drives_) drive->take(*received);
      node_.take(*received);
    }
    advance(now);
    if (now < next_ping_) return;
    next_ping_ += kPingPeriod;
    if (next_ping_ < now) next_ping_ = now;
    ping();
  }

  // "fault joint=J kind=K code=C": K as in simulated::DriveFault.
  [[nodiscard]] bool serve(const controller::Request& request) {
    if (request.verb == "fault") return inject(request);
    if (request.verb == "can-state") {
      cabinet::emulated_world().can_state =
          static_cast<std::uint32_t>(argument(request, "state").value_or(0));
      return true;
    }
    if (request.verb == "stall") {
      cabinet::emulated_world().stall = cabinet::kMagic;
      return true;
    }
    if (request.verb == "overrun") {
      overrun();
      return true;
    }
    if (request.verb == "silent") {
      node_.set_silent(argument(request, "on").value_or(1) != 0);
      return true;
    }
    return false;
  }

 private:
  void advance(hal::Instant until) {
    if (until < now_) return;
    now_ = until;
    for (auto& drive : drives_) drive->advance(until);
    node_.advance(until);
  }

  void ping() {
    JointVector readings;
    for (const auto& drive : drives_) readings.push_back(drive->position() / kCountsPerRadian);
    const simulated::Sounding sounding =
        field_.measure(simulated::target_position(arm_, readings, arm_.targets[0]));
    hal::RangeReading reading;
    reading.sequence = sounding.sequence;
    reading.air_celsius = sounding.air_celsius;
    for (std::size_t j = 0; j < sounding.time_ns.size(); ++j) {
      reading.receivers.push_back({sounding.valid[j], 1e-9 * sounding.time_ns[j]});
    }
    node_.publish(reading);
  }

  // More characters than the controller's UART holds, by way of its local loop: from outside, the
  // emulator lets no more in than there is room for.
  static void overrun() {
    constexpr std::uintptr_t kUart0 = 0xFF00'0000;
    constexpr std::uint32_t kMode = 0x04;
    constexpr std::uint32_t kFifo = 0x30;
    constexpr std::uint32_t kLocalLoop = 0b10U << 8;
    constexpr unsigned kTooMany = 100;
    const r5f::Registers uart(kUart0);
    const std::uint32_t mode = uart.read(kMode);
    uart.write(kMode, mode | kLocalLoop);
    for (unsigned i = 0; i < kTooMany; ++i) uart.write(kFifo, 'x');
    uart.write(kMode, mode);
  }

  [[nodiscard]] static std::optional<double> argument(const controller::Request& request,
                                                      std::string_view key) {
    for (const auto& [name, value] : request.arguments) {
      if (name != key) continue;
      controller::Line why;
      const auto number = controller::needed_number(key, value, why);
      return number ? std::optional(*number) : std::nullopt;
    }
    return std::nullopt;
  }

  [[nodiscard]] bool inject(const controller::Request& request) {
    const auto joint = argument(request, "joint");
    const auto kind = argument(request, "kind");
    if (!joint || !kind || !(*joint >= 1 && *joint <= static_cast<double>(kJoints))) return false;
    drives_[static_cast<std::size_t>(*joint) - 1]->inject(
        static_cast<simulated::DriveFault>(static_cast<int>(*kind)),
        static_cast<std::int32_t>(argument(request, "code").value_or(0)));
    return true;
  }

  simulated::SimulatedArm arm_;
  hal::CanBus& bus_;
  std::array<std::optional<simulated::Drive>, kJoints> drives_;
  simulated::RangeNode node_;
  simulated::UltrasonicField field_;
  hal::Instant next_ping_;
  hal::Instant now_;
};

// Plays the watchdog of the controller's core: says when it bites; whoever runs the emulator then
// resets it.
class WatchdogModel {
 public:
  [[nodiscard]] bool bites(hal::Instant now) {
    cabinet::EmulatedWorld& world = cabinet::emulated_world();
    if (world.kicks != kicks_ || kicks_ == 0) {
      kicks_ = world.kicks;
      kicked_at_ = now;
    }
    if (now - kicked_at_ < kWatchdog || bitten_) return false;
    bitten_ = true;
    world.bitten = cabinet::kMagic;
    return true;
  }

 private:
  std::uint32_t kicks_ = 0;
  hal::Instant kicked_at_;
  bool bitten_ = false;
};

[[noreturn]] void run() {
  cabinet::EmulatedWorld& world = cabinet::emulated_world();
  world.can_state = 0;
  world.kicks = 0;
  world.stall = 0;
  world.magic = cabinet::kMagic;
  static r5f::CycleClock clock;
  static r5f::Uart uart(kUart1, r5f::Parity::kNone);
  static hal::SerialConsole console(uart);
  static r5f::CanController bus(kCan1, clock);
  static EmulatedArm arm(bus, clock.now());
  static WatchdogModel dog;
  console.broadcast("# emulated arm");
  for (;;) {
    const hal::Instant now = clock.now();
    arm.run(now);
    if (dog.bites(now)) console.broadcast("# watchdog");
    if (const auto line = console.read_line()) {
      const auto request = controller::parse_request(line->text());
      const bool done = request && arm.serve(*request);
      (void)console.write_line(line->client, done ? "ok" : "error");
    }
    clock.wait_until(now + std::chrono::microseconds(100));
  }
}

}  // namespace
}  // namespace armsig::arm_r5f

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" constexpr armsig::board::RegionTable<5> armsig_mpu_regions{{
    {0x1000'0000, 24, armsig::board::kData, 0},
    {0x1000'0000, 16, armsig::board::kCodeUncached, 0},
    {0x1010'0000, 20, armsig::board::kCode, 0},
    {0xFF00'0000, 21, armsig::board::kDevice, 0},
    {armsig::cabinet::kEmulatedWorldAt, armsig::cabinet::kEmulatedWorldLog2, armsig::board::kShared,
     0},
}};

std::span<const armsig::board::Region> armsig::board::regions() { return armsig_mpu_regions; }

extern "C" [[noreturn]] void armsig_main() { armsig::arm_r5f::run(); }
