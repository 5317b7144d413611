// SPDX-License-Identifier: MIT
// All frames of vcan0 as candump (can-utils) writes them.
#pragma once

#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/bench/memory_folder.hpp"
#include "host_tests/support/decoded_frames.hpp"

namespace armsig::bench {

class BusRecording : private MemoryFolder {
 public:
  static bool possible() { return test::have("tshark") && test::have("candump"); }

  BusRecording() {
    EXPECT_EQ(run("exec candump -L vcan0 >" + log() + " & echo $! >" + path + "/pid"), 0);
  }
  ~BusRecording() { end(); }
  BusRecording(const BusRecording&) = delete;
  BusRecording& operator=(const BusRecording&) = delete;

  // What candump has not written yet it writes when it ends.
  void end() {
    if (ended_) return;
    ended_ = true;
    EXPECT_EQ(run("pid=$(cat " + path +
                  "/pid); kill $pid; for i in $(seq 300); do kill -0 $pid 2>/dev/null || exit 0; "
                  "sleep 0.1; done; exit 1"),
              0);
  }
  // Once, after end().
  [[nodiscard]] std::vector<test::DecodedFrame> decode() const {
    auto frames = test::decode(log());
    EXPECT_EQ(frames.size(), recorded());
    return frames;
  }

 private:
  static int run(const std::string& command) { return std::system(command.c_str()); }
  [[nodiscard]] std::string log() const { return path + "/candump.log"; }
  [[nodiscard]] std::size_t recorded() const {
    std::ifstream file(log());
    std::size_t lines = 0;
    for (std::string line; std::getline(file, line);) ++lines;
    return lines;
  }

  bool ended_ = false;
};

}  // namespace armsig::bench
