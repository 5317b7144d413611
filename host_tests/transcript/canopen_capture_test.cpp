// SPDX-License-Identifier: MIT
// An independent decoder reads our bus: everything from power-up to a fault and its reset, captured
// and given to tshark's CANopen dissector.
#include <unistd.h>

#include <array>
#include <cstdio>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/canopen/range_sensor.hpp"
#include "hal/simulated/range_node.hpp"
#include "host_tests/support/can_capture.hpp"
#include "host_tests/support/decoded_frames.hpp"
#include "host_tests/support/emulated_arm.hpp"
#include "host_tests/support/puma_drives.hpp"
#include "host_tests/support/range_readings.hpp"

namespace armsig::canopen {
namespace {

using hal::DriveCondition;

std::string output_of(const std::string& command) {
  std::string output;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    output.append(buffer.data(), count);
  }
  pclose(pipe);
  return output;
}

unsigned lines(const std::string& text) {
  unsigned count = 0;
  for (const char c : text) count += c == '\n' ? 1 : 0;
  return count;
}

struct Capture {
  Capture() : path(testing::TempDir() + "canopen_capture_" + std::to_string(getpid()) + ".pcap") {
    RangeNodeConfiguration sensor_node;
    Configuration configuration = test::puma_drives();
    configuration.others[0].nodes.push_back(sensor_node.node);
    for (const auto& frame : traffic(sensor_node, std::chrono::milliseconds(20))) {
      configuration.others[0].traffic.push_back(frame);
    }
    test::CanCapture capture(path);
    RangeSensor sensor(sensor_node);
    test::EmulatedArm arm(configuration, &sensor);
    simulated::VirtualCanPort port;
    simulated::RangeNode range_node(sensor_node.node, port);
    arm.bus.connect(port, &range_node);
    arm.bus.set_watcher(&capture);
    EXPECT_TRUE(arm.power_up_and_enable());
    for (unsigned tick = 0; tick < 200; ++tick) {
      if (tick % 10 == 0) {
        range_node.publish(test::reading(tick / 10, {1.5e-3, 1.6e-3, 0, 1.8e-3}));
      }
      arm.tick();
      const auto reading = sensor.poll(arm.clock.now());
      if (reading && *reading) ++readings;
    }
    arm.drives[2].inject(simulated::DriveFault::kEmergency, 0x2310);
    arm.run(20);
    arm.drives[2].inject(simulated::DriveFault::kNone);
    arm.following = false;
    arm.master->reset_faults();
    EXPECT_TRUE(arm.run_until(DriveCondition::kDisabled));
    frames = capture.frames();
    capture.flush();
  }
  ~Capture() { std::remove(path.c_str()); }
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;

  [[nodiscard]] std::string tshark(const std::string& arguments) const {
    return output_of("tshark -r '" + path + "' -d can.subdissector,canopen " + arguments +
                     " 2>/dev/null");
  }

  std::string path;
  unsigned frames = 0;
  unsigned readings = 0;
};

TEST(CanopenCapture, an_independent_decoder_finds_no_malformed_or_unknown_frame) {
  if (!test::have("tshark")) GTEST_SKIP() << "tshark is not installed";
  const Capture capture;
  EXPECT_GE(capture.readings, 19U);
  const auto frames = test::decode(capture.path);
  EXPECT_EQ(frames.size(), capture.frames);
  test::expect_canopen_throughout(frames);
}

TEST(CanopenCapture, an_independent_decoder_names_every_kind_of_frame_as_we_mean_it) {
  if (!test::have("tshark")) GTEST_SKIP() << "tshark is not installed";
  const Capture capture;
  const std::string summary = capture.tshark("-T fields -e can.id -e _ws.col.Info");
  std::map<unsigned, std::string> kinds;  // by function code, the first summary of each
  std::istringstream stream(summary);
  for (std::string line; std::getline(stream, line);) {
    const unsigned id = static_cast<unsigned>(std::stoul(line));
    kinds.emplace((id & 0x780U) | (id == 0x80 ? 1U : 0U), line.substr(line.find('\t') + 1));
  }
  const auto says = [&](unsigned kind, const char* words) {
    EXPECT_NE(kinds[kind].find(words), std::string::npos) << std::hex << kind << kinds[kind];
  };
  says(0x000, "NMT");
  says(0x081, "SYNC");
  says(0x080, "EMCY");
  says(0x180, "PDO1");
  says(0x200, "PDO1");
  says(0x280, "PDO2");
  says(0x380, "PDO3");
  says(0x580, "SDO");
  says(0x600, "SDO");
  says(0x700, "NMT");
}

TEST(CanopenCapture, an_independent_decoder_reads_the_set_up_and_the_emergency_as_we_wrote_them) {
  if (!test::have("tshark")) GTEST_SKIP() << "tshark is not installed";
  const Capture capture;
  EXPECT_GE(lines(capture.tshark("-Y 'can.id == 0x603 && canopen.sdo.main_idx == 0x60c2'")), 2U);
  EXPECT_EQ(lines(capture.tshark("-Y 'can.id == 0x083 && canopen.em.err_code == 0x2310'")), 1U);
  EXPECT_EQ(lines(capture.tshark("-Y 'can.id == 0x603 && canopen.sdo.main_idx == 0x6060 && "
                                 "canopen.sdo.data.bytes[0] == 08'")),
            1U);
}

}  // namespace
}  // namespace armsig::canopen
