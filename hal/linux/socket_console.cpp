// SPDX-License-Identifier: MIT
#include "hal/linux/socket_console.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <tuple>

namespace armsig::linux_hal {
namespace {

// Of those who come between two looks; beyond it a client that does not block is refused.
constexpr int kBacklog = 64;
constexpr mode_t kMaskFor0660 = 0117;

bool is_text(char c) { return c == '\t' || (c >= 0x20 && c < 0x7F); }

FileDescriptor stream_socket() {
  return FileDescriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

// Removes a socket file that no process listens at. False if something else is there.
bool clear_path(const sockaddr_un& address) {
  struct stat status{};
  if (::lstat(address.sun_path, &status) != 0) return errno == ENOENT;
  if (!S_ISSOCK(status.st_mode)) return false;
  const FileDescriptor probe = stream_socket();
  const bool connected =
      ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  if (connected || errno != ECONNREFUSED) return false;
  return ::unlink(address.sun_path) == 0;
}

}  // namespace

Result<std::unique_ptr<SocketConsole>> SocketConsole::open(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) {
    return std::unexpected(Error::kAddressOutOfRange);
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  FileDescriptor listener = stream_socket();
  if (!listener.valid() || !clear_path(address)) return std::unexpected(Error::kSystemRefused);
  const mode_t former = ::umask(kMaskFor0660);
  const int bound =
      ::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
  ::umask(former);
  if (bound != 0) return std::unexpected(Error::kSystemRefused);
  if (::listen(listener.get(), kBacklog) != 0) {
    ::unlink(address.sun_path);
    return std::unexpected(Error::kSystemRefused);
  }
  return std::unique_ptr<SocketConsole>(new SocketConsole(std::move(listener), path));
}

SocketConsole::~SocketConsole() { ::unlink(path_.c_str()); }

// A free place, or that of the client least missed: rather one whose requests are all answered, of
// those rather one that never said a line, of those the one that has been quiet for longest. So a
// flood of connections competes with itself for one place.
SocketConsole::Client& SocketConsole::place_for_another() {
  const auto worth = [](const Client& client) {
    const bool asks = client.unanswered > 0 ||
                      std::string_view(client.input.data(), client.input_size).contains('\n');
    return std::tuple(client.socket.valid(), asks, client.spoke_at, client.name);
  };
  return *std::ranges::min_element(
      clients_, [&](const Client& a, const Client& b) { return worth(a) < worth(b); });
}

void SocketConsole::accept_one() {
  FileDescriptor socket(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!socket.valid()) return;
  Client& client = place_for_another();
  if (client.socket.valid()) {
    constexpr std::string_view kEnd = "# disconnected: every place is taken, and another came\n";
    (void)::send(client.socket.get(), kEnd.data(), kEnd.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }
  client.socket = std::move(socket);
  client.name = next_name_++;
  client.input_size = client.output_size = 0;
  client.discarding = client.ended = client.deaf = false;
  client.unanswered = 0;
  client.spoke_at = 0;
}

void SocketConsole::flush(Client& client) {
  if (client.output_size == 0) return;
  const ssize_t count = ::send(client.socket.get(), client.output.data(), client.output_size,
                               MSG_NOSIGNAL | MSG_DONTWAIT);
  if (count < 0) {
    if (errno != EAGAIN && errno != EINTR) {
      client.deaf = true;
      client.output_size = 0;
    }
    return;
  }
  const auto sent = static_cast<std::size_t>(count);
  std::memmove(client.output.data(), client.output.data() + sent, client.output_size - sent);
  client.output_size -= sent;
}

bool SocketConsole::queue(Client& client, std::string_view text) {
  if (client.deaf || text.size() + 1 > client.output.size() - client.output_size) return false;
  std::ranges::copy(text, client.output.data() + client.output_size);
  client.output_size += text.size();
  client.output[client.output_size++] = '\n';
  flush(client);
  return !client.deaf;
}

void SocketConsole::receive(Client& client) {
  const std::size_t room = client.input.size() - client.input_size;
  if (room == 0 || client.ended) return;
  const ssize_t count =
      ::recv(client.socket.get(), client.input.data() + client.input_size, room, MSG_DONTWAIT);
  if (count > 0) {
    client.input_size += static_cast<std::size_t>(count);
  } else if (count == 0 || (errno != EAGAIN && errno != EINTR)) {
    client.ended = true;
  }
}

void SocketConsole::close_if_done(Client& client) {
  if (client.ended && client.unanswered == 0 && client.output_size == 0) client.socket.reset();
}

// The first line in the client's buffer, if it holds a whole one, or as much as a line may have.
std::optional<hal::ConsoleLine> SocketConsole::extract(Client& client) {
  const std::string_view input(client.input.data(), client.input_size);
  const std::size_t end = input.find('\n');
  const bool whole = end != std::string_view::npos;
  if (!whole && client.input_size < client.input.size()) return std::nullopt;
  hal::ConsoleLine line{.client = client.name, .characters = {}, .error = {}};
  std::string_view text = input.substr(0, whole ? end : input.size());
  const std::size_t used = whole ? end + 1 : input.size();
  const bool tail = client.discarding;
  if (!whole) line.error = Error::kLineTooLong;
  client.discarding = !whole;
  if (whole && text.ends_with('\r')) text.remove_suffix(1);
  if (!std::ranges::all_of(text, is_text) && !line.error) line.error = Error::kNotText;
  if (!line.error) {
    for (const char c : text) line.characters.push_back(c);
  }
  std::memmove(client.input.data(), client.input.data() + used, client.input_size - used);
  client.input_size -= used;
  // The rest of a line that was refused already.
  if (tail) return std::nullopt;
  return line;
}

std::optional<hal::ConsoleLine> SocketConsole::do_read_line() {
  // Everybody is listened to before anybody may lose a place.
  for (Client& client : clients_) {
    if (!client.socket.valid()) continue;
    flush(client);
    receive(client);
  }
  accept_one();
  for (std::size_t i = 0; i < clients_.size(); ++i) {
    Client& client = clients_[(turn_ + i) % clients_.size()];
    if (!client.socket.valid()) continue;
    if (client.spoke_at == 0) receive(client);
    if (auto line = extract(client)) {
      ++client.unanswered;
      client.spoke_at = ++lines_;
      turn_ = (turn_ + i + 1) % clients_.size();
      return line;
    }
    close_if_done(client);
  }
  return std::nullopt;
}

Result<void> SocketConsole::do_write_line(hal::ConsoleClient name, std::string_view text) {
  for (Client& client : clients_) {
    if (!client.socket.valid() || client.name != name) continue;
    if (client.unanswered > 0) --client.unanswered;
    if (queue(client, text)) return {};
    if (!client.deaf) client.socket.reset();
  }
  return std::unexpected(Error::kConsoleGone);
}

void SocketConsole::do_broadcast(std::string_view text) {
  for (Client& client : clients_) {
    if (client.socket.valid()) (void)queue(client, text);
  }
}

}  // namespace armsig::linux_hal
