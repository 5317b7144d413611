// SPDX-License-Identifier: MIT
// The emulated arm as a process of its own, started for one test and asked through its console.
#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "host_tests/bench/memory_folder.hpp"
#include "host_tests/support/console_process.hpp"

namespace armsig::bench {

class BenchProcess : private MemoryFolder, public test::ConsoleProcess {
 public:
  explicit BenchProcess(const std::vector<std::string>& options = {})
      : ConsoleProcess(words(path, options), path + "/console"), sensor_device(path + "/sensor") {}

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

 private:
  static std::vector<std::string> words(const std::string& folder,
                                        const std::vector<std::string>& options) {
    std::vector<std::string> words{ARMSIG_BENCH_ARM, "--console", folder + "/console",
                                   "--sensor-device", folder + "/sensor"};
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }

 public:
  const std::string sensor_device;
};

}  // namespace armsig::bench
