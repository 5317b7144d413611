// SPDX-License-Identifier: MIT
// armsigd as a process of its own against the emulated arm, and its operator.
#pragma once

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/bench/memory_folder.hpp"
#include "host_tests/support/console_process.hpp"

namespace armsig::bench {

using Changes = std::vector<std::pair<std::string, std::string>>;

// firmware/linux/bench.yaml with `changes` made, each the first of its kind.
inline std::string bench_configuration(const Changes& changes) {
  std::ifstream file(ARMSIG_BENCH_CONFIGURATION);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const auto& [from, to] : changes) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
  }
  return text;
}

class DaemonProcess : private MemoryFolder, public test::ConsoleProcess {
 public:
  // In a folder of its own; the sensor's serial line is `sensor_device`.
  DaemonProcess(const Changes& changes, const std::string& sensor_device,
                const std::vector<std::string>& options = {})
      : ConsoleProcess(words(path, changes, sensor_device, options), path + "/console") {}

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
  // A whole identification. On a loaded host User-Mode Linux may starve the sensor's process for
  // seconds: the sequence pauses, and its operator, who has looked, resumes it.
  bool identify(seconds longest, const std::string& request = "identify") {
    identifying_.clear();
    EXPECT_EQ(ask(request), "ok");
    const auto end = std::chrono::steady_clock::now() + longest;
    std::string last;
    for (int pauses = 0; pauses <= 5 && std::chrono::steady_clock::now() < end;) {
      const auto line = told(seconds(1));
      if (!line) continue;
      last = *line;
      identifying_.push_back(last);
      if (last.starts_with("# identify done")) return true;
      if (last.starts_with("# identify ended")) break;
      if (!last.starts_with("# identify paused")) continue;
      std::printf("%s\n", last.c_str());
      ++pauses;
      EXPECT_EQ(ask("resume"), "ok");
    }
    ADD_FAILURE() << "not identified: " << last;
    return false;
  }

  // The last line that began with `words` while it identified; empty: none.
  [[nodiscard]] std::string heard(std::string_view words) const {
    const auto line = std::find_if(identifying_.rbegin(), identifying_.rend(),
                                   [&](const std::string& l) { return l.starts_with(words); });
    return line == identifying_.rend() ? "" : *line;
  }

  [[nodiscard]] std::string configuration_path() const { return path + "/cabinet.yaml"; }

 private:
  static std::vector<std::string> words(const std::string& folder, const Changes& changes,
                                        const std::string& sensor_device,
                                        const std::vector<std::string>& options) {
    std::string configuration = bench_configuration(changes);
    replace(configuration, "/tmp/armsig-bench/sensor", sensor_device);
    replace(configuration, "/tmp/armsig-bench/console", folder + "/console");
    replace(configuration, "/tmp/armsig-bench/signatures", folder + "/signatures");
    std::ofstream(folder + "/cabinet.yaml") << configuration;
    std::vector<std::string> words{ARMSIG_DAEMON, folder + "/cabinet.yaml"};
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }
  static void replace(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
  }

  std::vector<std::string> identifying_;  // what it said
};

}  // namespace armsig::bench
