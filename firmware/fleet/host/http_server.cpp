// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/http_server.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include <fmt/format.h>

namespace armsig::fleet {
namespace {

constexpr std::size_t kMostAsking = 64;
constexpr std::size_t kMostReading = 16;  // a reply may be as long as a table of all arms
constexpr int kAcceptedAtOnce = 64;
constexpr std::size_t kLongestRequest = 4096;
constexpr std::uint64_t kPatience_ms = 5'000;

bool is_same_name(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) {
    const auto lower = [](char c) {
      return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    };
    return lower(x) == lower(y);
  });
}

// The value of the one Host of a request, without its port; none: there is none, or more.
std::optional<std::string_view> host_of(std::string_view request) {
  std::optional<std::string_view> host;
  for (std::size_t at = request.find("\r\n"); at != std::string_view::npos;
       at = request.find("\r\n", at + 2)) {
    const std::string_view line = request.substr(at + 2, request.find("\r\n", at + 2) - at - 2);
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || !is_same_name(line.substr(0, colon), "host")) continue;
    if (host) return std::nullopt;
    host = line.substr(colon + 1);
    while (host->starts_with(' ')) host->remove_prefix(1);
    while (host->ends_with(' ')) host->remove_suffix(1);
    const std::size_t port = host->find_last_of(":]");
    if (port != std::string_view::npos && (*host)[port] == ':') host = host->substr(0, port);
  }
  return host;
}

}  // namespace

bool HttpServer::is_ours(std::string_view request) const {
  const auto host = host_of(request);
  if (!host) return false;
  const auto is_it = [&](std::string_view name) { return is_same_name(*host, name); };
  return is_it("127.0.0.1") || is_it("localhost") || is_it("[::1]") ||
         std::ranges::any_of(names_, is_it);
}

std::string HttpServer::reply_to(std::string_view request, const Respond& respond) const {
  Answer answer{.status = 405, .body = "only GET\n"};
  if (!is_ours(request)) {
    answer = {.status = 403, .body = "this name is not of this page: page_names\n"};
  } else if (request.starts_with("GET ")) {
    request.remove_prefix(4);
    answer = respond(request.substr(0, request.find_first_of(" ?\r\n")));
  }
  return fmt::format(
             "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n"
             "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n"
             "Content-Security-Policy: default-src 'none'; style-src 'unsafe-inline'\r\n\r\n",
             answer.status, answer.status == 200 ? "OK" : "Refused", answer.type,
             answer.body.size()) +
         answer.body;
}

std::optional<HttpServer> HttpServer::open(int port, std::vector<std::string> names) {
  linux_hal::FileDescriptor listener(
      ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  if (!listener.valid() ||
      ::setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
      ::bind(listener.get(), generic, sizeof address) != 0 ||
      ::listen(listener.get(), SOMAXCONN) != 0) {
    return std::nullopt;
  }
  return HttpServer(std::move(listener), std::move(names));
}

int HttpServer::port() const {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  if (::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0) return 0;
  return ntohs(address.sin_port);
}

void HttpServer::add_to(std::vector<pollfd>& ready) const {
  ready.push_back({.fd = listener_.get(), .events = POLLIN, .revents = 0});
  for (const Client& client : clients_) {
    const short events = client.reply.empty() ? POLLIN : POLLOUT;
    ready.push_back({.fd = client.socket.get(), .events = events, .revents = 0});
  }
}

void HttpServer::advance(Client& client, const Respond& respond) const {
  if (client.reply.empty()) {
    std::array<char, kLongestRequest> buffer{};
    const ssize_t count = ::recv(client.socket.get(), buffer.data(), buffer.size(), 0);
    if (count > 0) client.request.append(buffer.data(), static_cast<std::size_t>(count));
    if (count <= 0 || client.request.size() > kLongestRequest) {
      client.socket.reset();
    } else if (client.request.find("\r\n\r\n") != std::string::npos) {
      client.reply = reply_to(client.request, respond);
    }
    return;
  }
  const ssize_t count =
      ::send(client.socket.get(), client.reply.data(), client.reply.size(), MSG_NOSIGNAL);
  if (count < 0 && errno != EAGAIN) client.socket.reset();
  if (count > 0) client.reply.erase(0, static_cast<std::size_t>(count));
  if (client.reply.empty()) client.socket.reset();
}

void HttpServer::service(const pollfd* ready, std::uint64_t steady_ms, const Respond& respond) {
  for (std::size_t i = 0; i < clients_.size(); ++i) {
    Client& client = clients_[i];
    if (ready[i + 1].revents != 0) advance(client, respond);
    if (steady_ms - client.since_ms > kPatience_ms) client.socket.reset();
  }
  std::erase_if(clients_, [](const Client& client) { return !client.socket.valid(); });
  if ((ready[0].revents & POLLIN) != 0) accept_all(steady_ms);
  drop_oldest();
}

void HttpServer::accept_all(std::uint64_t steady_ms) {
  for (int i = 0; i < kAcceptedAtOnce; ++i) {
    linux_hal::FileDescriptor socket(
        ::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!socket.valid()) return;
    clients_.push_back(
        {.socket = std::move(socket), .request = {}, .reply = {}, .since_ms = steady_ms});
  }
}

// Of those that ask, and of those that read, what is too many.
void HttpServer::drop_oldest() {
  const auto reading = static_cast<std::size_t>(
      std::ranges::count_if(clients_, [](const Client& client) { return !client.reply.empty(); }));
  std::size_t too_many_reading = reading - std::min(reading, kMostReading);
  const std::size_t asking = clients_.size() - reading;
  std::size_t too_many_asking = asking - std::min(asking, kMostAsking);
  std::erase_if(clients_, [&](const Client& client) {
    std::size_t& too_many = client.reply.empty() ? too_many_asking : too_many_reading;
    if (too_many == 0) return false;
    --too_many;
    return true;
  });
}

}  // namespace armsig::fleet
