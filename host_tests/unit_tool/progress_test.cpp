// SPDX-License-Identifier: MIT
// What a person sees of work in progress and of its result: on a terminal, in virtual time.
#include "firmware/host_tool/presentation/progress.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <string>

#include <gtest/gtest.h>

#include "firmware/formats/text_file.hpp"
#include "firmware/host_tool/presentation/say.hpp"

namespace armsig::tool {
namespace {

Progress::Clock::time_point now;  // of the work
Progress::Clock::time_point clock_of_the_work() { return now; }

// Standard output and standard error of this process are a terminal while it lives.
class Terminal {
 public:
  Terminal() {
    int slave = -1;
    EXPECT_EQ(::openpty(&master_, &slave, nullptr, nullptr, nullptr), 0);
    for (const int file : {STDOUT_FILENO, STDERR_FILENO}) {
      std::fflush(nullptr);
      former_.at(static_cast<std::size_t>(file - 1)) = ::fcntl(file, F_DUPFD_CLOEXEC, 0);
      ::dup2(slave, file);
    }
    ::close(slave);
  }
  ~Terminal() {
    give_back();
    ::close(master_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // What was written to it, with what "\r" and "erase to the end of the line" make of it; the
  // cursor's line last.
  std::string screen() {
    give_back();
    std::string text;
    for (pollfd ready{master_, POLLIN, 0}; ::poll(&ready, 1, 0) > 0 && (ready.revents & POLLIN);) {
      std::array<char, 4096> part{};
      const ssize_t count = ::read(master_, part.data(), part.size());
      if (count <= 0) break;
      text.append(part.data(), static_cast<std::size_t>(count));
    }
    std::string seen;
    std::string line;
    std::size_t cursor = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') {
        seen += line + '\n';
        line.clear();
        cursor = 0;
      } else if (text[i] == '\r') {
        cursor = 0;
      } else if (text.compare(i, 3, "\033[K") == 0) {
        line.resize(cursor);
        i += 2;
      } else {
        line.resize(std::max(line.size(), cursor + 1));
        line[cursor++] = text[i];
      }
    }
    return seen + line;
  }

 private:
  void give_back() {
    std::fflush(nullptr);
    for (int& file : former_) {
      if (file < 0) continue;
      ::dup2(file, static_cast<int>(&file - former_.data()) + 1);
      ::close(std::exchange(file, -1));
    }
  }

  int master_ = -1;
  std::array<int, 2> former_{-1, -1};
};

// Six of seven steps have taken three seconds.
class ProgressOnATerminal : public testing::Test {
 protected:
  void work() {
    now += std::chrono::seconds(3);
    progress.update(6);
  }

  Terminal terminal;
  Progress progress{"Identifying seven arms", 7, clock_of_the_work};
};

TEST_F(ProgressOnATerminal, is_shown_while_the_work_goes_on) {
  work();
  const std::string seen = terminal.screen();
  EXPECT_TRUE(seen.starts_with("Identifying seven arms  ")) << seen;
  EXPECT_TRUE(seen.ends_with(" 86 %  0 s left")) << seen;
}

TEST_F(ProgressOnATerminal, is_not_shown_for_a_second) {
  progress.update(6);
  EXPECT_EQ(terminal.screen(), "");
}

TEST_F(ProgressOnATerminal, is_gone_before_a_result) {
  work();
  say("{}: seven Puma 560\n", "demo");
  EXPECT_EQ(terminal.screen(), "demo: seven Puma 560\n");
}

TEST_F(ProgressOnATerminal, is_gone_before_a_warning_and_comes_back_after_it) {
  work();
  complain("{} is doubtful", "that");
  work();
  const std::string seen = terminal.screen();
  EXPECT_TRUE(seen.starts_with("that is doubtful\nIdentifying seven arms  ")) << seen;
}

TEST_F(ProgressOnATerminal, is_gone_before_a_file_that_goes_to_standard_output) {
  work();
  EXPECT_TRUE(write_text_file("-", "q1_deg,q2_deg\n"));
  EXPECT_EQ(terminal.screen(), "q1_deg,q2_deg\n");
}

TEST(Progress, is_gone_when_the_work_is_done) {
  Terminal terminal;
  {
    Progress progress("Simulating", 0, clock_of_the_work);
    now += std::chrono::seconds(3);
    progress.update(1000);
  }
  EXPECT_EQ(terminal.screen(), "");
}

TEST(Progress, is_nothing_where_standard_error_is_no_terminal) {
  testing::internal::CaptureStderr();
  Progress progress("Simulating", 10, clock_of_the_work);
  now += std::chrono::seconds(3);
  progress.update(5);
  say(stderr, "done\n");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "done\n");
}

}  // namespace
}  // namespace armsig::tool
