// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/web_server.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <random>
#include <utility>

#include <fmt/format.h>

#include "firmware/host_tool/console/web_advice.hpp"
#include "firmware/host_tool/console/web_files.hpp"
#include "firmware/host_tool/console/web_requests.hpp"

namespace armsig::tool {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLongestRequest{2000};  // from its first byte, or of nothing at all
constexpr milliseconds kLongestStall{2000};    // of a reader: slower, and it is dropped
constexpr milliseconds kLongestSilence{500};   // of a stream
constexpr milliseconds kLongestFarewell{500};  // of a connection that we have ended
constexpr int kWaiting = 128;                  // connections that the kernel keeps for us
constexpr int kAcceptedAtOnce = 64;
constexpr int kMostUnread = 32768;                              // bytes in the kernel
constexpr std::size_t kMostDiscarded = std::size_t{64} << 10U;  // after the reply
constexpr std::size_t kPieceOfFile = std::size_t{64} << 10U;
constexpr std::uintmax_t kLargestBlackBox = std::uintmax_t{64} << 20U;

// In a time that does not tell how much of it is right.
bool is_same(std::string_view one, std::string_view other) {
  if (one.size() != other.size()) return false;
  unsigned different = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    different |= static_cast<unsigned char>(one[i]) ^ static_cast<unsigned char>(other[i]);
  }
  return different == 0;
}

HttpReply refused(int status, std::string_view words) {
  return {.status = status, .body = fmt::format("{}\n", words), .fields = {}};
}

// What the controller says is its file must look like one of its black box.
bool is_black_box(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  std::error_code error;
  return name.starts_with("black-box-") && name.ends_with(".csv") &&
         std::filesystem::is_regular_file(path, error) &&
         std::filesystem::file_size(path, error) <= kLargestBlackBox;
}

}  // namespace

WebServer::WebServer(std::string token, WebBoard& board, WebWatch& watch)
    : token_(std::move(token)), advice_(web_advice().dump()), board_(board), watch_(watch) {}

std::optional<int> WebServer::bind(int port) {
  linux_hal::FileDescriptor socket(
      ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  // Not SO_REUSEPORT, with which a second server would share the port in silence.
  const int yes = 1;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  ::setsockopt(socket.get(), SOL_SOCKET, SO_SNDBUF, &kMostUnread, sizeof kMostUnread);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): what the system asks for
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  if (!socket.valid() || ::bind(socket.get(), generic, size) != 0 ||
      ::listen(socket.get(), kWaiting) != 0 || ::getsockname(socket.get(), generic, &size) != 0) {
    return std::nullopt;
  }
  listener_ = std::move(socket);
  port_ = ntohs(address.sin_port);
  return port_;
}

std::string WebServer::address() const {
  return fmt::format("http://127.0.0.1:{}/{}/", port_, token_);
}

void WebServer::serve() {
  std::vector<pollfd> ready;
  for (;;) {
    ready.assign({{listener_.get(), POLLIN, 0}, {board_.news(), POLLIN, 0}});
    auto until = Clock::now() + kLongestSilence;
    for (const Connection& one : connections_) {
      const bool sends = !one.out.empty() || one.file != nullptr;
      const int events = sends ? POLLOUT : POLLIN;
      ready.push_back({one.socket.get(), static_cast<short>(events), 0});
      until = std::min(until, one.stream && !sends ? one.stream->due : one.until);
    }
    const auto left = std::chrono::ceil<milliseconds>(until - Clock::now());
    const int count = ::poll(ready.data(), ready.size(),
                             static_cast<int>(std::clamp<milliseconds::rep>(left.count(), 0, 500)));
    if (count < 0 && errno != EINTR) return;
    board_.take_news();
    for (std::size_t i = 0; i < connections_.size(); ++i) {
      Connection& one = connections_[i];
      const auto happened = count > 0 ? ready[i + 2].revents : 0;
      bool good = (happened & (POLLERR | POLLNVAL)) == 0;
      if (good && (happened & (POLLIN | POLLHUP)) != 0) good = receive(one);
      if (good) tell_news(one);
      if (good) good = send(one) && take_requests(one) && send(one);
      if (!good || (one.until < Clock::now() && !(one.stream && one.out.empty()))) drop(one);
    }
    std::erase_if(connections_, [](const Connection& one) { return !one.socket.valid(); });
    if (count > 0 && ready[0].revents != 0) accept_all();
  }
}

void WebServer::drop(Connection& connection) {
  if (connection.stream) {
    viewers_.end(connection.stream->place);
    board_.touch();
  }
  connection = {};
}

void WebServer::accept_all() {
  for (int i = 0; i < kAcceptedAtOnce; ++i) {
    linux_hal::FileDescriptor socket(
        ::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!socket.valid() && (errno == EMFILE || errno == ENFILE) && !connections_.empty()) {
      make_room();
      continue;
    }
    if (!socket.valid()) return;
    const int yes = 1;
    ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    if (connections_.size() >= kMostConnections) make_room();
    Connection& added = connections_.emplace_back();
    added.socket = std::move(socket);
    added.until = Clock::now() + kLongestRequest;
    // What has been sent by now is answered before its place may be somebody else's.
    if (!(receive(added) && take_requests(added) && send(added))) {
      drop(added);
      connections_.pop_back();
    }
  }
}

// Of those who have not shown the key, or have their reply, the first; else of those who do not
// look on.
void WebServer::make_room() {
  auto victim = std::ranges::find_if(connections_,
                                     [](const auto& one) { return !one.knows_key || one.lingers; });
  if (victim == connections_.end()) {
    victim = std::ranges::find_if(connections_, [](const auto& one) { return !one.stream; });
  }
  if (victim == connections_.end()) return;
  drop(*victim);
  connections_.erase(victim);
}

bool WebServer::receive(Connection& connection) {
  std::array<char, 4096> bytes{};
  constexpr std::size_t kMost = kLongestHead + kLongestBody;
  while (connection.in.size() < kMost) {
    const ssize_t count = ::recv(connection.socket.get(), bytes.data(), bytes.size(), 0);
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    if (count == 0) return false;
    if (connection.stream) return true;  // nothing is expected of a viewer
    if (connection.lingers) {
      connection.discarded += static_cast<std::size_t>(count);
      return connection.discarded <= kMostDiscarded;
    }
    if (connection.in.empty()) connection.until = Clock::now() + kLongestRequest;
    connection.in.append(bytes.data(), static_cast<std::size_t>(count));
  }
  return true;
}

// One after the other: the next when the reply to the one before is on its way.
bool WebServer::take_requests(Connection& connection) {
  while (connection.out.empty() && !connection.file && !connection.stream && !connection.closes) {
    const auto request = http_request(connection.in);
    if (!request) return true;
    connection.closes = request->refused != 0 || !request->keeps_alive;
    // The key is judged before the body is waited for.
    const bool admitted = request->refused == 0 && admits(*request);
    if (request->refused != 0) {
      connection.out = http_text(refused(request->refused, "not a request of the page"), true);
    } else if (!admitted) {
      connection.closes = true;
      connection.out = http_text(
          refused(403, "the address that `armsig connect` printed for --web is needed whole"),
          true);
    } else {
      connection.knows_key = true;
      const std::size_t whole = request->head_bytes + request->body_bytes;
      if (connection.in.size() < whole) {
        connection.closes = false;
        return true;
      }
      answer(connection, *request,
             std::string_view(connection.in).substr(request->head_bytes, request->body_bytes));
      connection.in.erase(0, whole);
    }
    connection.until = Clock::now() + kLongestStall;
    if (!send(connection)) return false;
  }
  return true;
}

bool WebServer::send(Connection& connection) const {
  for (;;) {
    if (connection.out.empty() && connection.file) {
      connection.out.resize(kPieceOfFile);
      connection.file->read(connection.out.data(), kPieceOfFile);
      connection.out.resize(static_cast<std::size_t>(connection.file->gcount()));
      if (!*connection.file) connection.file.reset();
    }
    if (connection.out.empty()) {
      // What the other end still sends must not take the reply away from it.
      if (connection.closes && !std::exchange(connection.lingers, true)) {
        ::shutdown(connection.socket.get(), SHUT_WR);
        connection.until = Clock::now() + kLongestFarewell;
      }
      return true;
    }
    const ssize_t count =
        ::send(connection.socket.get(), connection.out.data(), connection.out.size(), MSG_NOSIGNAL);
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    connection.until = Clock::now() + kLongestStall;
    connection.out.erase(0, static_cast<std::size_t>(count));
    if (connection.file) return true;  // one piece a pass
  }
}

// What a slow viewer has not taken is not piled up: it is told the rest in one when it has.
void WebServer::tell_news(Connection& connection) {
  if (!connection.stream || !connection.out.empty()) return;
  Stream& stream = *connection.stream;
  if (Clock::now() < stream.due && board_.is_seen(stream.seen)) return;
  connection.out = board_.events(stream.seen, viewers_.told(stream.viewer));
  connection.until = Clock::now() + kLongestStall;
  stream.due = Clock::now() + kLongestSilence;
}

// A page elsewhere can make a browser ask us, by a name that it lets mean 127.0.0.1: but then the
// Host is that name, and the Origin that page.
bool WebServer::admits(const HttpRequest& request) const {
  const bool ours = request.host == fmt::format("127.0.0.1:{}", port_) ||
                    request.host == fmt::format("localhost:{}", port_);
  const bool same_origin =
      request.origin.empty() || request.origin == fmt::format("http://{}", request.host);
  const std::size_t end = request.path.find('/', 1);
  return ours && same_origin && end != std::string_view::npos &&
         is_same(request.path.substr(1, end - 1), token_);
}

void WebServer::answer(Connection& connection, const HttpRequest& request, std::string_view body) {
  if (request.method == "GET") return get(connection, request);
  const HttpReply reply =
      request.method == "POST" ? post(request, body) : refused(405, "only GET and POST");
  connection.out = http_text(reply, connection.closes);
}

void WebServer::get(Connection& connection, const HttpRequest& request) {
  const std::string_view name = request.path.substr(token_.size() + 2);
  if (name == "events") return begin_stream(connection, request);
  if (name == "black-box.csv") return send_black_box(connection);
  HttpReply reply = refused(404, "there is no such thing");
  const std::string_view wanted = name.empty() ? "page.html" : name;
  const auto* const file = std::ranges::find(kWebFiles, wanted, &WebFile::name);
  if (name == "advice.json") {
    reply = {.type = "application/json", .body = advice_, .fields = {}};
  } else if (file != kWebFiles.end()) {
    reply = {.type = file->type, .body = std::string(file->content), .fields = {}};
  }
  connection.out = http_text(reply, connection.closes);
}

void WebServer::begin_stream(Connection& connection, const HttpRequest& request) {
  const std::string viewer(query_value(request.query, "viewer"));
  const auto place = is_viewer(viewer) ? viewers_.begin(viewer) : std::nullopt;
  if (!place) {
    const HttpReply reply = is_viewer(viewer) ? refused(503, "too many look already")
                                              : refused(400, "viewer=: letters and digits");
    connection.out = http_text(reply, connection.closes);
    return;
  }
  board_.touch();
  connection.closes = false;
  connection.stream =
      Stream{.place = *place, .viewer = viewer, .seen = {}, .due = Clock::now() + kLongestSilence};
  connection.out = http_head({.type = "text/event-stream", .body = {}, .fields = {}}, {}, true) +
                   board_.events(connection.stream->seen, viewers_.told(viewer));
}

void WebServer::send_black_box(Connection& connection) {
  const std::filesystem::path path(board_.black_box());
  auto file = std::make_unique<std::ifstream>(path, std::ios::binary);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (path.empty() || !is_black_box(path) || !*file || error) {
    const std::string why =
        path.empty() ? "no fault has left a black box yet"
                     : "the black box is a file of the controller's computer: " + path.string();
    connection.out = http_text(refused(404, why), connection.closes);
    return;
  }
  // By its end: whatever has become of the file meanwhile, the next reply does not begin in it.
  connection.closes = true;
  connection.out =
      http_head({.type = "text/csv",
                 .body = {},
                 .fields = fmt::format("Content-Disposition: attachment; filename=\"{}\"\r\n",
                                       path.filename().string())},
                size, true);
  connection.file = std::move(file);
}

HttpReply WebServer::post(const HttpRequest& request, std::string_view body) {
  const bool sent_by_page = request.path == fmt::format("/{}/request", token_) &&
                            request.content_type == "application/json";
  if (!sent_by_page) return refused(400, "not a request of the page");
  const auto asked = page_request(body, board_.revolute());
  if (!asked) return refused(400, asked.error());
  if (asked->verb == "take-over") {
    viewers_.take_over(asked->viewer);
    board_.touch();
  } else if (asked->verb != "stop" && !viewers_.holds(asked->viewer)) {
    const bool free = viewers_.told(asked->viewer)["free"];
    return refused(403, free ? "nobody holds the controls; take them over first"
                             : "another viewer holds the controls");
  } else if (!watch_.request(*asked)) {
    return refused(409, "another request is under way");
  }
  return {.status = 202, .body = {}, .fields = {}};
}

std::string random_token() {
  std::random_device device;  // the kernel's
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", device());
  return token;
}

}  // namespace armsig::tool
