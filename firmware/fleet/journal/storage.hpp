// SPDX-License-Identifier: MIT
// The file under a ring journal, and nothing more of the system.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/error.hpp"

namespace armsig::fleet {

// Bytes at places. What lies beyond the end reads as zeros; a write beyond it makes the storage
// longer.
class Storage {
 public:
  // Errors: kStorageFault.
  [[nodiscard]] Result<void> read(std::uint64_t at, std::span<std::byte> bytes) {
    return do_read(at, bytes);
  }
  // Not safe from a power cut until sync(). Errors: kStorageFault, kStorageFull.
  [[nodiscard]] Result<void> write(std::uint64_t at, std::span<const std::byte> bytes) {
    return do_write(at, bytes);
  }
  // Errors: kStorageFault.
  [[nodiscard]] Result<void> sync() { return do_sync(); }

 protected:
  ~Storage() = default;

 private:
  virtual Result<void> do_read(std::uint64_t at, std::span<std::byte> bytes) = 0;
  virtual Result<void> do_write(std::uint64_t at, std::span<const std::byte> bytes) = 0;
  virtual Result<void> do_sync() = 0;
};

}  // namespace armsig::fleet
