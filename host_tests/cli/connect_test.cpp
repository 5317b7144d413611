// SPDX-License-Identifier: MIT
// armsig connect as scripts use it, against a console of this process.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
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

// A controller that knows four words: "good", "bad", "mute", to which it never replies, and
// "status", by which nothing is under way from the third on.
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
        if (line->text() == "status") {
          const bool ended = ++asked_ >= 3;
          if (ended) console_->broadcast("# identify done");
          (void)console_->write_line(line->client,
                                     ended ? "ok mode=holding moving=no sequence=none"
                                           : "ok mode=sweeping moving=yes sequence=identifying");
          continue;
        }
        console_->broadcast("# half way");
        const bool good = line->text() == "good";
        (void)console_->write_line(line->client, good ? "ok answer=42" : "error REQUEST no such");
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }

  std::unique_ptr<linux_hal::SocketConsole> console_;
  std::atomic<bool> stop_{false};
  int asked_ = 0;
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

TEST(Connect, takes_one_request_from_the_command_line) {
  const Folder folder;
  const Controller controller((folder / "console").string());
  const Outcome good = run_tool(folder, "connect console good");
  EXPECT_EQ(good.status, 0);
  EXPECT_EQ(good.out, "ok answer=42\n");
  const Outcome bad = run_tool(folder, "connect console bad q1_deg=10");
  EXPECT_EQ(bad.status, 1);
  EXPECT_EQ(bad.out, "error REQUEST no such\n");
  const Outcome mute = run_tool(folder, "connect console mute --timeout-s 0.2");
  EXPECT_EQ(mute.status, 1);
  EXPECT_NE(mute.err.find("no reply to \"mute\""), std::string::npos) << mute.err;
}

TEST(Connect, gives_the_one_reply_to_a_program_too) {
  const Folder folder;
  const Controller controller((folder / "console").string());
  const Outcome outcome = run_tool(folder, "connect console bad --json");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.out.find("\"reply\": \"error REQUEST no such\""), std::string::npos)
      << outcome.out;
  EXPECT_NE(outcome.out.find("\"status\": 1"), std::string::npos) << outcome.out;
}

TEST(Connect, waits_until_the_sequence_has_ended) {
  const Folder folder;
  const Controller controller((folder / "console").string());
  const Outcome outcome = run_tool(folder, "connect console wait timeout_s=60");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.out, "ok identify done\n");
}

TEST(Connect, waits_for_what_its_request_began) {
  const Folder folder;
  const Controller controller((folder / "console").string());
  const Outcome outcome = run_tool(folder, "connect console good --wait");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.out, "ok identify done\n");
  const Outcome refused = run_tool(folder, "connect console bad --wait");
  EXPECT_EQ(refused.status, 1);
  EXPECT_EQ(refused.out, "error REQUEST no such\n");
}

TEST(Connect, waits_in_a_script_of_several_requests) {
  const Folder folder;
  const Controller controller((folder / "console").string());
  const Outcome outcome = connect(folder, "good\nwait\ngood\n");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.out, "ok answer=42\nok identify done\nok answer=42\n");
}

TEST(Connect, waits_no_longer_than_it_is_told) {
  const Folder folder;
  const Controller controller((folder / "console").string());
  const Outcome outcome = run_tool(folder, "connect console wait timeout_s=0.1");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.out, "error it is still under way after timeout_s\n");
  const Outcome wrong = connect(folder, "wait forever\nwait timeout_s=-1\nwait timeout_s=1 2\n");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_EQ(std::ranges::count(wrong.out, '\n'), 3) << wrong.out;
  EXPECT_EQ(wrong.out.find("ok"), std::string::npos) << wrong.out;
}

TEST(Connect, refuses_what_does_not_go_together) {
  const Folder folder;
  const Controller controller((folder / "console").string());
  for (const char* words :
       {"fetch", "send", "fetch a b", "status --what log", "--wait", "fetch a.yaml --wait",
        "status --web", "status --wait-s 3", "'status\nstop'"}) {
    const Outcome outcome = run_tool(folder, std::string("connect console ") + words);
    EXPECT_EQ(outcome.status, 2) << words << outcome.err;
  }
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
