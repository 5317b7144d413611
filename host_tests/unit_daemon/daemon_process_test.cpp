// SPDX-License-Identifier: MIT
// armsigd as its operator meets it: --check, and a whole identification about the emulated arm.
#include <fcntl.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/host_tool/console_client.hpp"
#include "host_tests/cli/run_tool.hpp"

namespace armsig::cli {
namespace {

using std::chrono::seconds;

Outcome run_daemon(const Folder& folder, const std::string& arguments) {
  const std::string command = "cd '" + folder.path().string() +
                              "' && timeout 20 '" ARMSIG_DAEMON "' " + arguments +
                              " >.out 2>.err </dev/null";
  const int raw = std::system(command.c_str());  // NOLINT(cert-env33-c): our own command line
  return {WIFEXITED(raw) ? WEXITSTATUS(raw) : -1, read_file(folder / ".out"),
          read_file(folder / ".err")};
}

// armsigd --virtual, as fast as it goes, with console and store in the folder.
class VirtualDaemon {
 public:
  explicit VirtualDaemon(const Folder& folder, const std::string& speed = "0")
      : console_path_((folder / "console").string()) {
    const std::string store = (folder / "store").string();
    std::vector<std::string> words{ARMSIG_DAEMON, ARMSIG_REFERENCE, "--virtual",
                                   "--console",   console_path_,    "--store",
                                   store,         "--speed",        speed};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions{};
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    EXPECT_EQ(::posix_spawn(&child_, arguments[0], &actions, nullptr, arguments.data(), environ),
              0);
    posix_spawn_file_actions_destroy(&actions);
    for (int i = 0; i < 600 && !console_; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      auto opened = tool::ConsoleClient::open(console_path_);
      if (opened) console_.emplace(std::move(*opened));
    }
    EXPECT_TRUE(console_) << "armsigd did not start";
  }
  ~VirtualDaemon() { end(SIGTERM); }
  VirtualDaemon(const VirtualDaemon&) = delete;
  VirtualDaemon& operator=(const VirtualDaemon&) = delete;

  // The exit status after `signal`; -1 if it was killed.
  int end(int signal) {
    if (child_ <= 0) return -1;
    ::kill(child_, signal);
    int status = 0;
    EXPECT_EQ(::waitpid(child_, &status, 0), child_);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string ask(const std::string& request) {
    if (!console_ || !console_->send(request)) return "gone";
    while (const auto line = console_->receive(seconds(60))) {
      if (tool::is_reply(*line)) return *line;
    }
    return "silent";
  }
  // Whether the controller says `words` unasked, or has said them.
  bool hears(const std::string& words, seconds longest = seconds(120)) {
    const auto end = std::chrono::steady_clock::now() + longest;
    while (console_ && std::chrono::steady_clock::now() < end) {
      const auto line = console_->receive(seconds(1));
      if (line && line->starts_with(words)) return true;
    }
    return false;
  }
  bool is_in(const std::string& mode) {
    for (int i = 0; i < 600; ++i) {
      if (ask("status").find("mode=" + mode + " ") != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }
  [[nodiscard]] const std::string& console_path() const { return console_path_; }

 private:
  std::string console_path_;
  pid_t child_ = -1;
  std::optional<tool::ConsoleClient> console_;
};

TEST(Daemon, checks_a_configuration_without_opening_anything) {
  const Folder folder;
  const Outcome outcome = run_daemon(folder, "--check '" ARMSIG_REFERENCE "'");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("6 joints at 500 Hz on can0"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("252 vertices"), std::string::npos) << outcome.out;
}

TEST(Daemon, refuses_a_wrong_configuration_with_its_place_and_status_2) {
  const Folder folder;
  std::string text = read_file(ARMSIG_REFERENCE);
  text.replace(text.find("node: 2"), 7, "node: 1");
  write_file(folder / "cabinet.yaml", text);
  for (const char* option : {"--check", "--virtual", ""}) {
    const Outcome outcome = run_daemon(folder, std::string("cabinet.yaml ") + option);
    EXPECT_EQ(outcome.status, 2) << option;
    EXPECT_NE(outcome.err.find("cabinet.yaml:"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("node 1"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << "one line, please";
  }
}

TEST(Daemon, says_what_it_cannot_open) {
  const Folder folder;
  const Outcome outcome =
      run_daemon(folder, "'" ARMSIG_REFERENCE "' --store /nonexistent/store --console ./console");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("/nonexistent/store"), std::string::npos) << outcome.err;
}

TEST(Daemon, has_a_console_for_its_group_and_nobody_else) {
  const Folder folder;
  VirtualDaemon daemon(folder);
  struct stat status{};
  ASSERT_EQ(::stat(daemon.console_path().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0660U);
  EXPECT_EQ(daemon.end(SIGTERM), 0);
}

TEST(Daemon, answers_armsig_connect) {
  const Folder folder;
  VirtualDaemon daemon(folder, "1");
  ASSERT_TRUE(daemon.is_in("idle"));
  write_file(folder / "requests", "status\nmove q1_deg=5\n");
  const std::string command = "cd '" + folder.path().string() +
                              "' && '" ARMSIG_TOOL "' connect console <requests >.out 2>.err";
  const int raw = std::system(command.c_str());  // NOLINT(cert-env33-c): our own command line
  EXPECT_EQ(WEXITSTATUS(raw), 1);
  const std::string out = read_file(folder / ".out");
  EXPECT_TRUE(out.starts_with("ok mode=idle")) << out;
  EXPECT_NE(out.find("\nerror WRONG_MODE "), std::string::npos) << out;
}

TEST(Daemon, identifies_the_emulated_arm_and_knows_it_after_it_was_killed) {
  const Folder folder;
  {
    VirtualDaemon daemon(folder);
    ASSERT_TRUE(daemon.is_in("idle"));
    EXPECT_EQ(daemon.ask("signature"), "ok model=drawing");
    EXPECT_EQ(daemon.ask("enable"), "ok");
    ASSERT_TRUE(daemon.is_in("holding"));
    EXPECT_EQ(daemon.ask("identify"), "ok");
    ASSERT_TRUE(daemon.hears("# identify done"));
    ASSERT_TRUE(daemon.is_in("holding"));
    EXPECT_NE(daemon.ask("candidate").find("better=yes"), std::string::npos);
    EXPECT_EQ(daemon.ask("accept"), "ok");
    EXPECT_TRUE(daemon.ask("signature").starts_with("ok model=signature sequence=1"));
    daemon.end(SIGKILL);
  }
  VirtualDaemon daemon(folder);
  EXPECT_TRUE(daemon.ask("signature").starts_with("ok model=signature sequence=1"));
  EXPECT_EQ(daemon.end(SIGTERM), 0);
}

}  // namespace
}  // namespace armsig::cli
