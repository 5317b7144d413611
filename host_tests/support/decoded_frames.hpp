// SPDX-License-Identifier: MIT
// What tshark, a decoder of CANopen that is not ours, says of the frames of a capture.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace armsig::test {

inline bool have(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

// The fields that tshark prints, empty where it has nothing to say.
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

// All at once: tshark takes half a minute to start under User-Mode Linux. Writes beside `capture`.
inline std::vector<DecodedFrame> decode(const std::string& capture) {
  const std::string decoded = capture + ".decoded";
  const std::string command =
      "tshark -r '" + capture +
      "' -d can.subdissector,canopen -T fields -e canopen -e _ws.malformed"
      " -e _ws.expert.severity -e can.id -e canopen.em.err_code -e _ws.col.Info >'" +
      decoded + "' 2>/dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::vector<DecodedFrame> frames;
  std::ifstream file(decoded);
  for (std::string line; std::getline(file, line);) frames.push_back(decoded_frame(line));
  std::remove(decoded.c_str());
  return frames;
}

inline void expect_canopen_throughout(const std::vector<DecodedFrame>& frames) {
  for (const DecodedFrame& frame : frames) {
    EXPECT_TRUE(frame.is_canopen())
        << frame.id << ' ' << frame.information << ' ' << frame.malformed << ' ' << frame.severity;
  }
}

}  // namespace armsig::test
