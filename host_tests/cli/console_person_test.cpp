// SPDX-License-Identifier: MIT
// armsig connect as a person uses it: at a pseudo-terminal, against a console of this process.
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include <gtest/gtest.h>

#include "hal/linux/socket_console.hpp"
#include "host_tests/cli/run_tool.hpp"

namespace armsig::cli {
namespace {

// A controller with three verbs, which tells unasked what it was asked to do.
class SmallController {
 public:
  explicit SmallController(const std::string& path) {
    auto console = linux_hal::SocketConsole::open(path);
    EXPECT_TRUE(console);
    console_ = std::move(*console);
    thread_ = std::thread([this] {
      while (!stop_) serve();
    });
  }
  ~SmallController() {
    stop_ = true;
    thread_.join();
  }
  SmallController(const SmallController&) = delete;
  SmallController& operator=(const SmallController&) = delete;

 private:
  void serve() {
    const auto line = console_->read_line();
    if (!line) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      return;
    }
    const std::string_view asked = line->text();
    std::string_view reply = "ok";
    if (asked == "help") reply = "ok verbs=status,stop,move,help";
    if (asked == "help move")
      reply = "ok verb=move modes=holding alone=no does=\"q1_deg=10 moves\"";
    if (asked == "status") reply = "ok mode=idle moving=no q1_deg=1.0000 q2_deg=2.0000 ticks=3";
    if (asked.starts_with("move")) console_->broadcast("# moves: " + std::string(asked));
    (void)console_->write_line(line->client, reply);
  }

  std::unique_ptr<linux_hal::SocketConsole> console_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

// `armsig connect console` at a terminal of 80 columns, in a home of its own.
class Person {
 public:
  explicit Person(const Folder& folder) {
    const winsize size{.ws_row = 24, .ws_col = 80, .ws_xpixel = 0, .ws_ypixel = 0};
    process_ = ::forkpty(&terminal_, nullptr, nullptr, &size);
    if (process_ != 0) return;
    (void)::setenv("HOME", folder.path().c_str(), 1);
    (void)::unsetenv("XDG_STATE_HOME");
    (void)::setenv("TERM", "xterm", 1);
    (void)::chdir(folder.path().c_str());
    ::execl(ARMSIG_TOOL, "armsig", "connect", "console", nullptr);
    ::_exit(127);
  }
  ~Person() {
    if (process_ > 0) {
      (void)::kill(process_, SIGKILL);
      (void)leave();
    }
    (void)::close(terminal_);
  }
  Person(const Person&) = delete;
  Person& operator=(const Person&) = delete;

  void type(std::string_view keys) { (void)!::write(terminal_, keys.data(), keys.size()); }

  // Whether the terminal comes to show `text`, after what was looked for before.
  bool sees(std::string_view text) {
    constexpr int kLongest_ms = 30000;
    for (;;) {
      if (const std::size_t at = shown_.find(text, seen_); at != std::string::npos) {
        seen_ = at + text.size();
        return true;
      }
      pollfd ready{.fd = terminal_, .events = POLLIN, .revents = 0};
      std::array<char, 4096> bytes{};
      const bool news = ::poll(&ready, 1, kLongest_ms) == 1;
      const ssize_t count = news ? ::read(terminal_, bytes.data(), bytes.size()) : 0;
      if (count <= 0) return false;
      shown_.append(bytes.data(), static_cast<std::size_t>(count));
    }
  }

  // The status with which it ends.
  int leave() {
    int status = -1;
    (void)::waitpid(std::exchange(process_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  [[nodiscard]] const std::string& shown() const { return shown_; }

 private:
  pid_t process_ = -1;
  int terminal_ = -1;
  std::string shown_;
  std::size_t seen_ = 0;
};

TEST(ConsolePerson, completes_a_verb_and_its_key_by_tab) {
  const Folder folder;
  const SmallController controller((folder / "console").string());
  Person person(folder);
  ASSERT_TRUE(person.sees("armsig> ")) << person.shown();
  person.type(
      "given up\x03"
      "m\tq\t2\t5\r");
  EXPECT_TRUE(person.sees("# moves: move q2_deg=5")) << person.shown();
  EXPECT_TRUE(person.sees("ok")) << person.shown();
  person.type("raw m\tq1\t6\r");
  EXPECT_TRUE(person.sees("# moves: move q1_deg=6")) << person.shown();
  person.type("quit\r");
  EXPECT_EQ(person.leave(), 0);
}

TEST(ConsolePerson, sends_nothing_that_is_no_request_and_says_which_was_meant) {
  const Folder folder;
  const SmallController controller((folder / "console").string());
  Person person(folder);
  ASSERT_TRUE(person.sees("armsig> ")) << person.shown();
  person.type("mvoe q1_deg=3\r");
  EXPECT_TRUE(person.sees("did you mean `move`?")) << person.shown();
  person.type("status\r");
  EXPECT_TRUE(person.sees("idle          no torque")) << person.shown();
  person.type("\x04");
  EXPECT_EQ(person.leave(), 0);
  EXPECT_FALSE(person.shown().contains("# moves"));
}

TEST(ConsolePerson, recalls_a_line_of_a_former_time) {
  const Folder folder;
  const SmallController controller((folder / "console").string());
  {
    Person person(folder);
    ASSERT_TRUE(person.sees("armsig> ")) << person.shown();
    person.type("move q1_deg=7\r");
    ASSERT_TRUE(person.sees("ok")) << person.shown();
    person.type("quit\r");
    EXPECT_EQ(person.leave(), 0);
  }
  // What somebody typed is nobody else's.
  const auto kept = std::filesystem::status(folder / ".local" / "state" / "armsig" / "console");
  EXPECT_EQ(kept.permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  Person person(folder);
  ASSERT_TRUE(person.sees("armsig> ")) << person.shown();
  person.type("\x1B[A\x1B[A\r");  // the last line was quit
  EXPECT_TRUE(person.sees("# moves: move q1_deg=7")) << person.shown();
}

TEST(ConsolePerson, says_that_the_controller_has_gone) {
  const Folder folder;
  auto controller = std::make_unique<SmallController>((folder / "console").string());
  Person person(folder);
  ASSERT_TRUE(person.sees("armsig> ")) << person.shown();
  controller.reset();
  EXPECT_TRUE(person.sees("The controller closed the console.")) << person.shown();
  EXPECT_EQ(person.leave(), 1);
}

}  // namespace
}  // namespace armsig::cli
