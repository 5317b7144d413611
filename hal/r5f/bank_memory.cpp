// SPDX-License-Identifier: MIT
#include "hal/r5f/bank_memory.hpp"

#include <algorithm>

namespace armsig::r5f {

BankMemory::BankMemory(Bank& bank) : bank_(bank) {
  constexpr std::uint32_t kMarker = 0x4D42'5341;
  if (bank.marker == kMarker) return;
  bank.bytes.fill(hal::kErasedByte);
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
