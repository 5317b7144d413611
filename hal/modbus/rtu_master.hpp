// SPDX-License-Identifier: MIT
// One Modbus RTU request after the other over a serial line that never blocks.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>

#include "hal/byte_stream.hpp"
#include "hal/clock.hpp"
#include "hal/modbus/rtu.hpp"

namespace armsig::modbus {

struct RtuTiming {
  std::uint32_t baud = 115200;  // the line's rate, for the pauses
  hal::Duration answer_timeout = std::chrono::milliseconds(100);
};

class RtuMaster {
 public:
  // `line` must outlive the master.
  RtuMaster(const RtuTiming& timing, hal::ByteStream& line) : timing_(timing), line_(&line) {}

  // Whether a request may be started: none is under way, and the line has been quiet for a frame
  // pause.
  [[nodiscard]] bool idle(hal::Instant now) const;

  // Sends `request`; what the line still holds of before is thrown away. Precondition: idle(now).
  // Errors: kBusDown, kBusBusy.
  Result<void> start(const ReadRequest& request, hal::Instant now);

  // Takes what has arrived. Empty while the answer is awaited, or none is. An answer ends when it
  // is as long as it says, or when the line pauses after some of it. Errors: as modbus::decode, and
  // kSensorSilent (time-out), kBusDown.
  [[nodiscard]] std::optional<std::expected<Registers, Failure>> poll(hal::Instant now);

 private:
  std::optional<std::expected<Registers, Failure>> finish();

  RtuTiming timing_;
  hal::ByteStream* line_;
  std::optional<ReadRequest> request_;
  hal::Instant started_at_;
  std::optional<hal::Instant> last_byte_at_;
  std::array<std::uint8_t, kMaxFrameBytes> buffer_{};
  std::size_t size_ = 0;
};

}  // namespace armsig::modbus
