// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/console_client.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace armsig::tool {
namespace {

using linux_hal::FileDescriptor;

constexpr std::size_t kLongestBacklog = std::size_t{1} << 20U;

std::unexpected<Problem> refused(const std::string& path, int number) {
  return std::unexpected(Problem{path, 0, 0, std::strerror(number), "the console of a controller"});
}

FileDescriptor open_serial(const std::string& path) {
  FileDescriptor line(::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (!line.valid() || ::tcgetattr(line.get(), &settings) != 0) return {};
  ::cfmakeraw(&settings);
  ::cfsetspeed(&settings, B115200);
  settings.c_cflag |= CLOCAL | CREAD;
  if (::tcsetattr(line.get(), TCSANOW, &settings) != 0) return {};
  return line;
}

FileDescriptor open_socket(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return {};
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  if (!socket.valid() || ::connect(socket.get(), generic, sizeof address) != 0) return {};
  return socket;
}

}  // namespace

Read<ConsoleClient> ConsoleClient::open(const std::string& path) {
  struct stat status{};
  if (::stat(path.c_str(), &status) != 0) return refused(path, errno);
  errno = 0;
  FileDescriptor connection = S_ISCHR(status.st_mode) ? open_serial(path) : open_socket(path);
  if (!connection.valid()) return refused(path, errno);
  return ConsoleClient(std::move(connection));
}

bool ConsoleClient::send(std::string_view line) {
  std::string rest(line);
  rest += '\n';
  while (!rest.empty() && !gone_) {
    // A serial line is no socket, and a socket whose other end is closed must not kill us.
    ssize_t count = ::send(connection_.get(), rest.data(), rest.size(), MSG_NOSIGNAL);
    if (count < 0 && errno == ENOTSOCK) {
      count = ::write(connection_.get(), rest.data(), rest.size());
    }
    if (count < 0 && errno != EINTR) gone_ = true;
    if (count > 0) rest.erase(0, static_cast<std::size_t>(count));
  }
  return !gone_;
}

std::optional<std::string> ConsoleClient::take_line() {
  const std::size_t end = received_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  std::string line = received_.substr(0, end);
  received_.erase(0, end + 1);
  if (line.ends_with('\r')) line.pop_back();
  return line;
}

std::optional<std::string> ConsoleClient::receive(std::chrono::milliseconds longest) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + longest;
  for (;;) {
    if (auto line = take_line()) return line;
    if (gone_) return std::nullopt;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
    pollfd ready{.fd = connection_.get(), .events = POLLIN, .revents = 0};
    const int wait = static_cast<int>(std::max<std::chrono::milliseconds::rep>(left.count(), 0));
    const int polled = ::poll(&ready, 1, wait);
    if (polled == 0) return std::nullopt;
    if (polled < 0) continue;  // interrupted
    std::array<char, 4096> buffer{};
    const ssize_t count = ::read(connection_.get(), buffer.data(), buffer.size());
    if (count > 0) {
      received_.append(buffer.data(), static_cast<std::size_t>(count));
      if (received_.size() > kLongestBacklog) gone_ = true;  // no console of ours
    } else if (count == 0 || errno != EINTR) {
      gone_ = true;
    }
  }
}

bool is_error(std::string_view line) { return line == "error" || line.starts_with("error "); }

bool is_reply(std::string_view line) {
  return is_error(line) || line == "ok" || line.starts_with("ok ");
}

}  // namespace armsig::tool
