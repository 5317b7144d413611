// SPDX-License-Identifier: MIT
// Non-volatile memory in a file.
#pragma once

#include <string>

#include "hal/linux/file_descriptor.hpp"
#include "hal/nonvolatile_memory.hpp"

namespace armsig::linux_hal {

// How sectors are laid out in the file. A card or stick with flash in it erases blocks of up to
// some megabytes whatever it is told, and may lose all of one when the power goes: what must not be
// lost together lies further apart than that. In one file, as its blocks follow each other on the
// device when it is allocated at once, and two files may lie side by side.
struct FileSpread {
  std::size_t sectors = 0;       // that lie together; 0: all of them
  std::size_t stride_bytes = 0;  // from the beginning of one such group to that of the next
};

// Pages are written in place and reach the device before program_page() returns. A page lies within
// one page of the kernel's cache, so that a process that is killed leaves it either old or new. The
// whole file is allocated when it is made, so that a full disk is met then and not while a
// signature is stored. A change is refused when the file is not at its path any more, for nobody
// would find it there after a restart.
//
// What is read is what is on the device: after a write that failed the kernel's cache may hold what
// the device does not, and says so to nobody (Rebello et al., Can Applications Recover from fsync
// Failures?, USENIX ATC 2020). So reading goes past the cache (O_DIRECT), which first writes what
// the cache still owes, or fails; where the file system has no such way, the cache is made to
// forget what it says it has written.
class FileMemory final : public hal::NonvolatileMemory {
 public:
  // Opens the file at `path`, or makes it, erased, if there is none; a file is never half made, and
  // of two that are made at once one is used by both. The file is locked against a second process.
  // Errors: kAddressOutOfRange (a layout that is empty, pages or a stride that do not suit 4096
  // bytes), kStorageFull, kStorageFault (also: not a regular file), kStorageLayout (a file of
  // another size), kStorageReplaced (it was replaced meanwhile), kSystemRefused (in use elsewhere).
  // Changes answer kStorageReplaced as well.
  [[nodiscard]] static Result<FileMemory> open(const std::string& path,
                                               const hal::MemoryLayout& layout,
                                               const FileSpread& spread = {});

 private:
  FileMemory(FileDescriptor file, std::string path, const hal::MemoryLayout& layout,
             const FileSpread& spread);

  [[nodiscard]] Result<void> reach_device() const;
  [[nodiscard]] Result<void> read_device(std::size_t place, std::span<std::uint8_t> into) const;
  // Errors: kStorageReplaced.
  [[nodiscard]] Result<void> check_place() const;

  [[nodiscard]] hal::MemoryLayout do_layout() const override { return layout_; }
  Result<void> do_read(std::size_t address, std::span<std::uint8_t> into) override;
  Result<void> do_erase_sector(std::size_t sector) override;
  Result<void> do_program_page(std::size_t address, std::span<const std::uint8_t> page) override;

  FileDescriptor file_;
  FileDescriptor past_cache_;  // the same file for reading; none where the file system can't
  std::string path_;
  hal::MemoryLayout layout_;
  FileSpread spread_;
};

}  // namespace armsig::linux_hal
