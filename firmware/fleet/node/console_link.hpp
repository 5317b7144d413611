// SPDX-License-Identifier: MIT
// The reporter's end of the controller's console: asks, and never waits. It knows three requests,
// `status`, `signature` and `fetch what=signature`; nothing that comes by MQTT is ever written
// here.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "hal/linux/file_descriptor.hpp"

namespace armsig::fleet {

class ConsoleLink {
 public:
  enum class Request : std::uint8_t { kStatus, kSignature };

  explicit ConsoleLink(std::string path) : path_(std::move(path)) {}

  // Opens the socket where there is none. False: nobody answers there.
  bool open();
  // Sends the request; a controller that takes nothing is left.
  void ask(Request request);
  // Part `part` of the signature's record.
  void ask_record(std::size_t part);
  // The next whole line that has come; none: no such line yet.
  [[nodiscard]] std::optional<std::string> take_line();

  [[nodiscard]] bool is_open() const { return socket_.valid(); }
  [[nodiscard]] int descriptor() const { return socket_.get(); }

 private:
  void send(std::string_view line);
  void receive();

  std::string path_;
  linux_hal::FileDescriptor socket_;
  std::string received_;
};

}  // namespace armsig::fleet
