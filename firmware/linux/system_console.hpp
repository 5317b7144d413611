// SPDX-License-Identifier: MIT
// A console that answers `system` itself, about the process, and adds to the reply to `status` the
// file of the black box; everything else is the controller's.
#pragma once

#include "firmware/linux/black_box.hpp"
#include "firmware/linux/process_watch.hpp"
#include "hal/console.hpp"

namespace armsig::daemon {

class SystemConsole final : public hal::Console {
 public:
  // All outlive the console.
  SystemConsole(hal::Console& inner, const ProcessWatch& watch, const BlackBox& box)
      : inner_(inner), watch_(watch), box_(box) {}

 private:
  std::optional<hal::ConsoleLine> do_read_line() override {
    auto line = inner_.read_line();
    if (!line || line->error || line->text() != "system") return line;
    controller::Line reply;
    reply.text("ok");
    watch_.tell(reply);
    (void)inner_.write_line(line->client, reply.view());
    return std::nullopt;
  }
  Result<void> do_write_line(hal::ConsoleClient client, std::string_view text) override {
    const std::string_view file = box_.last_file();
    const bool is_status = text.starts_with("ok mode=");
    constexpr std::string_view kKey = " black_box=";
    if (!is_status || file.empty() || text.size() + kKey.size() + file.size() > kLongestReply) {
      return inner_.write_line(client, text);
    }
    FixedVector<char, kLongestReply> reply;
    for (const std::string_view part : {text, kKey, file}) {
      for (const char c : part) reply.push_back(c);
    }
    return inner_.write_line(client, {reply.data(), reply.size()});
  }
  void do_broadcast(std::string_view text) override { inner_.broadcast(text); }

  static constexpr std::size_t kLongestReply = 2048;

  hal::Console& inner_;
  const ProcessWatch& watch_;
  const BlackBox& box_;
};

}  // namespace armsig::daemon
