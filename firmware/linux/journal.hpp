// SPDX-License-Identifier: MIT
// The log of the daemon: lines for standard error, written by a thread that may wait for whoever
// reads them, so that nobody else does.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <thread>

#include "hal/mailbox.hpp"

namespace armsig::daemon {

// As syslog(3) numbers them.
enum class Priority : std::uint8_t { kError = 3, kWarning = 4, kNotice = 5, kInfo = 6 };

class Journal {
 public:
  // Where standard error is the systemd journal's, each line begins with its priority
  // (sd-daemon(3)), elsewhere with "armsigd: ".
  Journal();

  // At once, by the calling thread, which may wait for a tenth of a second: before begin(), after
  // end(), and from the chore.
  void tell(Priority priority, std::string_view text);

  // Starts the thread, which also calls `chore` several times a second, and then ends every
  // thread's need to wait. A chore that throws is told, once until it goes well, and tried again.
  // Throws std::system_error.
  void begin(std::function<void()> chore);
  // By one thread besides: kept for the writing thread, and cut at kLongest. Never waits; what
  // there is no room for is lost and counted, which the log then tells.
  void say(Priority priority, std::string_view text);
  // Everything said is written; the thread is gone. Also done by the destructor.
  void end();

  ~Journal() { end(); }
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  static constexpr std::size_t kLongest = 512;

 private:
  struct Entry {
    Priority priority = Priority::kInfo;
    std::size_t size = 0;
    std::array<char, kLongest> text{};
  };

  void write_all();
  void run(const std::function<void()>& chore);

  bool to_journal_ = false;
  hal::Mailbox<Entry, 128> entries_;
  std::atomic<unsigned> lost_{0};
  unsigned told_lost_ = 0;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace armsig::daemon
