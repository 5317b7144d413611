// SPDX-License-Identifier: MIT
// All frames of vcan0 as candump (can-utils) writes them, and what tshark, an independent decoder
// of CANopen, says of them.
#pragma once

#include <cstdlib>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "host_tests/bench/memory_folder.hpp"

namespace armsig::bench {

inline bool have(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

class BusRecording : private MemoryFolder {
 public:
  static bool possible() { return have("tshark") && have("candump"); }

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
  // After end().
  [[nodiscard]] int frames() const { return lines("cat " + log()); }
  [[nodiscard]] int frames_that(const std::string& filter) const {
    return lines(tshark() + "-Y '" + filter + "'");
  }
  void expect_canopen_throughout() const {
    EXPECT_EQ(frames_that("canopen"), frames());
    EXPECT_EQ(frames_that("_ws.malformed || _ws.expert.severity >= \"Warning\""), 0);
    EXPECT_EQ(lines(tshark() + "-T fields -e _ws.col.Info | grep -e Unknown -e Reserved"), 0);
  }

 private:
  static int run(const std::string& command) { return std::system(command.c_str()); }
  [[nodiscard]] std::string log() const { return path + "/candump.log"; }
  [[nodiscard]] std::string tshark() const {
    return "tshark -r " + log() + " -d can.subdissector,canopen ";
  }
  [[nodiscard]] int lines(const std::string& command) const {
    const std::string count = path + "/count";
    EXPECT_EQ(run("{ " + command + "; } 2>/dev/null | wc -l >" + count), 0);
    int lines = -1;
    std::ifstream(count) >> lines;
    return lines;
  }

  bool ended_ = false;
};

}  // namespace armsig::bench
