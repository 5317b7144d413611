// SPDX-License-Identifier: MIT
// All frames of vcan0 as candump (can-utils) writes them, and what tshark, an independent decoder
// of CANopen, says of them.
#pragma once

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/bench/memory_folder.hpp"

namespace armsig::bench {

inline bool have(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

// What tshark says of a frame: the fields that it prints, empty where it has nothing to say.
struct DecodedFrame {
  std::string protocol;
  std::string malformed;
  std::string severity;  // of a remark of tshark's on it
  std::string id;
  std::string emergency;
  std::string information;

  [[nodiscard]] bool is_canopen() const {
    return protocol == "canopen" && malformed.empty() && severity.empty() &&
           information.find("Unknown") == std::string::npos &&
           information.find("Reserved") == std::string::npos;
  }
};

inline DecodedFrame decoded_frame(const std::string& line) {
  DecodedFrame frame;
  std::istringstream fields(line);
  for (std::string* field : {&frame.protocol, &frame.malformed, &frame.severity, &frame.id,
                             &frame.emergency, &frame.information}) {
    std::getline(fields, *field, '\t');
  }
  return frame;
}

inline void expect_canopen_throughout(const std::vector<DecodedFrame>& frames) {
  for (const DecodedFrame& frame : frames) {
    EXPECT_TRUE(frame.is_canopen())
        << frame.id << ' ' << frame.information << ' ' << frame.malformed << ' ' << frame.severity;
  }
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
  // Once, after end(): tshark takes half a minute to start under User-Mode Linux.
  std::vector<DecodedFrame> decode() const {
    const std::string decoded = path + "/decoded";
    EXPECT_EQ(run("tshark -r " + log() +
                  " -d can.subdissector,canopen -T fields -e canopen -e _ws.malformed"
                  " -e _ws.expert.severity -e can.id -e canopen.em.err_code -e _ws.col.Info >" +
                  decoded + " 2>/dev/null"),
              0);
    std::vector<DecodedFrame> frames;
    std::ifstream file(decoded);
    for (std::string line; std::getline(file, line);) frames.push_back(decoded_frame(line));
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
