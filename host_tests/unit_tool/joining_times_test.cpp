// SPDX-License-Identifier: MIT
// Points and poses that go together by their times: standstills, streams, clocks, dates.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "firmware/host_tool/joining/join.hpp"
#include "host_tests/unit_tool/joining_files.hpp"

namespace armsig::tool {
namespace {

using JoiningByTime = JoiningFiles;

TEST_F(JoiningByTime, by_time_takes_the_nearest_pose_and_only_while_the_arm_stands) {
  joints(
      "Time,A1 [deg],A2 [deg]\n10:00:00.0,1,1\n10:00:00.4,1,1\n10:00:01.0,5,1\n10:00:02.0,9,1\n"
      "10:00:02.3,9,1\n");
  points("Time,X [m],Y [m],Z [m]\n2026-05-12 10:00:00.2,1,2,3\n");
  EXPECT_NE(refusal(JoinBy::kTime).find(":2: a date and time, and in "), std::string::npos)
      << "a date on one side only is another clock";
  points("Time,X [m],Y [m],Z [m]\n10:00:00.2,1,2,3\n10:00:00.8,4,5,6\n10:00:02.2,7,8,9\n");
  JoinSettings settings = settings_by(JoinBy::kTime);
  settings.within_s = 0.45;
  const auto result = joined(settings);
  ASSERT_TRUE(result) << render(result.error());
  ASSERT_EQ(result->rows.size(), 2U);  // at 00.8 the arm was on its way
  EXPECT_DOUBLE_EQ(result->rows[1].q[0], radians(9));
  EXPECT_EQ(result->points_left, std::vector<std::size_t>{3});
}

TEST_F(JoiningByTime, a_time_that_is_not_asked_for_may_be_anything) {
  joints("Name;Time;A1 [deg];A2 [deg]\nP1;yesterday;10;20\n");
  points("Name,Time,X [m],Y [m],Z [m]\nP1,4/12/2026 9:00 AM,1,2,3\n");
  EXPECT_TRUE(joined(JoinBy::kName));
  EXPECT_NE(refusal(JoinBy::kTime).find(":2: \"yesterday\"; expected seconds, HH:MM:SS (AM or PM)"),
            std::string::npos);
}

// The arm stands at 0 to 10 s and 20 to 30 s; the point wanders about a mean while it stands.
std::string stream_log() {
  std::string log = "Time [s];A1 [deg];A2 [deg]\n";
  for (int k = 0; k <= 30; ++k) {
    const double q1 = k <= 10 ? 10 : k < 20 ? 10 + 2 * (k - 10) : 30;
    log += std::to_string(k) + ";" + std::to_string(q1) + ";20\n";
  }
  return log;
}
std::string stream_points(double offset_s, double creep_m) {
  std::string text = "Time [s];X [m];Y [m];Z [m]\n";
  for (int k = 0; k <= 300; ++k) {
    const double at_s = 0.1 * k;
    const double x = at_s <= 10 ? 1 : at_s < 20 ? 1 + 0.1 * (at_s - 10) : 2 + creep_m * (at_s - 20);
    const double wander = k % 2 == 0 ? 1e-5 : -1e-5;
    text += std::to_string(at_s + offset_s) + ";" + std::to_string(x + wander) + ";2;3\n";
  }
  return text;
}

TEST_F(JoiningByTime, a_stream_of_points_is_averaged_while_the_arm_stands) {
  joints(stream_log());
  points(stream_points(0, 0));
  const auto result = joined(JoinBy::kStandstill);
  ASSERT_TRUE(result) << render(result.error());
  ASSERT_EQ(result->rows.size(), 2U);
  EXPECT_NEAR(result->rows[0].p_S->x(), 1, 2e-7);
  EXPECT_NEAR(result->rows[1].p_S->x(), 2, 2e-7);
  EXPECT_DOUBLE_EQ(result->rows[1].q[0], radians(30));
  // 0.5 to 9.5 s, and 20.5 to 29.5 s.
  EXPECT_EQ(result->averaged, 182U);
  EXPECT_EQ(result->moving, 0U);
  // The reflector moves while the arm stands.
  points(stream_points(0, 0.01));
  const auto creeping = joined(JoinBy::kStandstill);
  ASSERT_TRUE(creeping) << render(creeping.error());
  EXPECT_EQ(creeping->rows.size(), 1U);
  EXPECT_EQ(creeping->moving, 1U);
}

// Standstills of 4 to 6 s, at intervals that are not even; a point in the midst of each.
struct UnevenStops {
  std::string log = "Time [s];A1 [deg];A2 [deg]\n";
  std::string points = "Time [s];X [m];Y [m];Z [m]\n";

  UnevenStops(int stops, bool even, double clock_s) {
    double at_s = 0;
    for (int k = 0; k < stops; ++k) {
      const double stand_s = even ? 5 : 4 + (k * 7 % 5) / 2.0;
      for (double s = 0; s <= stand_s; s += 0.5) {
        log += std::to_string(at_s + s) + ";" + std::to_string(10 * k) + ";20\n";
      }
      points += std::to_string(at_s + stand_s / 2 + clock_s) + ";" + std::to_string(k) + ";2;3\n";
      at_s += stand_s + (even ? 5 : 3 + k * 5 % 7);
    }
  }
};

TEST_F(JoiningByTime, standstills_tell_the_offset_of_two_clocks) {
  const UnevenStops stops(12, false, 3600);
  joints(stops.log);
  points(stops.points);
  const std::string said = refusal(JoinBy::kTime);
  const std::string option = "--clock-offset-s ";
  const std::size_t at = said.find(option);
  ASSERT_NE(at, std::string::npos) << said;
  EXPECT_NE(said.find("12 of 12 points are in a standstill"), std::string::npos) << said;
  JoinSettings settings = settings_by(JoinBy::kTime);
  settings.clock_offset_s = std::stod(said.substr(at + option.size()));
  // Typed as told, each point goes with its pose.
  const auto result = joined(settings);
  ASSERT_TRUE(result) << render(result.error());
  ASSERT_EQ(result->rows.size(), 12U);
  EXPECT_EQ(result->clock_doubt, "");
  for (int k = 0; k < 12; ++k)
    EXPECT_NEAR(result->rows[static_cast<std::size_t>(k)].q[0], radians(10 * k), 1e-12);
}

TEST_F(JoiningByTime, even_standstills_tell_the_offset_only_where_each_has_its_point) {
  const UnevenStops stops(6, true, 100);
  joints(stops.log);
  points(stops.points);
  EXPECT_NE(refusal(JoinBy::kTime).find("--clock-offset-s -100.000 6 of 6"), std::string::npos);
  // The first and the last have none: the others may be shifted by one.
  std::string some = stops.points;
  some.erase(some.rfind('\n', some.size() - 2) + 1);
  some.erase(some.find('\n') + 1, some.find('\n', some.find('\n') + 1) - some.find('\n'));
  points(some);
  EXPECT_EQ(refusal(JoinBy::kTime).find("--clock-offset-s"), std::string::npos);
}

TEST_F(JoiningByTime, a_small_offset_of_clocks_is_warned_of) {
  // Three seconds: some points are still in their standstills.
  const UnevenStops stops(12, false, 3);
  joints(stops.log);
  points(stops.points);
  const auto result = joined(JoinBy::kTime);
  ASSERT_TRUE(result) << render(result.error());
  EXPECT_LT(result->rows.size(), 12U);
  EXPECT_NE(result->clock_doubt.find("12 of 12 points"), std::string::npos) << result->clock_doubt;
}

TEST_F(JoiningByTime, times_of_day_go_on_after_midnight) {
  joints(
      "Time;A1 [deg];A2 [deg]\n23:59:58;10;20\n23:59:59;10;20\n00:00:00;10;20\n"
      "00:00:10;30;40\n00:00:11;30;40\n");
  points("Time;X [m];Y [m];Z [m]\n23:59:59;1;2;3\n00:00:10.5;4;5;6\n");
  const auto both = joined(JoinBy::kTime);
  ASSERT_TRUE(both) << render(both.error());
  ASSERT_EQ(both->rows.size(), 2U);
  EXPECT_DOUBLE_EQ(both->rows[1].q[0], radians(30));
  // All points after midnight: a day later than where the log begins.
  points("Time;X [m];Y [m];Z [m]\n00:00:10.5;4;5;6\n");
  const auto after = joined(JoinBy::kTime);
  ASSERT_TRUE(after) << render(after.error());
  EXPECT_DOUBLE_EQ(after->rows[0].q[0], radians(30));
}

TEST_F(JoiningByTime, a_clock_that_was_set_back_is_refused) {
  // 26 October 2025, end of summer time.
  joints("Time;A1 [deg];A2 [deg]\n2025-10-26 02:59:59;10;20\n2025-10-26 02:00:00;30;40\n");
  points("Time;X [m];Y [m];Z [m]\n2025-10-26 02:00:00;1;2;3\n");
  EXPECT_NE(refusal(JoinBy::kTime)
                .find(":3: the time goes back by 3599.000 s from line 2 to this "
                      "one; expected rows in the order of time; times with Z"),
            std::string::npos);
}

TEST_F(JoiningByTime, dates_have_columns_of_their_own_and_tell_their_order) {
  joints("Date;Time;A1 [deg];A2 [deg]\n12/05/2026;10:00:00;10;20\n13/05/2026;10:00:00;30;40\n");
  points("Date;Time;X [m];Y [m];Z [m]\n13/05/2026;10:00:00;1;2;3\n");
  const auto result = joined(JoinBy::kTime);
  ASSERT_TRUE(result) << render(result.error());
  EXPECT_DOUBLE_EQ(result->rows[0].q[0], radians(30));
  joints("Date;Time;A1 [deg];A2 [deg]\n13/05/2026;10:00:00;10;20\n05/13/2026;10:00:00;30;40\n");
  EXPECT_NE(refusal(JoinBy::kTime)
                .find(":3: \"05/13/2026 10:00:00\" is of another order of day and "
                      "month than the rows before"),
            std::string::npos);
}

TEST_F(JoiningByTime, times_of_a_column_are_of_one_kind_and_of_its_unit) {
  points("Time;X [m];Y [m];Z [m]\n10:00:00;1;2;3\n");
  joints("Time;A1 [deg];A2 [deg]\n10:00:00;10;20\n10:00:01Z;10;20\n");
  EXPECT_NE(refusal(JoinBy::kTime)
                .find(":3: \"10:00:01Z\" is a time of day with its offset from UTC, "
                      "the time of line 2 a time of day"),
            std::string::npos);
  joints("Time [s];A1 [deg];A2 [deg]\n10:00:00;10;20\n");
  EXPECT_NE(refusal(JoinBy::kTime).find(":2: \"10:00:00\"; expected a number"), std::string::npos);
  joints("Time;A1 [deg];A2 [deg]\n1570000000000000000;10;20\n");
  EXPECT_NE(refusal(JoinBy::kTime).find("is no time in seconds; expected its unit in the header"),
            std::string::npos);
  joints("Time;A1 [deg];A2 [deg]\n13:00:00 garbage;10;20\n");
  EXPECT_NE(refusal(JoinBy::kTime).find(":2: \"13:00:00 garbage\"; expected"), std::string::npos);
}

}  // namespace
}  // namespace armsig::tool
