// SPDX-License-Identifier: MIT
#include "hal/r5f/uart.hpp"

namespace armsig::r5f {
namespace {

constexpr std::uint32_t kControl = 0x00;
constexpr std::uint32_t kMode = 0x04;
constexpr std::uint32_t kInterruptDisable = 0x0C;
constexpr std::uint32_t kInterruptStatus = 0x14;
constexpr std::uint32_t kBaudGenerator = 0x18;
constexpr std::uint32_t kChannelStatus = 0x2C;
constexpr std::uint32_t kFifo = 0x30;
constexpr std::uint32_t kBaudDivider = 0x34;

constexpr std::uint32_t kResetBoth = 0b11;
constexpr std::uint32_t kEnableBoth = 0b1'0100;
constexpr std::uint32_t kParityNone = 0b100U << 3;
constexpr std::uint32_t kLocalLoop = 0b10U << 8;
constexpr std::uint32_t kOverrun = 1U << 5;
constexpr std::uint32_t kReceiveEmpty = 1U << 1;
constexpr std::uint32_t kTransmitFull = 1U << 4;
// 100 MHz / 62 / (13 + 1) = 115,207 baud.
constexpr std::uint32_t kDivideBy62 = 62;
constexpr std::uint32_t kDivideBy14 = 13;
constexpr unsigned kFifoBytes = 64;

}  // namespace

Uart::Uart(std::uintptr_t base, Parity parity, bool looped) : registers_(base) {
  registers_.write(kControl, kResetBoth);  // ends by itself
  registers_.write(kMode, (parity == Parity::kNone ? kParityNone : 0) | (looped ? kLocalLoop : 0));
  registers_.write(kBaudGenerator, kDivideBy62);
  registers_.write(kBaudDivider, kDivideBy14);
  registers_.write(kInterruptDisable, ~0U);
  registers_.write(kInterruptStatus, ~0U);
  registers_.write(kControl, kEnableBoth);
}

void Uart::send_waiting() {
  for (unsigned i = 0; i < kFifoBytes && waiting_ > 0; ++i) {
    if ((registers_.read(kChannelStatus) & kTransmitFull) != 0) return;
    registers_.write(kFifo, queue_[first_]);
    first_ = (first_ + 1) % kQueueBytes;
    --waiting_;
  }
}

Result<void> Uart::do_write(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > kQueueBytes - waiting_) return std::unexpected(Error::kBusBusy);
  for (const std::uint8_t byte : bytes) queue_[(first_ + waiting_++) % kQueueBytes] = byte;
  send_waiting();
  return {};
}

Result<std::size_t> Uart::do_read(std::span<std::uint8_t> into) {
  send_waiting();
  if ((registers_.read(kInterruptStatus) & kOverrun) != 0) {
    registers_.write(kInterruptStatus, kOverrun);
    // What the FIFO holds has a gap somewhere: it is of no use.
    for (unsigned i = 0; i < kFifoBytes; ++i) {
      if ((registers_.read(kChannelStatus) & kReceiveEmpty) != 0) break;
      (void)registers_.read(kFifo);
    }
    return std::unexpected(Error::kCharactersLost);
  }
  std::size_t count = 0;
  while (count < into.size() && (registers_.read(kChannelStatus) & kReceiveEmpty) == 0) {
    into[count++] = static_cast<std::uint8_t>(registers_.read(kFifo));
  }
  return count;
}

}  // namespace armsig::r5f
