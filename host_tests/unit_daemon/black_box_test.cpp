// SPDX-License-Identifier: MIT
#include "firmware/linux/black_box.hpp"

#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "host_tests/cli/run_tool.hpp"

namespace armsig::daemon {
namespace {

using std::chrono::milliseconds;

// A controller of a revolute and a prismatic joint, a tick every 10 ms: 100 before a fault are
// kept, and 5 after it.
struct Recorded {
  controller::Snapshot tick(controller::Mode mode) {
    controller::Snapshot s;
    s.mode = mode;
    s.now = hal::Instant(milliseconds(10) * ++ticks);
    s.positions = {radians(ticks), 0.001 * ticks};
    s.commanded = {radians(ticks + 0.5), 0.001 * ticks};
    s.status_words.push_back(0x1237);
    s.status_words.push_back(0x0008);
    s.limits_active = 2;
    s.known = known;
    if (mode == controller::Mode::kFaulted) {
      s.fault = controller::Fault{Error::kDriveEmergency, 1, 0x2310, "continuous over-current"};
    }
    return s;
  }
  void run(controller::Mode mode, int count) {
    for (int i = 0; i < count; ++i) box.take(tick(mode), std::chrono::microseconds(1500));
  }
  void fault() {
    run(controller::Mode::kServoing, 150);
    run(controller::Mode::kFaulted, 10);
  }
  [[nodiscard]] std::vector<std::string> last() const {
    std::ifstream file{std::string(box.last_file())};
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
  }
  [[nodiscard]] std::size_t files() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(configuration.folder)) {
      count += entry.is_regular_file() ? 1 : 0;
    }
    return count;
  }

  cli::Folder folder;
  Journal journal;
  BlackBoxConfiguration configuration{.folder = (folder / "box").string(),
                                      .name = "Puma\n560",
                                      .joints = {JointType::kRevolute, JointType::kPrismatic},
                                      .period = milliseconds(10),
                                      .before = milliseconds(1000),
                                      .after = milliseconds(50)};
  BlackBox box{configuration, journal};
  int ticks = 0;
  std::uint8_t known = 3;
};

TEST(BlackBox, leaves_out_what_a_joint_that_was_never_heard_would_read) {
  Recorded r;
  r.known = 2;
  r.fault();
  r.box.write_if_due();
  const auto lines = r.last();
  ASSERT_EQ(lines.size(), 3U + 1 + 105);
  EXPECT_NE(lines.back().find(",1500.0,,,0x1237,0,156.00000,156.00000,0x0008,1"), std::string::npos)
      << lines.back();
}

TEST(BlackBox, writes_the_ticks_before_a_fault_and_some_after_it) {
  Recorded r;
  r.fault();
  EXPECT_EQ(r.box.last_file(), "");
  r.box.write_if_due();
  const auto lines = r.last();
  ASSERT_EQ(lines.size(), 3U + 1 + 105);
  EXPECT_TRUE(lines[0].starts_with("# armsigd black box of Puma?560, written 2")) << lines[0];
  EXPECT_EQ(
      lines[1],
      "# fault: DRIVE_EMERGENCY joint=2 code=0x2310 says=\"continuous over-current\": the drive "
      "sent an emergency message");
  EXPECT_EQ(lines[3],
            "t_s,mode,late_us,q1_deg,q1_commanded_deg,q1_statusword,q1_limited,q2_mm,"
            "q2_commanded_mm,q2_statusword,q2_limited");
  // The fault is seen in tick 151; ticks to 156 are kept, the oldest of 105 is tick 52.
  EXPECT_EQ(lines[4],
            "-0.990000,servoing,1500.0,52.00000,52.50000,0x1237,0,52.00000,52.00000,0x0008,1");
  EXPECT_TRUE(lines[102].starts_with("-0.010000,servoing,")) << lines[102];
  EXPECT_TRUE(lines[103].starts_with("0.000000,faulted,")) << lines[103];
  EXPECT_TRUE(lines.back().starts_with("0.050000,faulted,")) << lines.back();
}

TEST(BlackBox, writes_a_fault_once_and_the_next_one_after_a_reset) {
  Recorded r;
  r.fault();
  r.box.write_if_due();
  r.run(controller::Mode::kFaulted, 300);
  r.box.write_if_due();
  EXPECT_EQ(r.files(), 1U);
  r.fault();
  r.box.write_if_due();
  EXPECT_EQ(r.files(), 2U);
}

TEST(BlackBox, keeps_the_recording_that_is_being_written) {
  Recorded r;
  r.fault();
  r.fault();  // before the first was written
  r.box.write_if_due();
  const auto lines = r.last();
  ASSERT_FALSE(lines.empty());
  EXPECT_NE(lines[4].find(",52.00000,"), std::string::npos) << "of the first fault";
  r.box.write_if_due();
  EXPECT_EQ(r.files(), 1U);
}

TEST(BlackBox, keeps_the_newest_files_only) {
  Recorded r;
  for (std::size_t i = 0; i < BlackBox::kMostFiles + 4; ++i) {
    r.fault();
    r.box.write_if_due();
  }
  EXPECT_EQ(r.files(), BlackBox::kMostFiles);
}

TEST(BlackBox, survives_a_folder_that_cannot_be) {
  Recorded r;
  cli::write_file(r.folder / "box", "a file");
  r.fault();
  r.box.write_if_due();
  EXPECT_EQ(r.box.last_file(), "");
}

// No file of this process becomes longer within its scope: as a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit now{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &now), 0);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_{};
};

TEST(BlackBox, tells_a_disk_that_is_full_leaves_no_part_of_a_file_and_writes_the_next) {
  Recorded r;
  r.fault();
  testing::internal::CaptureStderr();
  {
    const FullDisk disk(4096);
    r.box.write_if_due();
  }
  const std::string told = testing::internal::GetCapturedStderr();
  EXPECT_NE(told.find("-01.csv: File too large\n"), std::string::npos) << told;
  EXPECT_EQ(r.files(), 0U);
  EXPECT_EQ(r.box.last_file(), "");
  r.fault();
  r.box.write_if_due();
  EXPECT_EQ(r.files(), 1U);
}

}  // namespace
}  // namespace armsig::daemon
