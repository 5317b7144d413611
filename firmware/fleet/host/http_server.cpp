// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/http_server.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>

#include <fmt/format.h>

namespace armsig::fleet {
namespace {

constexpr std::size_t kMostClients = 16;
constexpr std::size_t kLongestRequest = 4096;
constexpr std::uint64_t kPatience_ms = 5'000;

std::string reply_to(std::string_view request, const HttpServer::Respond& respond) {
  Answer answer{.status = 405, .body = "only GET\n"};
  if (request.starts_with("GET ")) {
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

}  // namespace

std::optional<HttpServer> HttpServer::open(int port) {
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
      ::bind(listener.get(), generic, sizeof address) != 0 || ::listen(listener.get(), 16) != 0) {
    return std::nullopt;
  }
  return HttpServer(std::move(listener));
}

void HttpServer::add_to(std::vector<pollfd>& ready) const {
  ready.push_back({.fd = listener_.get(), .events = POLLIN, .revents = 0});
  for (const Client& client : clients_) {
    const short events = client.reply.empty() ? POLLIN : POLLOUT;
    ready.push_back({.fd = client.socket.get(), .events = events, .revents = 0});
  }
}

void HttpServer::advance(Client& client, const Respond& respond) {
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
  if ((ready[0].revents & POLLIN) == 0) return;
  linux_hal::FileDescriptor socket(
      ::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (socket.valid() && clients_.size() < kMostClients) {
    clients_.push_back(
        {.socket = std::move(socket), .request = {}, .reply = {}, .since_ms = steady_ms});
  }
}

}  // namespace armsig::fleet
