// SPDX-License-Identifier: MIT
// The CAN controller of the Zynq UltraScale+ (UG1085, chapter "CAN Controller"; registers UG1087,
// module CAN), polled. It comes configured for 1 Mbit/s from a 100 MHz clock.
#pragma once

#include <chrono>
#include <cstdint>

#include "hal/can_bus.hpp"
#include "hal/clock.hpp"
#include "hal/r5f/registers.hpp"

namespace armsig::r5f {

class CanController final : public hal::CanBus {
 public:
  // After a bus-off the controller stays away this long, or what took it off would do so at once
  // again; then it is reset.
  static constexpr hal::Duration kStayAway = std::chrono::milliseconds(100);
  static constexpr std::uint32_t kBitsPerSecond = 1'000'000;

  // Resets the block at `base` and goes on the bus, receiving every frame. `clock` must outlive the
  // controller. `forced_state`, where not null, points to a word that stands for the error state of
  // the status register while it is not zero: an emulated bus makes no errors, so that a test must
  // say what silicon would see.
  CanController(std::uintptr_t base, hal::Clock& clock,
                const volatile std::uint32_t* forced_state = nullptr);

 private:
  Result<void> do_send(const hal::CanFrame& frame) override;
  std::optional<hal::ReceivedCanFrame> do_receive() override;
  hal::CanStatus do_status() override;

  void go_on_the_bus();
  [[nodiscard]] std::uint32_t status_register() const;

  Registers registers_;
  hal::Clock& clock_;
  const volatile std::uint32_t* forced_state_;
  hal::CanStatus status_;
  std::optional<hal::Instant> off_since_;
};

}  // namespace armsig::r5f
