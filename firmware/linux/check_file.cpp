// SPDX-License-Identifier: MIT
#include "firmware/linux/check_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <span>

#include "firmware/controller/check_image.hpp"
#include "hal/linux/file_descriptor.hpp"

namespace armsig::daemon {
namespace {

using linux_hal::FileDescriptor;

std::unexpected<Error> not_kept() {
  return std::unexpected(errno == ENOSPC || errno == EDQUOT ? Error::kStorageFull
                                                            : Error::kStorageFault);
}

bool write_whole(int file, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

bool reaches_device(int file) {
  while (::fsync(file) != 0) {
    if (errno != EINTR) return false;
  }
  return true;
}

// As much of `into` as there is; negative where the device fails.
ssize_t read_whole(int file, std::span<std::uint8_t> into) {
  std::size_t done = 0;
  while (done < into.size()) {
    const ssize_t count = ::read(file, into.data() + done, into.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return count;
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  return static_cast<ssize_t>(done);
}

}  // namespace

CheckFile::CheckFile(std::string_view store)
    : path_(std::string(store) + ".checks"), unfinished_(path_ + ".new") {
  const std::size_t slash = path_.rfind('/');
  folder_ = slash == std::string::npos ? "." : path_.substr(0, slash + 1);
}

Result<controller::Recalled> CheckFile::do_read(const controller::CheckSubject& subject,
                                                controller::CheckState& state) {
  // A pipe of that name is not to be waited for.
  const FileDescriptor file(::open(path_.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (!file.valid() && errno == ENOENT) return controller::Recalled::kNothing;
  std::array<std::uint8_t, controller::kCheckImageBytes + 1> bytes{};
  const ssize_t count = file.valid() ? read_whole(file.get(), bytes) : -1;
  if (count < 0) return std::unexpected(Error::kStorageFault);
  if (count != controller::kCheckImageBytes) return std::unexpected(Error::kRecordCorrupt);
  controller::CheckImage image{};
  std::copy_n(bytes.begin(), image.size(), image.begin());
  return decode(image, subject, state);
}

Result<void> CheckFile::do_write(const controller::CheckSubject& subject,
                                 const controller::CheckState& state) {
  constexpr mode_t kOwnerAndGroup = 0640;
  const controller::CheckImage image = encode(subject, state);
  ::unlink(unfinished_.c_str());  // what a loss of power left
  {
    const FileDescriptor file(::open(
        unfinished_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kOwnerAndGroup));
    if (!file.valid() || !write_whole(file.get(), image) || !reaches_device(file.get())) {
      const auto why = not_kept();
      ::unlink(unfinished_.c_str());
      return why;
    }
  }
  if (::rename(unfinished_.c_str(), path_.c_str()) != 0) return not_kept();
  const FileDescriptor folder(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder.valid() || !reaches_device(folder.get())) return not_kept();
  return {};
}

}  // namespace armsig::daemon
