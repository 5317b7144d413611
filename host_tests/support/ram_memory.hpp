// SPDX-License-Identifier: MIT
// Flash in RAM, whose power can be cut in the middle of any operation.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "hal/nonvolatile_memory.hpp"

namespace armsig::test {

class RamMemory final : public hal::NonvolatileMemory {
 public:
  static constexpr hal::MemoryLayout kLayout{
      .page_bytes = 256, .pages_per_sector = 8, .sectors = 10};
  // Where the store puts its first record, and its second one.
  static constexpr std::size_t kFirstRecord = 4 * kLayout.sector_bytes();
  static constexpr std::size_t kSecondRecord = kLayout.sector_bytes();

  explicit RamMemory(const hal::MemoryLayout& layout = kLayout)
      : bytes(layout.bytes(), hal::kErasedByte), layout_(layout) {}

  std::vector<std::uint8_t> bytes;
  // Bytes that may still be changed before the power goes; what is under way then stops there.
  std::optional<std::size_t> bytes_left;
  std::size_t changed = 0;
  std::size_t stored = 0;  // the same, but for the last sector: there a controller keeps its rest
  std::optional<Error> refusal;  // of every change
  // Reads that still succeed.
  std::optional<std::size_t> reads_left;
  std::optional<std::size_t> unreadable_sector;

 private:
  [[nodiscard]] hal::MemoryLayout do_layout() const override { return layout_; }
  Result<void> do_read(std::size_t address, std::span<std::uint8_t> into) override {
    if (reads_left && *reads_left == 0) return std::unexpected(Error::kStorageFault);
    if (reads_left) --*reads_left;
    if (unreadable_sector == address / layout_.sector_bytes()) {
      return std::unexpected(Error::kStorageFault);
    }
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(address), into.size(), into.begin());
    return {};
  }
  Result<void> change(std::size_t at, std::uint8_t value) {
    if (refusal) return std::unexpected(*refusal);
    if (bytes_left && *bytes_left == 0) return std::unexpected(Error::kStorageFault);
    if (bytes_left) --*bytes_left;
    bytes[at] = value;
    ++changed;
    if (at < (layout_.sectors - 1) * layout_.sector_bytes()) ++stored;
    return {};
  }
  Result<void> do_erase_sector(std::size_t sector) override {
    const std::size_t first = sector * layout_.sector_bytes();
    for (std::size_t i = 0; i < layout_.sector_bytes(); ++i) {
      if (auto done = change(first + i, hal::kErasedByte); !done) return done;
    }
    return {};
  }
  Result<void> do_program_page(std::size_t address, std::span<const std::uint8_t> page) override {
    for (std::size_t i = 0; i < page.size(); ++i) {
      if (bytes[address + i] != hal::kErasedByte) return std::unexpected(Error::kNotErased);
    }
    for (std::size_t i = 0; i < page.size(); ++i) {
      if (auto done = change(address + i, page[i]); !done) return done;
    }
    return {};
  }

  hal::MemoryLayout layout_;
};

}  // namespace armsig::test
