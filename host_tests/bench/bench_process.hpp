// SPDX-License-Identifier: MIT
// The emulated arm as a process of its own, started for one test and asked through its console.
#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "firmware/host_tool/console_client.hpp"

namespace armsig::bench {

class BenchProcess {
 public:
  explicit BenchProcess(std::vector<std::string> options = {}) {
    // Not on the host's file system, which User-Mode Linux borrows and cannot make sockets in.
    std::string name = "/dev/shm/armsig_bench_XXXXXX";
    EXPECT_NE(::mkdtemp(name.data()), nullptr);
    directory_ = name;
    sensor_device = directory_ + "/sensor";
    console_path = directory_ + "/console";
    std::vector<std::string> words{ARMSIG_BENCH_ARM, "--console", console_path, "--sensor-device",
                                   sensor_device};
    words.insert(words.end(), options.begin(), options.end());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    EXPECT_EQ(::posix_spawn(&child_, arguments[0], nullptr, nullptr, arguments.data(), environ), 0);
    for (int i = 0; i < 1000 && !console_; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      auto console = tool::ConsoleClient::open(console_path);
      if (console) console_.emplace(std::move(*console));
    }
    EXPECT_TRUE(console_) << "the emulated arm did not start";
  }
  ~BenchProcess() {
    console_.reset();
    if (child_ > 0) {
      ::kill(child_, SIGTERM);
      int status = 0;
      EXPECT_EQ(::waitpid(child_, &status, 0), child_);
      EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    std::filesystem::remove_all(directory_);
  }
  BenchProcess(const BenchProcess&) = delete;
  BenchProcess& operator=(const BenchProcess&) = delete;

  std::string ask(const std::string& request) {
    if (!console_ || !console_->send(request)) return "error GONE";
    return console_->receive(std::chrono::seconds(10)).value_or("error SILENT");
  }
  void order(const std::string& request) { EXPECT_EQ(ask(request), "ok") << request; }

  // The numbers after `key`= in the reply to `request`.
  std::vector<double> numbers(const std::string& request, const std::string& key) {
    const std::string reply = ask(request);
    const std::size_t at = reply.find(" " + key + "=");
    std::vector<double> values;
    if (at == std::string::npos) {
      ADD_FAILURE() << reply;
      return values;
    }
    const char* text = reply.c_str() + at + key.size() + 2;
    for (char* end = nullptr;; text = end + 1) {
      values.push_back(std::strtod(text, &end));
      if (end == text || *end != ',') return values;
    }
  }
  Vector3 target_S() {
    const auto p = numbers("status", "target_S");
    return p.size() == 3 ? Vector3(p[0], p[1], p[2]) : Vector3::Zero();
  }

  std::string sensor_device;
  std::string console_path;

 private:
  std::string directory_;
  pid_t child_ = -1;
  std::optional<tool::ConsoleClient> console_;
};

}  // namespace armsig::bench
