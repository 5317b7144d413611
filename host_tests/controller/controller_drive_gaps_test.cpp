// SPDX-License-Identifier: MIT
// Drives that lack something: what the operator is told, and what is refused until it is known.
#include <algorithm>
#include <array>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using simulated::Access;
using simulated::ObjectEdit;
using test::PumaCabinet;

// No option for a lost master, and a shutdown that is not to be told.
constexpr std::array<ObjectEdit, 2> kGaps{
    {{.object = {0x6007, ObjectEdit::kWhole, 0, Access::kAbsent, 0}},
     {.object = {0x605B, 0, 2, Access::kReadOnly, 0}}}};
// A quick stop that coasts.
constexpr std::array<ObjectEdit, 1> kCoasts{{{.object = {0x605A, 0, 2, Access::kReadOnly, 0}}}};

struct EditedPuma : PumaCabinet {
  explicit EditedPuma(std::span<const ObjectEdit> edits)
      : PumaCabinet(1, test::puma_controller(), drives_with(edits)) {}

  static simulated::DriveConfiguration drives_with(std::span<const ObjectEdit> edits) {
    simulated::DriveConfiguration drive;
    drive.edits = edits;
    return drive;
  }

  [[nodiscard]] long told(const std::string& begin) const {
    return std::ranges::count_if(console.told,
                                 [&](const std::string& line) { return line.starts_with(begin); });
  }
};

TEST(DriveGaps, are_told_once_the_drives_are_set_up) {
  EditedPuma puma(kGaps);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.run(0.1);
  EXPECT_EQ(puma.told("# drive goes_without joint="), 12);
  EXPECT_EQ(puma.told("# drive goes_without joint=1 object=6007h:0 found=none wanted=0x3"), 1);
  EXPECT_EQ(puma.told("# drive goes_without joint=6 object=605Bh:0 found=0x0 wanted=0x1"), 1);
}

TEST(DriveGaps, of_supervision_are_named_and_keep_the_arm_without_torque) {
  EditedPuma puma(kGaps);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.run(0.1);
  EXPECT_EQ(puma.told("# drive unsupervised joints=1,2,3,4,5,6 error=DRIVE_UNSUPERVISED"), 1);
  EXPECT_NE(puma.ask("status").find(" unsupervised=1,2,3,4,5,6 "), std::string::npos);
  EXPECT_TRUE(puma.ask("enable").starts_with("error DRIVE_UNSUPERVISED"));
  EXPECT_EQ(puma.mode(), Mode::kIdle);
}

TEST(DriveGaps, of_a_drive_that_lacks_nothing_are_none) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  EXPECT_EQ(puma.ask("status").find("unsupervised"), std::string::npos);
  for (const std::string& line : puma.console.told) EXPECT_FALSE(line.starts_with("# drive"));
}

TEST(DriveGaps, that_are_unsafe_are_refused_with_joint_object_found_and_wanted) {
  EditedPuma puma(kCoasts);
  ASSERT_TRUE(puma.run_until(Mode::kFaulted));
  puma.run(0.1);
  const std::string status = puma.ask("status");
  EXPECT_NE(status.find(" fault=SDO_ABORTED fault_joint=1 fault_object=605Ah:0 fault_found=0x0 "
                        "fault_wanted=0x6 fault_code=0x06010002 "
                        "fault_says=\"attempt to write a read-only object\""),
            std::string::npos)
      << status;
  EXPECT_EQ(puma.told("# mode faulted error=SDO_ABORTED"), 1);
}

}  // namespace
}  // namespace armsig::controller
