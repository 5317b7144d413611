// SPDX-License-Identifier: MIT
// The live page of a controller over HTTP on the loopback, for those who know its address.
//
// One thread and no waiting: connections are polled, a request is looked at when all of it is
// there, and `stop` is passed on in the same pass. Who has not shown the key costs a place among
// kMostConnections, for two seconds at most, and gives it up to whoever comes next.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host_tool/console/web_board.hpp"
#include "firmware/host_tool/console/web_http.hpp"
#include "firmware/host_tool/console/web_watch.hpp"
#include "hal/linux/file_descriptor.hpp"

namespace armsig::tool {

// Who looks, and which of them holds the controls: the first, until another takes them over or they
// are free because their holder has gone.
class WebViewers {
 public:
  static constexpr std::size_t kMost = 6;

  // Of `viewer`, who begins to look; nothing where there are kMost already.
  [[nodiscard]] std::optional<std::size_t> begin(const std::string& viewer);
  void end(std::size_t place) { looking_[place].clear(); }
  void take_over(const std::string& viewer);

  [[nodiscard]] bool holds(const std::string& viewer) const;
  // {"holds": ..., "free": ..., "viewers": ...} for `viewer`.
  [[nodiscard]] WebBoard::Json told(const std::string& viewer) const;

 private:
  [[nodiscard]] bool looks(const std::string& viewer) const;

  std::array<std::string, kMost> looking_;
  std::string holder_;
};

class WebServer {
 public:
  static constexpr std::size_t kMostConnections = 64;

  // `token` is what an address must contain; `board` and `watch` must outlive the server.
  WebServer(std::string token, WebBoard& board, WebWatch& watch);

  // On 127.0.0.1; 0 takes a free port. The port, or nothing where it is taken.
  [[nodiscard]] std::optional<int> bind(int port);
  // Serves until the process ends; returns where it can't.
  void serve();

  [[nodiscard]] std::string address() const;

 private:
  using Clock = std::chrono::steady_clock;

  // The events that one viewer is sent.
  struct Stream {
    std::size_t place = 0;
    std::string viewer;
    WebBoard::Seen seen;
    Clock::time_point due;  // by then the viewer hears of us
  };
  struct Connection {
    linux_hal::FileDescriptor socket;
    std::string in;                       // not yet taken
    std::string out;                      // not yet sent
    std::unique_ptr<std::ifstream> file;  // what follows `out`
    Clock::time_point until;              // whoever has not gone on by then is dropped
    bool knows_key = false;
    bool closes = false;        // when all is sent
    bool lingers = false;       // all is sent: until the other end has seen it
    std::size_t discarded = 0;  // bytes that came since
    std::optional<Stream> stream;
  };

  void accept_all();
  void make_room();
  // False: it is to be dropped.
  [[nodiscard]] bool receive(Connection& connection);
  [[nodiscard]] bool take_requests(Connection& connection);
  [[nodiscard]] bool send(Connection& connection) const;
  void tell_news(Connection& connection);
  void drop(Connection& connection);

  [[nodiscard]] bool admits(const HttpRequest& request) const;
  void answer(Connection& connection, const HttpRequest& request, std::string_view body);
  void get(Connection& connection, const HttpRequest& request);
  void begin_stream(Connection& connection, const HttpRequest& request);
  void send_black_box(Connection& connection);
  [[nodiscard]] HttpReply post(const HttpRequest& request, std::string_view body);

  std::string token_;
  std::string advice_;
  int port_ = 0;
  WebBoard& board_;
  WebWatch& watch_;
  WebViewers viewers_;
  linux_hal::FileDescriptor listener_;
  std::vector<Connection> connections_;  // those that came first are first
};

// 128 random bits as hexadecimal digits.
[[nodiscard]] std::string random_token();

}  // namespace armsig::tool
