// SPDX-License-Identifier: MIT
// A controller's joint log and a tracker's points, put together.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "firmware/formats/encoding.hpp"
#include "firmware/formats/foreign_mapping.hpp"
#include "firmware/host_tool/joining/join.hpp"
#include "host_tests/support/peak_memory.hpp"
#include "host_tests/unit_tool/joining_files.hpp"

namespace armsig::tool {
namespace {

using Joining = JoiningFiles;

constexpr const char* kLog = "Name;A1 [deg];A2 [deg]\nP1;10;20\nP2;30;40\nP3;50;60\n";

TEST_F(Joining, by_name_takes_spatial_analyzer_text) {
  joints(kLog);
  points(
      "// exported by SpatialAnalyzer\n"
      "A Sweep1 P3 1000.5 2.0 -3.0\n\"A\" \"Sweep1\" P1 1.0 2.0 3.0\n");
  const auto result = joined(JoinBy::kName, "mm");
  ASSERT_TRUE(result) << render(result.error());
  ASSERT_EQ(result->rows.size(), 2U);
  EXPECT_EQ(result->rows[0].p_S, Vector3(1.0005, 0.002, -0.003));
  EXPECT_DOUBLE_EQ(result->rows[0].q[0], radians(50));
  EXPECT_DOUBLE_EQ(result->rows[1].q[1], radians(20));
  EXPECT_EQ(result->rows[0].target, 7);
  EXPECT_EQ(result->poses_left, 1U);
}

TEST_F(Joining, takes_commas_semicolons_tabs_and_blanks_and_drops_empty_columns_at_the_end) {
  joints(kLog);
  for (const char* text :
       {"C,G,P1,1,2,3,,\n", "C;G;P1;1;2;3;;\n", "C\tG\tP1\t1\t2\t3\t\n", "C G P1 1 2 3  \n"}) {
    points(text);
    const auto result = joined(JoinBy::kName, "m");
    ASSERT_TRUE(result) << text << render(result.error());
    ASSERT_EQ(result->rows.size(), 1U) << text;
    EXPECT_EQ(result->rows[0].p_S, Vector3(1, 2, 3)) << text;
  }
}

TEST_F(Joining, takes_a_header_with_units_and_decimal_commas) {
  joints(kLog);
  points("Point;X [mm];Y [mm];Z [mm]\nP2;1000,5;2,0;3,0\n");
  const auto result = joined(JoinBy::kName);
  ASSERT_TRUE(result) << render(result.error());
  EXPECT_EQ(result->rows[0].p_S, Vector3(1.0005, 0.002, 0.003));
}

TEST(Encoding, of_text_without_a_mark_is_told_by_its_zeros) {
  const auto wide = [](std::string_view text, bool little_endian) {
    std::string bytes;
    for (const char c : text) {
      if (!little_endian) bytes += '\0';
      bytes += c;
      if (little_endian) bytes += '\0';
    }
    return bytes;
  };
  const std::string text = "Name;A1 [deg]\nP1;10\n";
  EXPECT_EQ(in_utf8(wide(text, true)), text);
  EXPECT_EQ(in_utf8(wide(text, false)), text);
  // Neither text of UTF-8, be it short, nor bytes that happen to have a zero.
  for (const std::string_view other :
       {std::string_view(""), std::string_view("a"), std::string_view("a,b\0c\n", 6),
        std::string_view("\0\0\0\0", 4)}) {
    EXPECT_FALSE(is_utf16(other));
  }
}

TEST_F(Joining, takes_utf_16_with_names_beyond_the_basic_plane) {
  EXPECT_EQ(in_utf8(std::string_view("\xFF\xFE"
                                     "A\0\x3D\xD8\x00\xDE",
                                     8)),
            "A\xF0\x9F\x98\x80");
  EXPECT_EQ(in_utf8(std::string_view("\xFE\xFF\0B\x20\xAC", 6)), "B\xE2\x82\xAC");
  EXPECT_EQ(in_utf8("\xEF\xBB\xBF"
                    "C"),
            "C");
  EXPECT_FALSE(
      in_utf8(std::string_view("\xFF\xFE"
                               "A",
                               3)));
  EXPECT_FALSE(in_utf8(std::string_view("\xFF\xFE\x00\xDE", 4)));
}

TEST_F(Joining, numbers_as_names_are_names) {
  joints("Point,q1_deg,q2_deg\n1,10,20\n2,30,40\n");
  points("2 1.0 2.0 3.0\n1 4.0 5.0 6.0\n");
  const auto result = joined(JoinBy::kName, "m");
  ASSERT_TRUE(result) << render(result.error());
  EXPECT_DOUBLE_EQ(result->rows[0].q[0], radians(30));
  EXPECT_EQ(result->rows[1].p_S, Vector3(4, 5, 6));
}

TEST_F(Joining, units_stated_once_hold_for_columns_without) {
  joints("Name A1 A2\nP1 0.5 1.5\n");
  points("Name X Y Z\nP1 100 200 300\n");
  const auto result = joined(JoinBy::kName, "rad,mm");
  ASSERT_TRUE(result) << render(result.error());
  EXPECT_DOUBLE_EQ(result->rows[0].q[1], 1.5);
  EXPECT_EQ(result->rows[0].p_S, Vector3(0.1, 0.2, 0.3));
}

TEST_F(Joining, by_order_wants_as_many_of_both) {
  joints(kLog);
  points("1.0 2.0 3.0\n1.0 2.0 3.0\n1.0 2.0 3.5\n");
  const auto result = joined(JoinBy::kOrder, "m");
  ASSERT_TRUE(result) << render(result.error());
  EXPECT_DOUBLE_EQ(result->rows[2].q[0], radians(50));
  points("1.0 2.0 3.0\n1.0 2.0 3.0\n");
  EXPECT_NE(refusal(JoinBy::kOrder, "m").find("2 points for 3 poses"), std::string::npos);
}

TEST_F(Joining, finds_the_header_below_the_titles_of_a_report) {
  joints("Robot cell 7;;\nRun;12;\n\nName;A1 [deg];A2 [deg]\nP1;10;20\n");
  points(
      "CAM2 Report\r\nCreated:\t2026-04-12\r\n\r\nName\tX (mm)\tY (mm)\tZ (mm)\tRMS\t\t\r\n"
      "P1\t1000\t2000\t3000\t0.01\t\t\r\n");
  const auto result = joined(JoinBy::kName);
  ASSERT_TRUE(result) << render(result.error());
  ASSERT_EQ(result->rows.size(), 1U);
  EXPECT_DOUBLE_EQ(result->rows[0].q[1], radians(20));
  EXPECT_EQ(*result->rows[0].p_S, Vector3(1, 2, 3));
  std::string titles;
  for (std::size_t k = 0; k < kLongestPreamble; ++k) titles += "a title\n";
  points(titles + "Name X Y Z\nP1 1 2 3\n");
  EXPECT_NE(refusal(JoinBy::kName, "mm").find("no header with x, y, z"), std::string::npos);
}

TEST_F(Joining, says_what_both_files_call_their_points) {
  joints(kLog);
  points("p1 1 2 3\n");
  const std::string said = refusal(JoinBy::kName, "mm");
  EXPECT_NE(said.find("the first is \"p1\", the first pose \"P1\"; expected one name"),
            std::string::npos)
      << said;
}

TEST_F(Joining, names_the_cure_for_a_file_of_an_old_code_page) {
  joints(kLog);
  points(
      "Name;X [mm];Y [mm];Z [mm];Temp [\xB0"
      "C]\nP1;1;2;3;20\n");
  EXPECT_NE(refusal(JoinBy::kName).find("iconv -f WINDOWS-1252 -t UTF-8"), std::string::npos);
}

TEST_F(Joining, refuses_what_leaves_a_choice_and_names_the_cure) {
  joints(kLog);
  points("P1 1 2 3\n");
  EXPECT_NE(refusal(JoinBy::kName).find("--units mm"), std::string::npos);
  points("C G P1 1 2 3 4 5\n");
  EXPECT_NE(refusal(JoinBy::kName, "mm").find("5 columns of numbers and no header"),
            std::string::npos);
  points("Point X Y Z\nP1 1 2 3\n");
  EXPECT_NE(refusal(JoinBy::kName).find("X and --units mm"), std::string::npos);
  EXPECT_NE(refusal(JoinBy::kName, "mm,mm").find("each once"), std::string::npos);
  EXPECT_NE(refusal(JoinBy::kName, "inch").find("deg or rad, mm or m"), std::string::npos);
  points("Q1 1 2 3\n");
  EXPECT_NE(refusal(JoinBy::kName, "mm").find("no point goes with any pose"), std::string::npos);
  joints("Name;A1 [deg];A2 [deg]\nP1;10;20\nP1;11;20\n");
  points("P1 1 2 3\n");
  EXPECT_NE(refusal(JoinBy::kName, "mm").find("other readings than in line 2"), std::string::npos);
  joints("Name;A1 [deg]\nP1;10\n");
  EXPECT_NE(refusal(JoinBy::kName, "mm").find("readings of 2 joints"), std::string::npos);
}

TEST_F(Joining, a_run_in_which_one_joint_moves_one_way_is_its_sweep) {
  std::vector<MeasurementRow> rows;
  const auto add = [&](double q1_deg, double q2_deg) {
    MeasurementRow row;
    row.q = {};
    row.q.push_back(radians(q1_deg));
    row.q.push_back(radians(q2_deg));
    rows.push_back(row);
  };
  for (int k = 0; k < 6; ++k) add(10 * k, 5 + 0.001 * k);   // joint 1
  for (int k = 0; k < 7; ++k) add(30, -20 + 10 * k);        // joint 2
  for (int k = 0; k < 4; ++k) add(40 + 5 * k, 50 - 7 * k);  // both
  for (int k = 0; k < 4; ++k) add(0, 3 * k);                // too short
  const auto counts = find_sweeps(rows, types_);
  EXPECT_EQ(counts, (std::vector<std::size_t>{6, 7}));
  EXPECT_EQ(rows[0].sweep, 1U);
  EXPECT_EQ(rows[5].sweep, 1U);
  EXPECT_EQ(rows[6].sweep, 2U);
  EXPECT_EQ(rows[12].sweep, 2U);
  for (std::size_t k = 13; k < rows.size(); ++k) EXPECT_EQ(rows[k].sweep, 0U) << k;
}

// Of the shortest columns and rows there are, which cost most: the bound that docs/formats.md
// states.
TEST_F(Joining, costs_a_bounded_memory) {
  constexpr double kMost = 512 << 20U;
  constexpr std::size_t kLargest = std::size_t{64} << 20U;
  for (const std::size_t columns : {2U, 17U, 8193U}) {
    std::string row;
    for (std::size_t k = 1; k < columns; ++k) row += "1;";
    row += "1\n";
    std::string text = "A1 [deg];A2 [deg]";
    for (std::size_t k = 2; k < columns; ++k) text += ";x";
    text += "\n";
    for (std::size_t k = 1; k < 1'000'000 && text.size() + row.size() <= kLargest; ++k) text += row;
    joints(text);
    const double cost = test::cost_of(files_.joints, [&](const std::string& path) {
      EXPECT_TRUE(read_joint_log(path, types_, {}));
    });
    EXPECT_LT(cost, kMost) << columns;
    EXPECT_GT(cost, static_cast<double>(text.size())) << columns;  // it was read
  }
}

TEST_F(Joining, refuses_files_and_tables_that_are_too_large) {
  points("Name;X [mm];Y [mm];Z [mm]\nP1;1;2;3\n");
  const std::string line(std::size_t{32} << 10U, '1');
  std::string lines;
  for (int k = 0; k < 2100; ++k) lines += line + "\n";
  joints(lines);
  EXPECT_NE(refusal(JoinBy::kOrder).find("the file is too large; expected at most 65536 KiB"),
            std::string::npos);
  std::string rows;
  for (int k = 0; k <= 1'000'000; ++k) rows += "1;1\n";
  joints(rows);
  EXPECT_NE(refusal(JoinBy::kOrder).find("more than 1000000 rows; expected at most 1000000"),
            std::string::npos);
}

// Two groups whose points have one name, as SpatialAnalyzer's have.
TEST_F(Joining, names_in_groups_go_with_whole_names_and_with_their_ends) {
  joints("Name;A1 [deg];A2 [deg]\nS1::P1;10;20\nS2::P1;30;40\n");
  points("Cell::S1::P1, 1, 2, 3\nCell::S2::P1, 4, 5, 6\n");
  const auto result = joined(JoinBy::kName, "m");
  ASSERT_TRUE(result) << render(result.error());
  EXPECT_DOUBLE_EQ(result->rows[1].q[0], radians(30));
  // In columns of their own.
  points("Cell S1 P1 1 2 3\nCell S2 P1 4 5 6\n");
  const auto columns = joined(JoinBy::kName, "m");
  ASSERT_TRUE(columns) << render(columns.error());
  EXPECT_EQ(*columns->rows[1].p_S, Vector3(4, 5, 6));
  points("Collection;Group;Point;X [m];Y [m];Z [m]\nCell;S1;P1;1;2;3\nCell;S2;P1;4;5;6\n");
  EXPECT_TRUE(joined(JoinBy::kName));
  joints("Name;A1 [deg];A2 [deg]\nP1;10;20\n");
  EXPECT_NE(refusal(JoinBy::kName)
                .find(":3: \"Cell::S2::P1\" and \"Cell::S1::P1\" of line 2 both go "
                      "with the pose \"P1\"; expected whole names"),
            std::string::npos);
}

TEST_F(Joining, several_reflectors_a_pose_are_told_or_refused) {
  joints(kLog);
  points("P1 1 2 3\nP1 1.2 2 3\nP1 1 2.2 3\nP2 2 2 3\nP2 2.2 2 3\nP2 2 2.2 3\n");
  EXPECT_NE(refusal(JoinBy::kName, "m")
                .find(":2: this point is 200.0 mm from that of line 1, of the "
                      "same pose; expected one point, measured again; or "
                      "--reflectors"),
            std::string::npos);
  JoinSettings settings = settings_by(JoinBy::kName);
  settings.reflectors = 3;
  const auto result = joined(settings, "m");
  ASSERT_TRUE(result) << render(result.error());
  ASSERT_EQ(result->rows.size(), 6U);
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_EQ(result->rows[k].target, 7 + static_cast<int>(k % 3));
  // By order, where the number of points tells.
  joints("A1 [deg];A2 [deg]\n10;20\n30;40\n");
  EXPECT_NE(refusal(JoinBy::kOrder, "m")
                .find("6 points for 2 poses; expected as many of both; "
                      "--reflectors 3 where so many"),
            std::string::npos);
  settings.by = JoinBy::kOrder;
  const auto ordered = joined(settings, "m");
  ASSERT_TRUE(ordered) << render(ordered.error());
  EXPECT_DOUBLE_EQ(ordered->rows[3].q[0], radians(30));
  EXPECT_EQ(ordered->rows[5].target, 9);
  // One of them was not seen.
  joints(kLog);
  points("P1 1 2 3\nP1 1.2 2 3\nP1 1 2.2 3\nP2 2 2 3\nP2 2.2 2 3\n");
  settings.by = JoinBy::kName;
  EXPECT_NE(refusal(settings, "m").find("the pose of this point has 2 points; expected 3"),
            std::string::npos);
}

TEST_F(Joining, targets_of_the_points_are_kept) {
  joints(kLog);
  points(
      "Name;Target;X [m];Y [m];Z [m];T air [\u00B0C];Sigma "
      "[mm]\nP1;2;1;2;3;21.5;0.02\nP1;4;5;6;7;;\n");
  const auto result = joined(JoinBy::kName);
  ASSERT_TRUE(result) << render(result.error());
  EXPECT_EQ(result->rows[0].target, 2);
  EXPECT_EQ(result->rows[1].target, 4);
  EXPECT_EQ(result->rows[0].air_c, 21.5);
  EXPECT_DOUBLE_EQ(result->rows[0].sigma_m.value_or(0), 2e-5);
  EXPECT_FALSE(result->rows[1].air_c);
  points("Name;Target;X [m];Y [m];Z [m]\nP1;left;1;2;3\n");
  EXPECT_NE(refusal(JoinBy::kName).find(":2: target \"left\" is no number"), std::string::npos);
  joints("Name;Target;A1 [deg];A2 [deg]\nP1;3;10;20\n");
  points("Name;Target;X [m];Y [m];Z [m]\nP1;2;1;2;3\n");
  EXPECT_NE(refusal(JoinBy::kName).find("target 2, and 3 in the joint log"), std::string::npos);
}

// A motion-capture program's: the rotation has an X of its own.
TEST_F(Joining, two_columns_of_one_name_are_chosen_by_place) {
  joints("Time [s];A1 [deg];A2 [deg]\n0;10;20\n1;10;20\n");
  points(
      "Format Version,1.23\n,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position\n"
      "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z\n0,0.0,0.1,0.2,0.3,0.9,1,2,3\n"
      "1,0.5,0.1,0.2,0.3,0.9,1,2,3\n");
  const std::string said = refusal(JoinBy::kTime, "m");
  EXPECT_NE(said.find(":3: x may come from \"X\" or from \"X\"; expected --point-columns "
                      "auto,x_m=@3, or x_m=@7"),
            std::string::npos)
      << said;
  point_columns_ = "auto,x_m=@7,y_m=@8,z_m=@9";
  const auto result = joined(JoinBy::kTime);
  ASSERT_TRUE(result) << render(result.error());
  EXPECT_EQ(*result->rows[0].p_S, Vector3(1, 2, 3));
}

}  // namespace
}  // namespace armsig::tool
