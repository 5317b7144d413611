// SPDX-License-Identifier: MIT
// A reserved bank of memory with the habits of NOR flash: it outlives a reset, not the power.
//
// For boards whose flash belongs to somebody else (QEMU's board, or a Linux on the other cores that
// keeps the bank in a file); a board with a flash of its own puts a driver of it behind the same
// interface.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "hal/nonvolatile_memory.hpp"

namespace armsig::r5f {

class BankMemory final : public hal::NonvolatileMemory {
 public:
  static constexpr hal::MemoryLayout kLayout{
      .page_bytes = 128, .pages_per_sector = 4, .sectors = 28};

  struct Bank {
    alignas(8) std::array<std::uint8_t, kLayout.bytes()> bytes;
    std::uint64_t marker;
  };
  // A bank that has lost its power, or is without its marker, is erased; after a loss of power it
  // is not read before. Preconditions: `bank` is neither initialised nor touched by anybody else,
  // and does not lie in cached memory: a reset would throw away what was written.
  BankMemory(Bank& bank, bool lost_power);

 private:
  [[nodiscard]] hal::MemoryLayout do_layout() const override { return kLayout; }
  Result<void> do_read(std::size_t address, std::span<std::uint8_t> into) override;
  Result<void> do_erase_sector(std::size_t sector) override;
  Result<void> do_program_page(std::size_t address, std::span<const std::uint8_t> page) override;

  Bank& bank_;
};

}  // namespace armsig::r5f
