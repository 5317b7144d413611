// SPDX-License-Identifier: MIT
// A memory that survives power-off, with the habits of NOR flash: erased by the sector to FFh,
// programmed by the page once after an erase. A page or sector operation that power-off cuts short
// leaves that page or sector in any state; nothing else changes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/error.hpp"

namespace armsig::hal {

inline constexpr std::uint8_t kErasedByte = 0xFF;

struct MemoryLayout {
  std::size_t page_bytes = 0;
  std::size_t pages_per_sector = 0;
  std::size_t sectors = 0;

  [[nodiscard]] constexpr std::size_t sector_bytes() const { return page_bytes * pages_per_sector; }
  [[nodiscard]] constexpr std::size_t bytes() const { return sector_bytes() * sectors; }
};

class NonvolatileMemory {
 public:
  [[nodiscard]] MemoryLayout layout() const { return do_layout(); }

  // Fills `into` from `address` on. Errors: kAddressOutOfRange, kStorageFault.
  Result<void> read(std::size_t address, std::span<std::uint8_t> into);

  // Errors: kAddressOutOfRange (no such sector), kStorageFull, kStorageFault.
  Result<void> erase_sector(std::size_t sector);

  // Writes one whole page at the page-aligned `address`; on success it has reached the device.
  // Errors: kAddressOutOfRange (also: not aligned, not one page long), kNotErased, kStorageFull,
  // kStorageFault.
  Result<void> program_page(std::size_t address, std::span<const std::uint8_t> page);

 protected:
  ~NonvolatileMemory() = default;

 private:
  [[nodiscard]] virtual MemoryLayout do_layout() const = 0;
  virtual Result<void> do_read(std::size_t address, std::span<std::uint8_t> into) = 0;
  virtual Result<void> do_erase_sector(std::size_t sector) = 0;
  virtual Result<void> do_program_page(std::size_t address, std::span<const std::uint8_t> page) = 0;
};

}  // namespace armsig::hal
