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

// A signal says nothing of the device.
Result<void> sync(int file) {
  while (::fdatasync(file) != 0) {
    if (errno != EINTR) return last_error();
  }
  return {};
}

// Sectors that lie together, and where in the file they begin.
struct Groups {
  std::size_t bytes = 0;
  std::size_t stride = 0;
  std::size_t count = 0;
  std::size_t last_bytes = 0;

  Groups(const hal::MemoryLayout& layout, const FileSpread& spread)
      : bytes((spread.sectors == 0 ? layout.sectors : spread.sectors) * layout.sector_bytes()),
        stride(spread.sectors == 0 ? bytes : spread.stride_bytes),
        count((layout.bytes() + bytes - 1) / bytes),
        last_bytes(layout.bytes() - (count - 1) * bytes) {}

  [[nodiscard]] std::size_t file_bytes() const { return (count - 1) * stride + last_bytes; }
  [[nodiscard]] std::size_t place(std::size_t address) const {
    return address / bytes * stride + address % bytes;
  }
};

bool suits(const hal::MemoryLayout& layout, const FileSpread& spread) {
  if (layout.bytes() == 0 || kCachePageBytes % layout.page_bytes != 0) return false;
  if (spread.sectors == 0) return true;
  return spread.stride_bytes % kCachePageBytes == 0 &&
         spread.stride_bytes >= spread.sectors * layout.sector_bytes();
}

Result<void> sync_folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  const FileDescriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!directory.valid()) return last_error();
  return sync(directory.get());
}

Result<void> fill(int file, const Groups& groups) {
  const int refused = ::posix_fallocate(file, 0, static_cast<off_t>(groups.file_bytes()));
  if (refused != 0) return std::unexpected(storage_error(refused));
  for (std::size_t i = 0; i < groups.count; ++i) {
    const std::size_t bytes = i + 1 < groups.count ? groups.bytes : groups.last_bytes;
    if (auto written = write_erased(file, i * groups.stride, bytes); !written) return written;
  }
  constexpr mode_t kOwnerAndGroup = 0640;
  if (::fchmod(file, kOwnerAndGroup) != 0) return last_error();
  return sync(file);
}

// Makes the file under a name of its own, that nobody else has or can guess, and links it to its
// path when it is whole and on the device.
Result<void> create(const std::string& path, const Groups& groups) {
  std::string unfinished = path + ".XXXXXX";
  const FileDescriptor file(::mkostemp(unfinished.data(), O_CLOEXEC));
  if (!file.valid()) return last_error();
  auto made = fill(file.get(), groups);
  // Fails if somebody else has made the file meanwhile, rather than replacing theirs.
  if (made && ::link(unfinished.c_str(), path.c_str()) != 0 && errno != EEXIST) {
    made = last_error();
  }
  ::unlink(unfinished.c_str());
  if (!made) return made;
  return sync_folder_of(path);
}

}  // namespace

Result<FileMemory> FileMemory::open(const std::string& path, const hal::MemoryLayout& layout,
                                    const FileSpread& spread) {
  if (!suits(layout, spread)) return std::unexpected(Error::kAddressOutOfRange);
  const Groups groups(layout, spread);
  FileDescriptor file(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (!file.valid() && errno == ENOENT) {
    if (auto created = create(path, groups); !created) return std::unexpected(created.error());
    file = FileDescriptor(::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW));
  }
  struct stat status{};
  if (!file.valid() || ::fstat(file.get(), &status) != 0) return last_error();
  if (!S_ISREG(status.st_mode)) return std::unexpected(Error::kStorageFault);
  if (static_cast<std::size_t>(status.st_size) != groups.file_bytes()) {
    return std::unexpected(Error::kStorageLayout);
  }
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) return std::unexpected(Error::kSystemRefused);
  FileMemory memory(std::move(file), path, layout, spread);
  if (auto there = memory.check_place(); !there) return std::unexpected(there.error());
  return memory;
}

FileMemory::FileMemory(FileDescriptor file, std::string path, const hal::MemoryLayout& layout,
                       const FileSpread& spread)
    : file_(std::move(file)), path_(std::move(path)), layout_(layout), spread_(spread) {
  // By the descriptor: the path may be another file's by now.
  std::array<char, 32> itself{};
  (void)std::snprintf(itself.data(), itself.size(), "/proc/self/fd/%d", file_.get());
  past_cache_ = FileDescriptor(::open(itself.data(), O_RDONLY | O_DIRECT | O_CLOEXEC));
}

Result<void> FileMemory::check_place() const {
  struct stat open{};
  struct stat named{};
  if (::fstat(file_.get(), &open) != 0) return last_error();
  const bool found = ::stat(path_.c_str(), &named) == 0;
  if (!found || open.st_dev != named.st_dev || open.st_ino != named.st_ino) {
    return std::unexpected(Error::kStorageReplaced);
  }
  return {};
}

Result<void> FileMemory::reach_device() const {
  if (auto synced = sync(file_.get()); !synced) return synced;
  return check_place();
}

// By whole pages of the cache, which suit every device.
Result<void> FileMemory::read_device(std::size_t place, std::span<std::uint8_t> into) const {
  alignas(kCachePageBytes) std::array<std::uint8_t, kCachePageBytes> page;
  while (!into.empty()) {
    const std::size_t within = place % kCachePageBytes;
    const std::size_t portion = std::min(into.size(), kCachePageBytes - within);
    const ssize_t count = ::pread(past_cache_.valid() ? past_cache_.get() : file_.get(),
                                  page.data(), page.size(), static_cast<off_t>(place - within));
    if (count < 0 && errno == EINTR) continue;
    // The last page of the file may be short.
    if (count < 0 || static_cast<std::size_t>(count) < within + portion) {
      return std::unexpected(Error::kStorageFault);
    }
    std::ranges::copy(std::span(page).subspan(within, portion), into.begin());
    into = into.subspan(portion);
    place += portion;
  }
  return {};
}

Result<void> FileMemory::do_read(std::size_t address, std::span<std::uint8_t> into) {
  if (!past_cache_.valid()) {
    if (auto synced = sync(file_.get()); !synced) return std::unexpected(Error::kStorageFault);
    (void)::posix_fadvise(file_.get(), 0, 0, POSIX_FADV_DONTNEED);
  }
  const Groups groups(layout_, spread_);
  while (!into.empty()) {
    const std::size_t portion = std::min(into.size(), groups.bytes - address % groups.bytes);
    if (auto read = read_device(groups.place(address), into.first(portion)); !read) return read;
    into = into.subspan(portion);
    address += portion;
  }
  return {};
}

Result<void> FileMemory::do_erase_sector(std::size_t sector) {
  const std::size_t bytes = layout_.sector_bytes();
  const std::size_t at = Groups(layout_, spread_).place(sector * bytes);
  if (auto erased = write_erased(file_.get(), at, bytes); !erased) return erased;
  return reach_device();
}

Result<void> FileMemory::do_program_page(std::size_t address, std::span<const std::uint8_t> page) {
  std::array<std::uint8_t, kCachePageBytes> present{};
  const auto old = std::span(present).first(page.size());
  if (auto read = do_read(address, old); !read) return read;
  if (!std::ranges::all_of(old, [](std::uint8_t byte) { return byte == hal::kErasedByte; })) {
    return std::unexpected(Error::kNotErased);
  }
  const std::size_t at = Groups(layout_, spread_).place(address);
  if (auto written = write_all(file_.get(), page, at); !written) return written;
  return reach_device();
}

}  // namespace armsig::linux_hal
