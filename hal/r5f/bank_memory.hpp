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
      .page_bytes = 256, .pages_per_sector = 16, .sectors = 2};

  struct Bank {
    std::array<std::uint8_t, kLayout.bytes()> bytes;
    std::uint32_t marker;
  };
  // A bank without its marker has lost its power: it is erased. Precondition: `bank` is neither
  // initialised nor touched by anybody else.
  explicit BankMemory(Bank& bank);

 private:
  [[nodiscard]] hal::MemoryLayout do_layout() const override { return kLayout; }
  Result<void> do_read(std::size_t address, std::span<std::uint8_t> into) override;
  Result<void> do_erase_sector(std::size_t sector) override;
  Result<void> do_program_page(std::size_t address, std::span<const std::uint8_t> page) override;

  Bank& bank_;
};

}  // namespace armsig::r5f
