// SPDX-License-Identifier: MIT
#include "firmware/linux/journal.hpp"

#include <poll.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "hal/linux/steady_clock.hpp"

namespace armsig::daemon {
namespace {

constexpr hal::Duration kRest = std::chrono::milliseconds(50);
// Whoever reads the log may be stuck; it holds nobody up for longer.
constexpr int kPatience_ms = 100;

// A stream that says so takes PIPE_BUF bytes without waiting, more than a line has.
bool can_write(int patience_ms) {
  pollfd stream{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
  return ::poll(&stream, 1, patience_ms) > 0;
}

// systemd says by JOURNAL_STREAM, "device:inode", which stream is its own (systemd.exec(5)).
bool is_the_journals(int descriptor) {
  const char* const told = std::getenv("JOURNAL_STREAM");
  struct stat status{};
  if (told == nullptr || ::fstat(descriptor, &status) != 0) return false;
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino) == told;
}

}  // namespace

Journal::Journal() : to_journal_(is_the_journals(STDERR_FILENO)) {}

// One system call a line, so that lines of several writers do not mix; nothing of the heap.
void Journal::tell(Priority priority, std::string_view text) {
  const std::array<char, 3> number{'<', static_cast<char>('0' + static_cast<int>(priority)), '>'};
  constexpr std::string_view kName = "armsigd: ";
  const std::string_view begin =
      to_journal_ ? std::string_view(number.data(), number.size()) : kName;
  const auto part = [](std::string_view words) {
    return iovec{.iov_base = const_cast<char*>(words.data()),  // NOLINT: only read by writev
                 .iov_len = words.size()};
  };
  const std::array<iovec, 3> parts{part(begin), part(text), part("\n")};
  if (!can_write(kPatience_ms) || ::writev(STDERR_FILENO, parts.data(), parts.size()) < 0) ++lost_;
}

void Journal::begin(std::function<void()> chore) {
  stop_ = false;
  thread_ = std::thread([this, chore = std::move(chore)] { run(chore); });
}

void Journal::run(const std::function<void()>& chore) {
  linux_hal::SteadyClock clock;
  bool told = false;
  // Nothing that this thread does for others is worth the end of the process that moves the arm.
  const auto attempt = [&] {
    try {
      chore();
      told = false;
    } catch (const std::exception& error) {
      if (told) return;
      told = true;
      std::array<char, kLongest> text{};
      (void)std::snprintf(text.data(), text.size(), "beside the controller: %s", error.what());
      tell(Priority::kError, text.data());
    }
  };
  while (!stop_) {
    write_all();
    attempt();
    clock.wait_until(clock.now() + kRest);
  }
  attempt();
  write_all();
}

void Journal::write_all() {
  while (can_write(0)) {
    const auto entry = entries_.take();
    if (!entry) break;
    tell(entry->priority, {entry->text.data(), entry->size});
  }
  const unsigned lost = lost_;
  if (lost == told_lost_ || !can_write(0)) return;
  std::array<char, 64> text{};
  (void)std::snprintf(text.data(), text.size(), "%u lines of the log were lost", lost - told_lost_);
  told_lost_ = lost;
  tell(Priority::kWarning, text.data());
}

void Journal::say(Priority priority, std::string_view text) {
  if (!thread_.joinable()) {
    tell(priority, text);
    return;
  }
  Entry entry{.priority = priority, .size = std::min(text.size(), kLongest), .text = {}};
  std::copy_n(text.begin(), entry.size, entry.text.begin());
  if (!entries_.post(entry)) ++lost_;
}

void Journal::end() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

}  // namespace armsig::daemon
