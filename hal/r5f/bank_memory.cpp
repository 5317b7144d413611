// SPDX-License-Identifier: MIT
#include "hal/r5f/bank_memory.hpp"

#include <algorithm>

namespace armsig::r5f {

namespace {

// Every byte of it written before any is read: memory with error correction that was not written
// since its power came reads as an error, and a part of one of its words can't be written either.
void erase_whole(BankMemory::Bank& bank) {
  auto* const words = reinterpret_cast<volatile std::uint64_t*>(&bank);
  for (std::size_t i = 0; i < sizeof bank / sizeof *words; ++i) words[i] = ~std::uint64_t{0};
}

}  // namespace

BankMemory::BankMemory(Bank& bank, bool lost_power) : bank_(bank) {
  // Another one for every layout.
  constexpr std::uint64_t kMarker = 0x4D42'5342;
  if (!lost_power && bank.marker == kMarker) return;
  erase_whole(bank);
  bank.marker = kMarker;
}

Result<void> BankMemory::do_read(std::size_t address, std::span<std::uint8_t> into) {
  std::ranges::copy(std::span(bank_.bytes).subspan(address, into.size()), into.begin());
  return {};
}

Result<void> BankMemory::do_erase_sector(std::size_t sector) {
  std::ranges::fill(
      std::span(bank_.bytes).subspan(sector * kLayout.sector_bytes(), kLayout.sector_bytes()),
      hal::kErasedByte);
  return {};
}

Result<void> BankMemory::do_program_page(std::size_t address, std::span<const std::uint8_t> page) {
  const std::span<std::uint8_t> into = std::span(bank_.bytes).subspan(address, page.size());
  if (!std::ranges::all_of(into, [](std::uint8_t byte) { return byte == hal::kErasedByte; })) {
    return std::unexpected(Error::kNotErased);
  }
  std::ranges::copy(page, into.begin());
  return {};
}

}  // namespace armsig::r5f
