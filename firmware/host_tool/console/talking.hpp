// SPDX-License-Identifier: MIT
// A script's side of a console: a request and its reply, and the end of what a request began.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "firmware/host_tool/console/console_client.hpp"

namespace armsig::tool {

struct Reply {
  enum class How : std::uint8_t {
    kOk,
    kError,   // refused, or ended badly
    kSilent,  // nothing came in time
    kGone,    // the controller closed the console
  };
  How how = How::kSilent;
  std::string text;  // "ok ..." or "error ..."; empty where nothing came
};

// What becomes of a sequence or a move, by what the controller says of it.
class Ending {
 public:
  // A line that came unasked.
  void hear(std::string_view line);
  // Forgets what was heard: something new has been asked for.
  void forget() { *this = Ending(); }
  // The controller has taken `verb`: what enables, disables or resets has ended in its mode.
  void begun(std::string_view verb);

  // With the reply to `status`: "ok ..." or "error ..." where all has ended, empty while something
  // is under way.
  [[nodiscard]] std::string told(std::string_view status) const;

 private:
  std::string line_;  // the last one that tells an end, without its "# "
  bool is_bad_ = false;
  std::string_view awaited_mode_;  // of the end; empty: any rest is one
  bool resets_ = false;            // a fault of before goes
  bool homes_ = false;             // a search that finds its reference says so
};

class Talker {
 public:
  using Hear = std::function<void(std::string_view)>;  // what is said unasked

  // `console` must outlive it.
  Talker(ConsoleClient& console, Hear hear) : console_(console), hear_(std::move(hear)) {}

  // The reply to `request`. One that begins with `wait` is not sent: it is wait_for() its
  // timeout_s=, an hour where it has none.
  [[nodiscard]] Reply request(const std::string& request, std::chrono::milliseconds longest);

  // Until nothing is under way any more, or a sequence waits for somebody: whether it ended well.
  // `longest`: for each reply of the controller.
  [[nodiscard]] Reply wait_for(std::chrono::milliseconds bound, std::chrono::milliseconds longest);

 private:
  [[nodiscard]] Reply ask(const std::string& line, std::chrono::milliseconds longest);
  [[nodiscard]] Reply wait(std::string_view request, std::chrono::milliseconds longest);
  void heard(std::string_view line);

  ConsoleClient& console_;
  Hear hear_;
  Ending ending_;
};

}  // namespace armsig::tool
