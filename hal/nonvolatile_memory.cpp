// SPDX-License-Identifier: MIT
#include "hal/nonvolatile_memory.hpp"

namespace armsig::hal {

Result<void> NonvolatileMemory::read(std::size_t address, std::span<std::uint8_t> into) {
  const std::size_t bytes = layout().bytes();
  if (address > bytes || into.size() > bytes - address) {
    return std::unexpected(Error::kAddressOutOfRange);
  }
  return do_read(address, into);
}

Result<void> NonvolatileMemory::erase_sector(std::size_t sector) {
  if (sector >= layout().sectors) return std::unexpected(Error::kAddressOutOfRange);
  return do_erase_sector(sector);
}

Result<void> NonvolatileMemory::program_page(std::size_t address,
                                             std::span<const std::uint8_t> page) {
  const MemoryLayout memory = layout();
  if (page.size() != memory.page_bytes || address >= memory.bytes() ||
      address % memory.page_bytes != 0) {
    return std::unexpected(Error::kAddressOutOfRange);
  }
  return do_program_page(address, page);
}

}  // namespace armsig::hal
