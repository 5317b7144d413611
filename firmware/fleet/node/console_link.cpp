// SPDX-License-Identifier: MIT
#include "firmware/fleet/node/console_link.hpp"

#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

namespace armsig::fleet {
namespace {

constexpr std::size_t kLongestBacklog = std::size_t{1} << 16U;

}  // namespace

bool ConsoleLink::open() {
  if (socket_.valid()) return true;
  received_.clear();
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path_.size() >= sizeof address.sun_path) return false;
  std::memcpy(address.sun_path, path_.c_str(), path_.size() + 1);
  linux_hal::FileDescriptor socket(
      ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  if (!socket.valid() || ::connect(socket.get(), generic, sizeof address) != 0) return false;
  socket_ = std::move(socket);
  return true;
}

void ConsoleLink::ask(Request request) {
  send(request == Request::kStatus ? "status\n" : "signature\n");
}

void ConsoleLink::ask_record(std::size_t part) {
  send("fetch what=signature part=" + std::to_string(part) + "\n");
}

void ConsoleLink::send(std::string_view line) {
  if (!socket_.valid()) return;
  const ssize_t count = ::send(socket_.get(), line.data(), line.size(), MSG_NOSIGNAL);
  if (count != static_cast<ssize_t>(line.size())) socket_.reset();
}

void ConsoleLink::receive() {
  std::array<char, 4096> buffer{};
  while (socket_.valid()) {
    const ssize_t count = ::recv(socket_.get(), buffer.data(), buffer.size(), 0);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) return;
    if (count <= 0 || received_.size() > kLongestBacklog) {
      socket_.reset();
      return;
    }
    received_.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

std::optional<std::string> ConsoleLink::take_line() {
  std::size_t end = received_.find('\n');
  if (end == std::string::npos) {
    receive();
    end = received_.find('\n');
  }
  if (end == std::string::npos) return std::nullopt;
  std::string line = received_.substr(0, end);
  received_.erase(0, end + 1);
  return line;
}

}  // namespace armsig::fleet
