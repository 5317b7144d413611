// SPDX-License-Identifier: MIT
// A UART of the Zynq UltraScale+ (UG1085, chapter "UART Controller"; registers UG1087, module
// UART), polled: what is written waits in memory for room in the 64-byte FIFO.
#pragma once

#include <array>
#include <cstdint>

#include "hal/byte_stream.hpp"
#include "hal/r5f/registers.hpp"

namespace armsig::r5f {

enum class Parity : std::uint8_t { kNone, kEven };

class Uart final : public hal::ByteStream {
 public:
  static constexpr std::size_t kQueueBytes = 4096;

  // Resets the block at `base` and runs it at 115200 baud, 8 data bits, 1 stop bit, from a 100 MHz
  // clock. `looped` connects the transmitter to the receiver inside, for self-tests.
  Uart(std::uintptr_t base, Parity parity, bool looped = false);

 private:
  Result<void> do_write(std::span<const std::uint8_t> bytes) override;
  // Also moves on what waits to be sent, so that it is to be called every tick. Also
  // kCharactersLost: the FIFO overflowed since the last call.
  Result<std::size_t> do_read(std::span<std::uint8_t> into) override;

  void send_waiting();

  Registers registers_;
  std::array<std::uint8_t, kQueueBytes> queue_{};
  std::size_t first_ = 0;  // of the queue
  std::size_t waiting_ = 0;
};

}  // namespace armsig::r5f
