// SPDX-License-Identifier: MIT
// A process that has a console (armsigd, the emulated arm), as a test starts it, talks to it and
// ends it.
#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/host_tool/console/console_client.hpp"

namespace armsig::test {

class ConsoleProcess {
 public:
  using seconds = std::chrono::seconds;

  // Runs `words`, which make the process open its console at `console_path`.
  ConsoleProcess(std::vector<std::string> words, std::string console_path)
      : words_(std::move(words)), console_path_(std::move(console_path)) {
    start();
  }
  ~ConsoleProcess() {
    if (child_ > 0) {
      EXPECT_EQ(end(SIGTERM), 0);
    }
  }
  ConsoleProcess(const ConsoleProcess&) = delete;
  ConsoleProcess& operator=(const ConsoleProcess&) = delete;

  // Once more, after end().
  void start() {
    std::vector<char*> arguments;
    for (std::string& word : words_) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions{};
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    EXPECT_EQ(::posix_spawn(&child_, arguments[0], &actions, nullptr, arguments.data(), environ),
              0);
    posix_spawn_file_actions_destroy(&actions);
    for (int i = 0; i < 1000 && !console_ && is_alive(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      auto console = tool::ConsoleClient::open(console_path_);
      if (console) console_.emplace(std::move(*console));
    }
    EXPECT_TRUE(console_) << words_[0] << " did not start";
  }
  // The exit status after `signal`; -1 if it was killed by it.
  int end(int signal) {
    console_.reset();
    told_.clear();
    if (child_ <= 0) return -1;  // never started
    ::kill(child_, signal);
    int status = 0;
    EXPECT_EQ(::waitpid(child_, &status, 0), child_);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  // Whether it answers after `signal`.
  bool survives(int signal) {
    return ::kill(child_, signal) == 0 && ask("status").starts_with("ok ");
  }

  // The reply to `request`.
  std::string ask(std::string_view request) {
    if (!console_ || !console_->send(request)) return "gone";
    while (const auto line = console_->receive(seconds(60))) {
      if (tool::is_reply(*line)) return *line;
      told_.push_back(*line);
    }
    return "silent";
  }
  // The next line that it says unasked.
  std::optional<std::string> told(seconds longest) {
    if (told_.empty()) return console_ ? console_->receive(longest) : std::nullopt;
    std::string line = std::move(told_.front());
    told_.pop_front();
    return line;
  }
  // The next unasked line that begins with `words`; those before it are passed over, and shown
  // where it does not come.
  std::optional<std::string> hear(std::string_view words, seconds longest = seconds(120)) {
    std::string others;
    const auto end = std::chrono::steady_clock::now() + longest;
    while (std::chrono::steady_clock::now() < end) {
      const auto line = told(seconds(1));
      if (!line) continue;
      if (line->starts_with(words)) return line;
      if (line->starts_with("# identify ended") || line->starts_with("# touch-grid ended")) break;
      others += *line + "\n";
    }
    ADD_FAILURE() << "no \"" << words << "\" among:\n" << others;
    return std::nullopt;
  }
  // Whether a controller comes into `mode` of its status.
  bool is_in(const std::string& mode, seconds longest = seconds(60)) {
    const auto end = std::chrono::steady_clock::now() + longest;
    std::string status;
    while (std::chrono::steady_clock::now() < end) {
      status = ask("status");
      if (status.find("mode=" + mode + " ") != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    ADD_FAILURE() << "not in mode " << mode << ": " << status;
    return false;
  }
  [[nodiscard]] const std::string& console_path() const { return console_path_; }

 private:
  bool is_alive() {
    if (child_ > 0 && ::waitpid(child_, nullptr, WNOHANG) == child_) child_ = -1;
    return child_ > 0;
  }

  std::vector<std::string> words_;
  std::string console_path_;
  pid_t child_ = -1;
  std::optional<tool::ConsoleClient> console_;
  std::deque<std::string> told_;  // before a reply
};

}  // namespace armsig::test
