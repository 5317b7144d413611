// SPDX-License-Identifier: MIT
// armsigd as a process of its own against the emulated arm, and its operator.
#pragma once

#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/host_tool/console_client.hpp"

namespace armsig::bench {

// firmware/linux/bench.yaml with `changes` made, each the first of its kind.
inline std::string bench_configuration(
    const std::vector<std::pair<std::string, std::string>>& changes) {
  std::ifstream file(ARMSIG_BENCH_CONFIGURATION);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const auto& [from, to] : changes) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
  }
  return text;
}

class DaemonProcess {
 public:
  using seconds = std::chrono::seconds;

  // In a folder of its own; the sensor's serial line is `sensor_device`.
  DaemonProcess(std::string configuration, const std::string& sensor_device) {
    // Not on the host's file system, which User-Mode Linux borrows and cannot make sockets in.
    std::string name = "/dev/shm/armsigd_XXXXXX";
    EXPECT_NE(::mkdtemp(name.data()), nullptr);
    directory_ = name;
    replace(configuration, "/tmp/armsig-bench/sensor", sensor_device);
    replace(configuration, "/tmp/armsig-bench/console", directory_ + "/console");
    replace(configuration, "/tmp/armsig-bench/signatures", directory_ + "/signatures");
    std::ofstream(directory_ + "/cabinet.yaml") << configuration;
    start();
  }
  ~DaemonProcess() {
    if (child_ > 0) {
      EXPECT_EQ(end(SIGTERM), 0);
    }
    std::filesystem::remove_all(directory_);
  }
  DaemonProcess(const DaemonProcess&) = delete;
  DaemonProcess& operator=(const DaemonProcess&) = delete;

  void start() {
    std::vector<std::string> words{ARMSIG_DAEMON, directory_ + "/cabinet.yaml"};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    EXPECT_EQ(::posix_spawn(&child_, arguments[0], nullptr, nullptr, arguments.data(), environ), 0);
    for (int i = 0; i < 1000 && !console_; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      auto console = tool::ConsoleClient::open(console_path());
      if (console) console_.emplace(std::move(*console));
    }
    EXPECT_TRUE(console_) << "armsigd did not start";
  }
  // The exit status after `signal`; -1 if it was killed by it.
  int end(int signal) {
    console_.reset();
    told_.clear();
    ::kill(child_, signal);
    int status = 0;
    EXPECT_EQ(::waitpid(child_, &status, 0), child_);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  std::string ask(const std::string& request) {
    if (!console_ || !console_->send(request)) return "gone";
    while (const auto line = console_->receive(seconds(30))) {
      if (tool::is_reply(*line)) return *line;
      told_.push_back(*line);
    }
    return "silent";
  }
  // The next unsolicited line that begins with `words`; those before it are passed over, and shown
  // where it does not come.
  std::optional<std::string> hear(const std::string& words, seconds longest = seconds(60)) {
    std::string others;
    const auto end = std::chrono::steady_clock::now() + longest;
    while (std::chrono::steady_clock::now() < end) {
      if (told_.empty()) {
        const auto line = console_ ? console_->receive(seconds(1)) : std::nullopt;
        if (!line) continue;
        told_.push_back(*line);
      }
      const std::string line = told_.front();
      told_.pop_front();
      if (line.starts_with(words)) return line;
      if (line.starts_with("# identify ended") || line.starts_with("# touch-grid ended")) break;
      others += line + "\n";
    }
    ADD_FAILURE() << "no \"" << words << "\" among:\n" << others;
    return std::nullopt;
  }
  bool is_in(const std::string& mode, seconds longest = seconds(60)) {
    const auto end = std::chrono::steady_clock::now() + longest;
    std::string status;
    while (std::chrono::steady_clock::now() < end) {
      status = ask("status");
      if (status.find("mode=" + mode + " ") != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    ADD_FAILURE() << status;
    return false;
  }
  bool enable() { return is_in("idle") && ask("enable") == "ok" && is_in("holding"); }
  // From whatever a fault left, to torque.
  bool recover() {
    for (int i = 0; i < 3; ++i) {
      std::this_thread::sleep_for(seconds(1));
      (void)ask("reset");
      for (int k = 0; k < 200; ++k) {
        const std::string status = ask("status");
        if (status.find("mode=idle ") != std::string::npos) return enable();
        if (status.find("mode=faulted ") != std::string::npos) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
    }
    return enable();
  }
  // Forgets what was told so far.
  void forget() { told_.clear(); }

  [[nodiscard]] std::string console_path() const { return directory_ + "/console"; }
  [[nodiscard]] std::string configuration_path() const { return directory_ + "/cabinet.yaml"; }
  [[nodiscard]] std::string store_path() const { return directory_ + "/signatures"; }

 private:
  static void replace(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
  }

  std::string directory_;
  pid_t child_ = -1;
  std::optional<tool::ConsoleClient> console_;
  std::deque<std::string> told_;  // unsolicited lines that came before a reply
};

}  // namespace armsig::bench
