// SPDX-License-Identifier: MIT
// Non-volatile memory in a file.
#pragma once

#include <string>

#include "hal/linux/file_descriptor.hpp"
#include "hal/nonvolatile_memory.hpp"

namespace armsig::linux_hal {

// Pages are written in place and reach the device before program_page() returns. A page lies within
// one page of the kernel's cache, so that a process that is killed leaves it either old or new. The
// whole file is allocated when it is made, so that a full disk is met then and not while a
// signature is stored.
class FileMemory final : public hal::NonvolatileMemory {
 public:
  // Opens the file at `path`, or makes it, erased, if there is none; a file is never half made. The
  // file is locked against a second process.
  // Errors: kAddressOutOfRange (a layout that is empty, or pages that do not divide 4096 bytes),
  // kStorageFull, kStorageFault (also: a file of another size), kSystemRefused (in use elsewhere).
  [[nodiscard]] static Result<FileMemory> open(const std::string& path,
                                               const hal::MemoryLayout& layout);

 private:
  FileMemory(FileDescriptor file, const hal::MemoryLayout& layout)
      : file_(std::move(file)), layout_(layout) {}

  [[nodiscard]] hal::MemoryLayout do_layout() const override { return layout_; }
  Result<void> do_read(std::size_t address, std::span<std::uint8_t> into) override;
  Result<void> do_erase_sector(std::size_t sector) override;
  Result<void> do_program_page(std::size_t address, std::span<const std::uint8_t> page) override;

  FileDescriptor file_;
  hal::MemoryLayout layout_;
};

}  // namespace armsig::linux_hal
