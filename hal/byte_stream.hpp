// SPDX-License-Identifier: MIT
// A serial line, seen without its registers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/error.hpp"

namespace armsig::hal {

class ByteStream {
 public:
  // Queues all of `bytes`; never blocks. Errors: kBusBusy (no room, nothing queued), kBusDown.
  Result<void> write(std::span<const std::uint8_t> bytes) { return do_write(bytes); }

  // Takes what has arrived, at most into.size() bytes, and returns how many; never blocks.
  // Errors: kBusDown, kCharactersLost (told once; reading goes on behind the gap).
  Result<std::size_t> read(std::span<std::uint8_t> into) { return do_read(into); }

 protected:
  ~ByteStream() = default;

 private:
  virtual Result<void> do_write(std::span<const std::uint8_t> bytes) = 0;
  virtual Result<std::size_t> do_read(std::span<std::uint8_t> into) = 0;
};

}  // namespace armsig::hal
