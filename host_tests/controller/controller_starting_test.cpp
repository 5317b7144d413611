// SPDX-License-Identifier: MIT
// What is not there when the controller starts is waited for and told; what is wrong is told of
// every joint.
#include <algorithm>

#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using simulated::DriveFault;
using test::PumaCabinet;

long times_told(const PumaCabinet& puma, const std::string& words) {
  return std::ranges::count_if(puma.console.told, [&](const std::string& line) {
    return line.find(words) != std::string::npos;
  });
}

TEST(Starting, waits_for_an_interface_that_is_late) {
  PumaCabinet puma;
  puma.cabinet->master_port().set_up(false);
  puma.run(3);
  EXPECT_EQ(puma.mode(), Mode::kStarting);
  EXPECT_EQ(times_told(puma, "# mode starting error=BUS_DOWN reason="), 1);
  EXPECT_NE(puma.ask("status").find(" mode=starting fault=BUS_DOWN "), std::string::npos);
  puma.cabinet->master_port().set_up(true);
  EXPECT_TRUE(puma.enable());
  EXPECT_EQ(times_told(puma, "# mode faulted"), 0);
  EXPECT_EQ(puma.ask("status").find(" fault="), std::string::npos);
}

TEST(Starting, waits_for_a_drive_that_is_switched_on_late) {
  PumaCabinet puma;
  puma.cabinet->drive(2).inject(DriveFault::kSilent);
  puma.run(15);
  EXPECT_EQ(puma.mode(), Mode::kStarting);
  EXPECT_EQ(times_told(puma, "# mode starting error=DRIVE_ABSENT"), 1) << "however long it takes";
  EXPECT_EQ(times_told(puma,
                       "# mode starting error=DRIVE_ABSENT reason=\"the drive did not "
                       "answer the reset\" joint=3"),
            1);
  EXPECT_NE(puma.ask("status").find(" fault=DRIVE_ABSENT fault_joint=3"), std::string::npos);
  puma.cabinet->drive(2).inject(DriveFault::kNone);
  puma.cabinet->drive(2).inject(DriveFault::kReboot);
  EXPECT_TRUE(puma.enable());
  EXPECT_EQ(times_told(puma, "# mode faulted"), 0);
}

// Its cable is plugged in: it has booted long ago, and says nothing by itself.
TEST(Starting, finds_a_drive_that_was_on_all_the_time) {
  PumaCabinet puma;
  puma.cabinet->drive(4).inject(DriveFault::kSilent);
  puma.run(10);
  ASSERT_EQ(puma.mode(), Mode::kStarting);
  puma.cabinet->drive(4).inject(DriveFault::kNone);
  EXPECT_TRUE(puma.run_until(Mode::kIdle, 10));
  EXPECT_TRUE(puma.enable());
}

TEST(Starting, waits_for_all_drives_and_tells_each) {
  PumaCabinet puma;
  for (std::size_t joint = 0; joint < 6; ++joint) {
    puma.cabinet->drive(joint).inject(DriveFault::kSilent);
  }
  puma.run(10);
  EXPECT_EQ(puma.mode(), Mode::kStarting);
  EXPECT_EQ(times_told(puma, "error=DRIVE_ABSENT"), 6);
  EXPECT_EQ(times_told(puma, "# drive faulted error=DRIVE_ABSENT"), 5);
  EXPECT_NE(puma.ask("status").find(" faulted=1,2,3,4,5,6 "), std::string::npos);
  for (std::size_t joint = 0; joint < 6; ++joint) {
    puma.cabinet->drive(joint).inject(DriveFault::kNone);
  }
  EXPECT_TRUE(puma.enable());
}

TEST(Starting, tells_of_every_drive_that_is_refused) {
  PumaCabinet puma;
  puma.cabinet->drive(1).set_object(0x6502, 0, 0x40);
  puma.cabinet->drive(3).set_object(0x607E, 0, 0x80);
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 5));
  puma.run(2);
  EXPECT_EQ(times_told(puma, "# mode faulted error=DRIVE_WRONG_TYPE"), 1);
  EXPECT_EQ(times_told(puma, " joint=2 object=6502h:0 found=0x40 wanted=0x80"), 1);
  EXPECT_EQ(times_told(puma, "# drive faulted error=SDO_UNEXPECTED_VALUE"), 1);
  EXPECT_EQ(times_told(puma, " joint=4 object=607Eh:0 found=0x80 wanted=0x0"), 1);
  EXPECT_NE(puma.ask("status").find(" faulted=2,4 "), std::string::npos);
  puma.cabinet->drive(1).set_object(0x6502, 0, 0x80);
  puma.cabinet->drive(3).set_object(0x607E, 0, 0);
  EXPECT_EQ(puma.ask("reset"), "ok");
  EXPECT_TRUE(puma.enable());
  EXPECT_EQ(puma.ask("status").find(" faulted="), std::string::npos);
}

TEST(Starting, tells_what_a_drive_says_before_it_is_started_and_later) {
  PumaCabinet puma;
  puma.run(0.02);  // it boots
  puma.cabinet->drive(1).inject(DriveFault::kInformation, 0x3220);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  EXPECT_EQ(times_told(puma, "# drive informs joint=2 code=0x3220 says=\"DC link under-voltage\""),
            1);
  puma.cabinet->drive(1).inject(DriveFault::kInformation, 0xFF01);
  puma.run(0.1);
  EXPECT_EQ(times_told(puma, "# drive informs joint=2 code=0xFF01 says=\"device specific error\""),
            1);
  EXPECT_TRUE(puma.enable());
}

// A drive without its supply stays in a state below Operation enabled.
TEST(Starting, tells_where_a_drive_stays_that_is_not_enabled) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.cabinet->drive(1).inject(DriveFault::kDeaf);
  ASSERT_EQ(puma.ask("enable"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 5));
  EXPECT_EQ(times_told(puma, "# mode faulted error=TRANSITION_TIMEOUT"), 1);
  EXPECT_EQ(times_told(puma,
                       " joint=2 code=0x0240 says=\"Switch on disabled: safe torque off is "
                       "open, or no supply\""),
            1);
}

}  // namespace
}  // namespace armsig::controller
