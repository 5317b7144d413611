// SPDX-License-Identifier: MIT
#include "firmware/formats/text_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <system_error>
#include <utility>

#include <climits>
#include <fmt/format.h>

#include "firmware/formats/standard_output.hpp"
#include "firmware/formats/terminal_line.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kWriteBuffer = std::size_t{64} << 10U;

std::unexpected<Problem> system_problem(const std::string& path, std::string_view what, int error) {
  return std::unexpected(
      Problem{path, 0, 0, std::string(what) + ": " + std::generic_category().message(error), ""});
}

std::string directory_of(const std::string& path) {
  const std::string directory = std::filesystem::path(path).parent_path().string();
  return directory.empty() ? "." : directory;
}

// What the symbolic links from `path` on end in, be it there or not; as many as the system follows.
std::string end_of_links(std::string path) {
  constexpr int kMostLinks = 40;
  for (int k = 0; k < kMostLinks; ++k) {
    std::error_code no_link;
    const std::filesystem::path next = std::filesystem::read_symlink(path, no_link);
    if (no_link) break;
    path = (std::filesystem::path(path).parent_path() / next).string();
  }
  return path;
}

// The temporary files there are now, for the handler of signals: fixed places, since a handler may
// not allocate. A file beyond them is only left behind by a signal.
struct Temporary {
  std::atomic<bool> used = false;
  std::array<char, PATH_MAX> path{};
};
std::array<Temporary, 4> temporaries;

void remember(const std::string& path) {
  for (Temporary& temporary : temporaries) {
    if (temporary.used || path.size() >= temporary.path.size()) continue;
    path.copy(temporary.path.data(), path.size());
    temporary.path[path.size()] = '\0';
    temporary.used = true;
    return;
  }
}

void forget(const std::string& path) {
  for (Temporary& temporary : temporaries) {
    if (temporary.used && path == temporary.path.data()) temporary.used = false;
  }
}

extern "C" void remove_temporaries(int signal) {
  for (const Temporary& temporary : temporaries) {
    if (temporary.used) ::unlink(temporary.path.data());
  }
  // SA_RESETHAND has put the default back: this ends the process as the signal would have.
  (void)::raise(signal);
}

// A name in the same directory that nobody uses; its file, or -1 with errno set.
int open_temporary(const std::string& path, mode_t mode, std::string& temporary_path) {
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    temporary_path = path + ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(i);
    // Open before it is remembered: the handler must not remove a file that is not ours.
    sigset_t all;
    sigset_t former;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, &former);
    const int descriptor =
        ::open(temporary_path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    const int error = errno;
    if (descriptor >= 0) remember(temporary_path);
    ::pthread_sigmask(SIG_SETMASK, &former, nullptr);
    errno = error;
    if (descriptor >= 0 || error != EEXIST) return descriptor;
  }
  return -1;
}

}  // namespace

Read<FileHandle> open_file(const std::string& path) {
  FileHandle file(std::fopen(path.c_str(), "rbe"));
  if (!file) {
    auto problem = system_problem(path, "can't be opened", errno);
    if (path == "-") problem.error().expected = "the name of a file; /dev/stdin is standard input";
    return problem;
  }
  struct stat status{};
  if (::fstat(::fileno(file.get()), &status) == 0 && S_ISDIR(status.st_mode)) {
    return system_problem(path, "can't be read", EISDIR);
  }
  return file;
}

Read<std::string> read_text_file(const std::string& path, std::size_t largest) {
  auto file = open_file(path);
  if (!file) return std::unexpected(std::move(file).error());
  std::string text;
  std::array<char, 16384> piece{};
  while (const std::size_t count = std::fread(piece.data(), 1, piece.size(), file->get())) {
    text.append(piece.data(), count);
    if (text.size() > largest) {
      return std::unexpected(Problem{path, 0, 0, "the file is too large",
                                     fmt::format("at most {} KiB", largest >> 10U)});
    }
  }
  if (std::ferror(file->get()) != 0) return system_problem(path, "can't be read", errno);
  return text;
}

void remove_temporaries_on_signals() {
  struct sigaction action{};
  action.sa_handler = remove_temporaries;
  action.sa_flags = SA_RESETHAND;
  ::sigemptyset(&action.sa_mask);
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU, SIGXFSZ}) {
    struct sigaction former{};
    if (::sigaction(signal, nullptr, &former) != 0 || former.sa_handler != SIG_DFL) continue;
    ::sigaction(signal, &action, nullptr);
  }
}

Read<AtomicFile> AtomicFile::create(const std::string& path) {
  AtomicFile file;
  file.path_ = path;
  file.real_path_ = path;
  struct stat status{};
  const bool exists = path != kStandardOutput && ::stat(path.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) return system_problem(path, "can't be written", EISDIR);
  if (!exists && path != kStandardOutput) {
    if (errno == ELOOP) return system_problem(path, "can't be written", ELOOP);
    file.real_path_ = end_of_links(path);
  }
  if (path == kStandardOutput) {
    file.descriptor_ = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
  } else if (exists && !S_ISREG(status.st_mode)) {
    file.descriptor_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    constexpr mode_t kNewFile = 0666;  // less the umask
    constexpr mode_t kPermissions = 0777;
    if (exists) {
      std::error_code ignored;
      const auto real = std::filesystem::canonical(path, ignored);
      if (!ignored) file.real_path_ = real.string();
    }
    file.descriptor_ = open_temporary(file.real_path_, kNewFile, file.temporary_path_);
    if (file.descriptor_ >= 0 && exists) {
      // A file system without permissions refuses this, and needs none.
      (void)::fchmod(file.descriptor_, status.st_mode & kPermissions);
    }
  }
  if (file.descriptor_ < 0) {
    const int error = errno;
    file.temporary_path_.clear();
    return system_problem(path, "can't be written", error);
  }
  return file;
}

Read<void> check_writable(const std::string& path) {
  if (path == kStandardOutput) return {};
  struct stat status{};
  if (::stat(path.c_str(), &status) != 0) {
    if (errno == ELOOP) return system_problem(path, "can't be written", ELOOP);
    const std::string directory = directory_of(end_of_links(path));
    if (::stat(directory.c_str(), &status) != 0) {
      return system_problem(path, fmt::format("can't be written: {}", directory), errno);
    }
    return {};
  }
  if (S_ISDIR(status.st_mode)) return system_problem(path, "can't be written", EISDIR);
  return {};
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : path_(std::move(other.path_)),
      real_path_(std::move(other.real_path_)),
      temporary_path_(std::exchange(other.temporary_path_, {})),
      descriptor_(std::exchange(other.descriptor_, -1)),
      first_errno_(other.first_errno_),
      buffer_(std::move(other.buffer_)) {}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (temporary_path_.empty()) return;
  ::unlink(temporary_path_.c_str());
  forget(temporary_path_);
}

void AtomicFile::write(std::string_view text) {
  buffer_ += text;
  if (buffer_.size() >= kWriteBuffer) flush();
}

void AtomicFile::flush() {
  std::string_view rest = buffer_;
  // Not a regular file: it may be the terminal.
  if (temporary_path_.empty() && !rest.empty()) TerminalLine::of_this_process().clear();
  while (!rest.empty() && first_errno_ == 0) {
    const ssize_t count = ::write(descriptor_, rest.data(), rest.size());
    if (count > 0) {
      rest.remove_prefix(static_cast<std::size_t>(count));
    } else if (count < 0 && errno != EINTR) {
      first_errno_ = errno;
    }
  }
  buffer_.clear();
}

Read<void> AtomicFile::commit() {
  flush();
  const bool direct = temporary_path_.empty();
  while (!direct && first_errno_ == 0 && ::fsync(descriptor_) != 0) {
    if (errno != EINTR) first_errno_ = errno;
  }
  if (::close(std::exchange(descriptor_, -1)) != 0 && first_errno_ == 0) first_errno_ = errno;
  if (!direct && first_errno_ == 0 && ::rename(temporary_path_.c_str(), real_path_.c_str()) != 0) {
    first_errno_ = errno;
  }
  if (first_errno_ != 0) return system_problem(path_, "can't be written", first_errno_);
  if (direct) return {};
  forget(temporary_path_);
  temporary_path_.clear();
  // The rename itself must survive a power cut too; a directory that can't be opened is no reason
  // to disown a complete file.
  const int directory =
      ::open(directory_of(real_path_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory >= 0) {
    (void)::fsync(directory);
    ::close(directory);
  }
  return {};
}

Read<void> write_text_file(const std::string& path, std::string_view text) {
  auto file = AtomicFile::create(path);
  if (!file) return std::unexpected(std::move(file).error());
  file->write(text);
  return file->commit();
}

}  // namespace armsig::tool
