// SPDX-License-Identifier: MIT
#include "firmware/fleet/journal/file_storage.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace armsig::fleet {
namespace {

Error error_of(int number) { return number == ENOSPC ? Error::kStorageFull : Error::kStorageFault; }

}  // namespace

Result<FileStorage> FileStorage::open(const std::string& path, std::uint64_t bytes) {
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0640);
  if (file < 0) return std::unexpected(error_of(errno));
  FileStorage storage(file);
  if (::flock(file, LOCK_EX | LOCK_NB) != 0) return std::unexpected(Error::kStorageFault);
  const int number = ::posix_fallocate(file, 0, static_cast<off_t>(bytes));
  if (number != 0) return std::unexpected(error_of(number));
  return storage;
}

FileStorage::~FileStorage() {
  if (file_ >= 0) ::close(file_);
}

Result<void> FileStorage::do_read(std::uint64_t at, std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::pread(file_, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::unexpected(error_of(errno));
    if (count == 0) break;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    at += static_cast<std::uint64_t>(count);
  }
  std::ranges::fill(bytes, std::byte{0});
  return {};
}

Result<void> FileStorage::do_write(std::uint64_t at, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return std::unexpected(error_of(errno));
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    at += static_cast<std::uint64_t>(count);
  }
  return {};
}

Result<void> FileStorage::do_sync() {
  while (::fdatasync(file_) != 0) {
    if (errno != EINTR) return std::unexpected(error_of(errno));
  }
  return {};
}

}  // namespace armsig::fleet
