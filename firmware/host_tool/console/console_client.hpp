// SPDX-License-Identifier: MIT
// The far end of a controller's console: lines to it and from it, over a Unix socket or a serial
// line.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/formats/problem.hpp"
#include "hal/linux/file_descriptor.hpp"

namespace armsig::tool {

class ConsoleClient {
 public:
  // `path` is a Unix socket, or a serial device, which is set to 115200 8N1.
  [[nodiscard]] static Read<ConsoleClient> open(const std::string& path);

  // Sends `line` and its end; false if the controller has gone. Waits while it takes nothing.
  [[nodiscard]] bool send(std::string_view line);

  // The next whole line, without its end, as soon as there is one; nothing after `longest` or when
  // the controller has gone.
  [[nodiscard]] std::optional<std::string> receive(std::chrono::milliseconds longest);
  [[nodiscard]] bool gone() const { return gone_; }

  // To wait for it together with other things: readable when receive() may have something new.
  [[nodiscard]] int descriptor() const { return connection_.get(); }

 private:
  explicit ConsoleClient(linux_hal::FileDescriptor connection)
      : connection_(std::move(connection)) {}
  [[nodiscard]] std::optional<std::string> take_line();

  linux_hal::FileDescriptor connection_;
  std::string received_;
  bool gone_ = false;
};

// "ok ..." or "error ...": the reply to a request, as against what the controller says unasked.
[[nodiscard]] bool is_reply(std::string_view line);
[[nodiscard]] bool is_error(std::string_view line);

}  // namespace armsig::tool
