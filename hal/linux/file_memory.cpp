// SPDX-License-Identifier: MIT
#include "hal/linux/file_memory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>

namespace armsig::linux_hal {
namespace {

constexpr std::size_t kCachePageBytes = 4096;

Error storage_error(int number) {
  return number == ENOSPC || number == EDQUOT ? Error::kStorageFull : Error::kStorageFault;
}

std::unexpected<Error> last_error() { return std::unexpected(storage_error(errno)); }

Result<void> write_all(int file, std::span<const std::uint8_t> bytes, std::size_t address) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(address));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return last_error();
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    address += static_cast<std::size_t>(count);
  }
  return {};
}

Result<void> write_erased(int file, std::size_t address, std::size_t count) {
  std::array<std::uint8_t, kCachePageBytes> erased{};
  erased.fill(hal::kErasedByte);
  while (count > 0) {
    const std::size_t portion = std::min(count, erased.size());
    if (auto written = write_all(file, std::span(erased).first(portion), address); !written) {
      return written;
    }
    address += portion;
    count -= portion;
  }
  return {};
}

Result<void> sync(int file) {
  if (::fdatasync(file) != 0) return last_error();
  return {};
}

// Makes the file under another name and renames it when it is whole and on the device.
Result<void> create(const std::string& path, std::size_t size) {
  const std::string unfinished = path + ".new";
  const auto make = [&]() -> Result<void> {
    const FileDescriptor file(
        ::open(unfinished.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0640));
    if (!file.valid()) return last_error();
    if (auto written = write_erased(file.get(), 0, size); !written) return written;
    if (auto synced = sync(file.get()); !synced) return synced;
    // Fails if somebody else has made the file meanwhile, rather than replacing theirs.
    if (::link(unfinished.c_str(), path.c_str()) != 0 && errno != EEXIST) return last_error();
    return {};
  };
  const auto made = make();
  ::unlink(unfinished.c_str());
  if (!made) return made;
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  const FileDescriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!directory.valid() || ::fsync(directory.get()) != 0) return last_error();
  return {};
}

}  // namespace

Result<FileMemory> FileMemory::open(const std::string& path, const hal::MemoryLayout& layout) {
  if (layout.bytes() == 0 || kCachePageBytes % layout.page_bytes != 0) {
    return std::unexpected(Error::kAddressOutOfRange);
  }
  FileDescriptor file(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (!file.valid() && errno == ENOENT) {
    if (auto created = create(path, layout.bytes()); !created) {
      return std::unexpected(created.error());
    }
    file = FileDescriptor(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  }
  struct stat status{};
  if (!file.valid() || ::fstat(file.get(), &status) != 0) return last_error();
  if (static_cast<std::size_t>(status.st_size) != layout.bytes()) {
    return std::unexpected(Error::kStorageFault);
  }
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) return std::unexpected(Error::kSystemRefused);
  return FileMemory(std::move(file), layout);
}

Result<void> FileMemory::do_read(std::size_t address, std::span<std::uint8_t> into) {
  while (!into.empty()) {
    const ssize_t count =
        ::pread(file_.get(), into.data(), into.size(), static_cast<off_t>(address));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return std::unexpected(Error::kStorageFault);
    into = into.subspan(static_cast<std::size_t>(count));
    address += static_cast<std::size_t>(count);
  }
  return {};
}

Result<void> FileMemory::do_erase_sector(std::size_t sector) {
  const std::size_t bytes = layout_.sector_bytes();
  if (auto erased = write_erased(file_.get(), sector * bytes, bytes); !erased) return erased;
  return sync(file_.get());
}

Result<void> FileMemory::do_program_page(std::size_t address, std::span<const std::uint8_t> page) {
  std::array<std::uint8_t, kCachePageBytes> present{};
  const auto old = std::span(present).first(page.size());
  if (auto read = do_read(address, old); !read) return read;
  if (!std::ranges::all_of(old, [](std::uint8_t byte) { return byte == hal::kErasedByte; })) {
    return std::unexpected(Error::kNotErased);
  }
  if (auto written = write_all(file_.get(), page, address); !written) return written;
  return sync(file_.get());
}

}  // namespace armsig::linux_hal
