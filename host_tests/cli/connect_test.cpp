// SPDX-License-Identifier: MIT
// armsig connect as scripts use it, against a console of this process.
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "hal/linux/socket_console.hpp"
#include "host_tests/cli/run_tool.hpp"

namespace armsig::cli {
namespace {

// A controller that knows three words: "good", "bad", and "mute", to which it never replies.
class Controller {
 public:
  explicit Controller(const std::string& path) {
    auto console = linux_hal::SocketConsole::open(path);
    EXPECT_TRUE(console);
    console_ = std::move(*console);
    thread_ = std::thread([this] { serve(); });
  }
  ~Controller() {
    stop_ = true;
    thread_.join();
  }
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

 private:
  void serve() {
    while (!stop_) {
      if (const auto line = console_->read_line()) {
        if (line->text() == "mute") continue;
        console_->broadcast("# half way");
        const bool good = line->text() == "good";
        (void)console_->write_line(line->client, good ? "ok answer=42" : "error REQUEST no such");
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }

  std::unique_ptr<linux_hal::SocketConsole> console_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

Outcome connect(const Folder& folder, const std::string& requests,
                const std::string& options = "") {
  write_file(folder / "requests", requests);
  const std::string command = "cd '" + folder.path().string() +
                              "' && '" ARMSIG_TOOL "' connect console " + options +
                              " <requests >.out 2>.err";
  const int raw = std::system(command.c_str());  // NOLINT(cert-env33-c): our own command line
  return {WIFEXITED(raw) ? WEXITSTATUS(raw) : -1, read_file(folder / ".out"),
          read_file(folder / ".err")};
}

TEST(Connect, sends_a_request_a_line_and_prints_each_reply) {
  const Folder folder;
  const Controller controller((folder / "console").string());
  const Outcome outcome = connect(folder, "good\n\ngood\n");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.out, "ok answer=42\nok answer=42\n");
  EXPECT_NE(outcome.err.find("# half way"), std::string::npos);
}

TEST(Connect, ends_with_status_1_when_any_reply_was_an_error) {
  const Folder folder;
  const Controller controller((folder / "console").string());
  const Outcome outcome = connect(folder, "bad\ngood\n");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.out, "error REQUEST no such\nok answer=42\n");
}

TEST(Connect, does_not_wait_for_ever) {
  const Folder folder;
  const Controller controller((folder / "console").string());
  const Outcome outcome = connect(folder, "mute\n", "--timeout-s 0.2");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("no reply to \"mute\""), std::string::npos) << outcome.err;
}

TEST(Connect, says_when_there_is_no_controller) {
  const Folder folder;
  const Outcome outcome = connect(folder, "good\n");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("No such file"), std::string::npos) << outcome.err;
}

TEST(Connect, says_where_the_program_of_the_live_page_should_be) {
  const Folder folder;
  std::filesystem::copy_file(ARMSIG_TOOL, folder / "alone");
  const std::string command = "cd '" + folder.path().string() + "' && ./alone connect c --web 2>e";
  const int raw = std::system(command.c_str());  // NOLINT(cert-env33-c): our own command line
  EXPECT_EQ(WIFEXITED(raw) ? WEXITSTATUS(raw) : -1, 2);
  EXPECT_NE(read_file(folder / "e").find("armsig/armsig-web"), std::string::npos);
}

}  // namespace
}  // namespace armsig::cli
