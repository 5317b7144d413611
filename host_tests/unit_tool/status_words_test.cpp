// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/status_words.hpp"

#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "firmware/formats/wrapping.hpp"

namespace armsig::tool {
namespace {

TEST(StatusWords, tell_what_the_manual_of_the_drive_explains_of_an_emergency) {
  const std::string words = status_in_words(
      "ok mode=faulted fault=DRIVE_EMERGENCY fault_joint=4 fault_code=0xFF01 "
      "fault_says=\"device specific error\" fault_register=0x21 fault_own=0102030405 moving=no",
      200);
  EXPECT_NE(words.find("device specific error [code 0xFF01] [error register 0x21] "
                       "[maker's bytes 0102030405]"),
            std::string::npos)
      << words;
}

TEST(StatusWords, tells_what_is_wrong_before_the_arm_and_its_model) {
  EXPECT_EQ(
      status_in_words(
          "ok mode=faulted fault=DRIVE_EMERGENCY fault_joint=4 fault_code=0x2310 "
          "fault_says=\"continuous over-current\" moving=no unreferenced=2,3 q1_deg=10.0000 "
          "q2_deg=-20.5000 q3_mm=5.0000 x_mm=1.000 y_mm=2.000 z_mm=3.000 model=signature "
          "signature=3 predicted_tool_error_mm=0.14 predicted_region=limits maps=yes sensor=well "
          "sequence=none check=\"as accepted\" ticks=900 step_max_us=12.0",
          80),
      "  faulted       stopped by a fault; `reset` when its cause is gone\n"
      "  fault         the drive sent an emergency message (DRIVE_EMERGENCY); joint 4:\n"
      "                continuous over-current [code 0x2310]\n"
      "  unreferenced  joints 2,3 may stand elsewhere than they read: look, then\n"
      "                `confirm` each (`help confirm`)\n"
      "  readings      q1 10.0000°     q2 -20.5000°    q3 5.0000 mm\n"
      "  tool          x 1.000 mm, y 2.000 mm, z 3.000 mm\n"
      "  model         signature 3, with gravity and joint error maps; tool error 0.14\n"
      "                mm (1 sigma, predicted) over the joint limits\n"
      "  sensor        reads well\n"
      "  last check    as accepted\n"
      "  ticks         900 since the start\n"
      "  background    longest step 12.0 us\n");
}

TEST(StatusWords, tells_a_sequence_by_its_points_and_the_time_left) {
  const std::string told = status_in_words(
      "ok mode=sweeping moving=yes model=nominal sequence=identifying points=12 planned=144 "
      "left_s=310 sweep=3 axis_sigma_deg=0.00210 ticks=5",
      100);
  EXPECT_NE(
      told.find("  sequence      identification; 12 of 144 points; joint 3 is swept, its axis "
                "known to 0.00210°; 5\n                min 10 s left\n"),
      std::string::npos)
      << told;
}

TEST(StatusWords, says_nothing_of_what_is_not_known) {
  EXPECT_EQ(status_in_words("ok mode=starting moving=no ticks=0", 80),
            "  starting      the drives are set up\n  ticks         0 since the start\n");
}

TEST(StatusWords, drops_no_key_that_it_does_not_know) {
  const std::string told =
      status_in_words("ok mode=idle moving=no novel=12 other=\"two words\" ticks=0", 80);
  EXPECT_NE(told.find("  further       novel=12 other=two words\n"), std::string::npos) << told;
}

TEST(StatusWords, keeps_to_the_width) {
  std::istringstream lines(status_in_words(
      "ok mode=holding moving=yes q1_deg=-179.9999 q2_deg=-179.9999 q3_deg=-179.9999 "
      "q4_deg=-179.9999 q5_deg=-179.9999 q6_deg=-179.9999 q7_mm=-1234.5678 model=signature "
      "signature=12 predicted_tool_error_mm=0.1357 predicted_region=configuration "
      "validation_rms_mm=0.1412 validation_poses=24 air_c=21.5 maps=yes ticks=123456789 "
      "late_mean_us=1.0 late_max_us=20.0 late_bins=1,2 exec_mean_us=30.0 exec_max_us=40.0",
      60));
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    EXPECT_LE(width_of(line), 60U) << line;
  }
  EXPECT_GT(count, 8U);
}

}  // namespace
}  // namespace armsig::tool
