// SPDX-License-Identifier: MIT
// How late the controller's ticks come and how long they take, beside cyclictest's in the same run;
// no call of the heap and no page fault after the start-up. Times are told and not judged: they are
// those of this computer, now.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/bench/bench_process.hpp"
#include "host_tests/bench/daemon_process.hpp"
#include "host_tests/support/decoded_frames.hpp"

namespace armsig::bench {
namespace {

// What follows ` key=` in `text`, up to the next space.
std::string value_in(const std::string& text, const std::string& key) {
  const std::size_t at = text.find(" " + key + "=");
  if (at == std::string::npos) return "";
  const std::size_t from = at + key.size() + 2;
  return text.substr(from, text.find(' ', from) - from);
}
double number_in(const std::string& text, const std::string& key) {
  const std::string value = value_in(text, key);
  return value.empty() ? -1 : std::strtod(value.c_str(), nullptr);
}

// cyclictest at the same period, beside what is measured.
class Cyclictest : private MemoryFolder {
 public:
  Cyclictest() {
    if (!test::have("cyclictest")) return;
    const std::string command =
        "cyclictest -m -p 79 -i 2000 -l 5000 -q >" + path + "/said 2>&1 & echo $! >" + path + "/id";
    EXPECT_EQ(std::system(command.c_str()), 0);
  }
  // What it says when it is done; that there is none.
  [[nodiscard]] std::string said() const {
    if (!test::have("cyclictest")) return "no cyclictest (Debian: rt-tests)\n";
    const std::string wait = "while kill -0 $(cat " + path + "/id) 2>/dev/null; do sleep 0.1; done";
    EXPECT_EQ(std::system(wait.c_str()), 0);
    std::ifstream file(path + "/said");
    std::string line;
    while (std::getline(file, line) && line.starts_with('#')) {
    }
    return line + "\n";
  }
};

// The counts of a list of bins.
std::vector<long> counts_in(const std::string& text, const std::string& key) {
  std::istringstream list(value_in(text, key));
  std::vector<long> counts;
  for (std::string count; std::getline(list, count, ',');) counts.push_back(std::stol(count));
  return counts;
}

// Bins double: below 1 us, below 2, below 4, ..., and all above.
void print_bins(const std::vector<long>& late, const std::vector<long>& took) {
  std::printf("  below [us]      late      took\n");
  for (std::size_t k = 0; k < std::min(late.size(), took.size()); ++k) {
    if (late[k] == 0 && took[k] == 0) continue;
    const std::string below = k + 1 < late.size() ? std::to_string(1U << k) : "above";
    std::printf("%12s %9ld %9ld\n", below.c_str(), late[k], took[k]);
  }
}

void tell(const std::string& status, const std::string& beside) {
  std::printf("%.0f ticks, late %.1f us on average and %.1f at most, took %.1f and %.1f\n",
              number_in(status, "ticks"), number_in(status, "late_mean_us"),
              number_in(status, "late_max_us"), number_in(status, "exec_mean_us"),
              number_in(status, "exec_max_us"));
  print_bins(counts_in(status, "late_bins"), counts_in(status, "exec_bins"));
  std::printf("cyclictest at the same period: %s", beside.c_str());
}

// Ten moves at the pace of the joints, ticks counted.
void move_and_count(test::ConsoleProcess& daemon) {
  ASSERT_TRUE(daemon.is_in("idle"));
  ASSERT_EQ(daemon.ask("enable"), "ok");
  ASSERT_TRUE(daemon.is_in("holding"));
  const Cyclictest cyclictest;
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(daemon.ask(i % 2 == 0 ? "move q1_deg=60 q2_deg=-60" : "move q1_deg=0 q2_deg=-90"),
              "ok");
    std::this_thread::sleep_for(std::chrono::milliseconds(1200));
    ASSERT_TRUE(daemon.is_in("holding"));
  }
  const std::string status = daemon.ask("status");
  const std::string system = daemon.ask("system");
  tell(status, cyclictest.said());
  std::printf("%s\n", system.c_str());
  EXPECT_GT(number_in(status, "ticks"), 3000);
  EXPECT_EQ(number_in(system, "heap_calls"), 0);
  EXPECT_EQ(number_in(system, "servo_page_faults"), 0);
  EXPECT_EQ(number_in(system, "page_faults"), 0);
}

Changes at_500_hertz() {
  return {{"priority: 0", "priority: 80"}, {"period_ms: 20", "period_ms: 2"}};
}

TEST(Ticks, about_an_emulated_arm_on_the_bus_of_the_kernel) {
  BenchProcess arm({"--target-mm", "150,0,50", "--start-deg", "0,-90,90,30,0,0", "--ping-ms", "15",
                    "--step-us", "500", "--priority", "40"});
  DaemonProcess daemon(at_500_hertz(), arm.sensor_device);
  move_and_count(daemon);
}

TEST(Ticks, about_an_emulated_arm_in_the_same_process) {
  DaemonProcess daemon(at_500_hertz(), "/nonexistent", {"--virtual", "--real-time"});
  move_and_count(daemon);
}

}  // namespace
}  // namespace armsig::bench
