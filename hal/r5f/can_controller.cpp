// SPDX-License-Identifier: MIT
#include "hal/r5f/can_controller.hpp"

namespace armsig::r5f {
namespace {

constexpr std::uint32_t kSoftwareReset = 0x00;
constexpr std::uint32_t kMode = 0x04;
constexpr std::uint32_t kPrescaler = 0x08;
constexpr std::uint32_t kBitTiming = 0x0C;
constexpr std::uint32_t kErrorStatus = 0x14;
constexpr std::uint32_t kStatus = 0x18;
constexpr std::uint32_t kInterruptStatus = 0x1C;
constexpr std::uint32_t kInterruptClear = 0x24;
constexpr std::uint32_t kTransmit = 0x30;  // identifier, length, data words 1 and 2
constexpr std::uint32_t kReceive = 0x50;   // the same
constexpr std::uint32_t kFilterEnable = 0x60;

constexpr std::uint32_t kReset = 1;
constexpr std::uint32_t kEnable = 2;

// Status register.
constexpr std::uint32_t kWarning = 1U << 6;
constexpr std::uint32_t kErrorStateShift = 7;
constexpr std::uint32_t kErrorStateMask = 3;
constexpr std::uint32_t kStateBusOff = 2;
constexpr std::uint32_t kStatePassive = 3;
constexpr std::uint32_t kTransmitFull = 1U << 10;
// Interrupt status register.
constexpr std::uint32_t kReceiveOverflow = 1U << 6;
constexpr std::uint32_t kReceiveNotEmpty = 1U << 7;
constexpr std::uint32_t kBusOff = 1U << 9;

// Identifier word.
constexpr unsigned kBaseShift = 21;
constexpr std::uint32_t kStandardRemote = 1U << 20;  // of an extended frame: SRR, recessive
constexpr std::uint32_t kExtended = 1U << 19;
constexpr std::uint32_t kExtendedRemote = 1;
constexpr std::uint32_t kLowIdentifier = 0x3FFFF;  // the 18 bits beyond the base identifier
constexpr unsigned kLengthShift = 28;

// 100 MHz / 10 is 10 quanta a bit: 1 + 7 + 2, sampled at 80 %, jump width 1 (each less one).
constexpr std::uint32_t kDivideBy10 = 9;
constexpr std::uint32_t kSegments = (1U << 4) | 6U;
static_assert(100'000'000 / 10 / 10 == CanController::kBitsPerSecond);

std::uint32_t identifier_word(const hal::CanFrame& frame) {
  if (!frame.extended) return frame.id << kBaseShift | (frame.remote ? kStandardRemote : 0);
  return (frame.id >> 18) << kBaseShift | kStandardRemote | kExtended |
         (frame.id & kLowIdentifier) << 1 | (frame.remote ? kExtendedRemote : 0);
}

// Four bytes, the first one in the highest bits.
std::uint32_t data_word(const hal::CanFrame& frame, std::size_t first) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) word = word << 8 | frame.data[first + i];
  return word;
}

void take_word(hal::CanFrame& frame, std::size_t first, std::uint32_t word) {
  for (std::size_t i = 0; i < 4; ++i) {
    frame.data[first + i] = static_cast<std::uint8_t>(word >> (24 - 8 * i));
  }
}

}  // namespace

CanController::CanController(std::uintptr_t base, hal::Clock& clock,
                             const volatile std::uint32_t* forced_state)
    : registers_(base), clock_(clock), forced_state_(forced_state) {
  go_on_the_bus();
}

void CanController::go_on_the_bus() {
  registers_.write(kSoftwareReset, kReset);  // ends by itself, in configuration mode
  registers_.write(kPrescaler, kDivideBy10);
  registers_.write(kBitTiming, kSegments);
  registers_.write(kFilterEnable, 0);  // none: every frame is received
  registers_.write(kMode, 0);
  registers_.write(kInterruptClear, ~0U);
  registers_.write(kSoftwareReset, kEnable);
}

std::uint32_t CanController::status_register() const {
  const std::uint32_t status = registers_.read(kStatus);
  if (forced_state_ == nullptr || *forced_state_ == 0) return status;
  return (status & ~(kErrorStateMask << kErrorStateShift)) | *forced_state_ << kErrorStateShift;
}

Result<void> CanController::do_send(const hal::CanFrame& frame) {
  if (off_since_) return std::unexpected(Error::kBusOff);
  if ((status_register() & kTransmitFull) != 0) return std::unexpected(Error::kBusBusy);
  registers_.write(kTransmit, identifier_word(frame));
  registers_.write(kTransmit + 4, std::uint32_t{frame.length} << kLengthShift);
  registers_.write(kTransmit + 8, data_word(frame, 0));
  registers_.write(kTransmit + 12, data_word(frame, 4));
  ++status_.sent;
  return {};
}

std::optional<hal::ReceivedCanFrame> CanController::do_receive() {
  if (off_since_ || (registers_.read(kInterruptStatus) & kReceiveNotEmpty) == 0) {
    return std::nullopt;
  }
  const std::uint32_t identifier = registers_.read(kReceive);
  const std::uint32_t length = registers_.read(kReceive + 4) >> kLengthShift;
  const std::uint32_t word0 = registers_.read(kReceive + 8);
  const std::uint32_t word1 = registers_.read(kReceive + 12);
  registers_.write(kInterruptClear, kReceiveNotEmpty);  // set again while there are more
  hal::ReceivedCanFrame received{{}, clock_.now()};
  hal::CanFrame& frame = received.frame;
  frame.extended = (identifier & kExtended) != 0;
  frame.id = identifier >> kBaseShift;
  if (frame.extended) frame.id = frame.id << 18 | (identifier >> 1 & kLowIdentifier);
  frame.remote = (identifier & (frame.extended ? kExtendedRemote : kStandardRemote)) != 0;
  frame.length = static_cast<std::uint8_t>(length > hal::kMaxCanData ? hal::kMaxCanData : length);
  take_word(frame, 0, word0);
  take_word(frame, 4, word1);
  for (std::size_t i = frame.length; i < hal::kMaxCanData; ++i) frame.data[i] = 0;
  ++status_.received;
  return received;
}

hal::CanStatus CanController::do_status() {
  const std::uint32_t status = status_register();
  const std::uint32_t interrupts = registers_.read(kInterruptStatus);
  const std::uint32_t state = status >> kErrorStateShift & kErrorStateMask;
  if (const std::uint32_t errors = registers_.read(kErrorStatus); errors != 0) {
    ++status_.error_frames;
    registers_.write(kErrorStatus, errors);  // cleared by writing ones
  }
  if ((interrupts & kReceiveOverflow) != 0) {
    ++status_.lost;  // one or more
    registers_.write(kInterruptClear, kReceiveOverflow);
  }
  const bool off = (interrupts & kBusOff) != 0 || state == kStateBusOff;
  if (off && !off_since_) {
    off_since_ = clock_.now();
    ++status_.bus_offs;
  } else if (off_since_ && clock_.now() - *off_since_ >= kStayAway) {
    off_since_.reset();
    ++status_.restarts;
    go_on_the_bus();
  }
  if (off_since_) {
    status_.state = hal::CanState::kBusOff;
  } else if (state == kStatePassive) {
    status_.state = hal::CanState::kPassive;
  } else {
    status_.state = (status & kWarning) != 0 ? hal::CanState::kWarning : hal::CanState::kActive;
  }
  return status_;
}

}  // namespace armsig::r5f
