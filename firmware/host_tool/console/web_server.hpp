// SPDX-License-Identifier: MIT
// The live page of a controller over HTTP on the loopback, for those who know its address.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/host_tool/console/web_board.hpp"
#include "firmware/host_tool/console/web_watch.hpp"

namespace httplib {
struct Request;
struct Response;
}  // namespace httplib

namespace armsig::tool {

// Who looks, and which of them holds the controls: the first, until another takes them over or they
// are free because their holder has gone.
class WebViewers {
 public:
  static constexpr std::size_t kMost = 6;

  // Of `viewer`, who begins to look; nothing where there are kMost already.
  [[nodiscard]] std::optional<std::size_t> begin(const std::string& viewer);
  void end(std::size_t place);
  void take_over(const std::string& viewer);

  [[nodiscard]] bool holds(const std::string& viewer) const;
  // {"holds": ..., "free": ..., "viewers": ...} for `viewer`.
  [[nodiscard]] WebBoard::Json told(const std::string& viewer) const;

 private:
  [[nodiscard]] bool looks(const std::string& viewer) const;  // the mutex is held

  mutable std::mutex mutex_;
  std::array<std::string, kMost> looking_;
  std::string holder_;
};

class WebServer {
 public:
  // `token` is what an address must contain; `board` and `watch` must outlive the server.
  WebServer(std::string token, WebBoard& board, WebWatch& watch);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  // On 127.0.0.1; 0 takes a free port. The port, or nothing where it is taken.
  [[nodiscard]] std::optional<int> bind(int port);
  // Serves until the process ends. False if it could not.
  [[nodiscard]] bool serve();

  [[nodiscard]] std::string address() const;

 private:
  struct Http;

  [[nodiscard]] bool admits(const httplib::Request& request, httplib::Response& response) const;
  void get(const httplib::Request& request, httplib::Response& response);
  void stream(const httplib::Request& request, httplib::Response& response);
  void post(const httplib::Request& request, httplib::Response& response);

  std::string token_;
  int port_ = 0;
  WebBoard& board_;
  WebWatch& watch_;
  WebViewers viewers_;
  std::unique_ptr<Http> http_;
};

// 128 random bits as hexadecimal digits.
[[nodiscard]] std::string random_token();

}  // namespace armsig::tool
