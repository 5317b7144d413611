// SPDX-License-Identifier: MIT
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/base/pose.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/measurement_writer.hpp"
#include "firmware/formats/measurements.hpp"

namespace armsig::tool {
namespace {

const JointTypes kTypes{JointType::kRevolute, JointType::kPrismatic};
const std::string kHeader = "sweep,target,q1_deg,q2_mm,x_mm,y_mm,z_mm\n";
const std::string kRow = "1,7,90,250,1,-2,3.5\n";

Read<std::vector<MeasurementRow>> rows_of(const std::string& text,
                                          const JointTypes& types = kTypes) {
  ARMSIG_TRY(reader, MeasurementReader::over(text, "M.csv", types));
  std::vector<MeasurementRow> rows;
  for (MeasurementRow row;;) {
    ARMSIG_TRY(more, reader.next(row));
    if (!more) return rows;
    rows.push_back(row);
  }
}

std::string message_of(const std::string& text, const JointTypes& types = kTypes) {
  const auto rows = rows_of(text, types);
  return rows ? "read" : render(rows.error());
}

TEST(Measurements, are_given_in_si) {
  const auto rows = rows_of(kHeader + kRow);
  ASSERT_TRUE(rows) << render(rows.error());
  ASSERT_EQ(rows->size(), 1U);
  const MeasurementRow& row = rows->front();
  EXPECT_EQ(row.line, 2U);
  EXPECT_EQ(row.sweep, 1U);
  EXPECT_EQ(row.target, 7);
  ASSERT_EQ(row.q.size(), 2U);
  EXPECT_EQ(row.q[0], kPi / 2);
  EXPECT_EQ(row.q[1], 0.25);
  ASSERT_TRUE(row.p_S);
  EXPECT_EQ(*row.p_S, Vector3(0.001, -0.002, 0.0035));
  EXPECT_TRUE(row.ranges_m.empty());
  EXPECT_FALSE(row.air_c);
  EXPECT_FALSE(row.sigma_m);
}

TEST(Measurements, take_columns_in_any_order_and_unit) {
  const auto rows =
      rows_of("z_m,q2_m,target,y_mm,sweep,q1_rad,x_m,sigma_m\n3,0.5,1,20,0,1.5,1,1e-4\n");
  ASSERT_TRUE(rows) << render(rows.error());
  const MeasurementRow& row = rows->front();
  EXPECT_EQ(row.sweep, 0U);
  EXPECT_EQ(row.q[0], 1.5);
  EXPECT_EQ(row.q[1], 0.5);
  EXPECT_EQ(*row.p_S, Vector3(1, 0.02, 3));
  EXPECT_EQ(row.sigma_m, 1e-4);
}

TEST(Measurements, take_ranges_some_of_them_missing) {
  const auto rows = rows_of(
      "sweep,target,q1_deg,q2_mm,r1_mm,r2_mm,r3_m,air_c\n1,1,0,0,1500,,2,21.5\n"
      "1,1,0,0,,,,\n");
  ASSERT_TRUE(rows) << render(rows.error());
  const MeasurementRow& row = rows->front();
  EXPECT_FALSE(row.p_S);
  ASSERT_EQ(row.ranges_m.size(), 3U);
  EXPECT_EQ(row.ranges_m[0], 1.5);
  EXPECT_FALSE(row.ranges_m[1]);
  EXPECT_EQ(row.ranges_m[2], 2.0);
  EXPECT_EQ(row.air_c, 21.5);
  EXPECT_FALSE(rows->back().ranges_m[2]);
  EXPECT_FALSE(rows->back().air_c);
}

TEST(Measurements, take_a_missing_position) {
  const auto rows = rows_of(kHeader + "1,1,0,0,,,\n" + kRow);
  ASSERT_TRUE(rows) << render(rows.error());
  EXPECT_FALSE(rows->front().p_S);
  EXPECT_TRUE(rows->back().p_S);
}

TEST(Measurements, take_comments_blank_lines_crlf_spaces_tabs_and_a_byte_order_mark) {
  const auto rows = rows_of(
      "\xEF\xBB\xBF# measured on Monday\r\n\r\nsweep, target,\tq1_deg,q2_mm , x_mm,y_mm,z_mm\r\n"
      "  # joint 1\r\n 1 , 7,+90 ,250,1, -2,3.5\t\r\n   \r\n1,7,90,250,1,-2,3.5");
  ASSERT_TRUE(rows) << render(rows.error());
  ASSERT_EQ(rows->size(), 2U);
  EXPECT_EQ(rows->front().line, 5U);
  EXPECT_EQ(rows->back().line, 7U);
  EXPECT_EQ(*rows->front().p_S, *rows->back().p_S);
}

// What a text is refused with.
struct Refused {
  const char* name;
  std::string text;
  const char* message;
};

class RefusedMeasurements : public testing::TestWithParam<Refused> {};

TEST_P(RefusedMeasurements, say_where_what_is_wrong_and_what_was_expected) {
  EXPECT_EQ(message_of(GetParam().text), GetParam().message);
}

const Refused kRefused[] = {
    {"an_empty_file", "", "M.csv: the file is empty; expected a header line, then one row a line"},
    {"a_file_with_comments_only", "# only a comment\n",
     "M.csv: the file holds only comments; expected a header line, then one row a line"},
    {"a_file_with_a_header_only", kHeader,
     "M.csv:1: the file ends after its header; expected rows of measurements"},
    {"a_missing_column__there_is_no_column_for_sweep", "target,q1_deg,q2_mm,x_mm,y_mm,z_mm\n",
     "M.csv:1: there is no column for sweep; expected sweep"},
    {"a_missing_column__there_is_no_column_for_q2", "sweep,target,q1_deg,x_mm,y_mm,z_mm\n",
     "M.csv:1: there is no column for q2; expected q2_mm or q2_m"},
    {"a_missing_column__there_is_no_column_for_y", "sweep,target,q1_deg,q2_mm,x_mm,z_mm\n",
     "M.csv:1: there is no column for y; expected y_mm or y_m"},
    {"a_missing_column__there_is_no_column_for_the_target", "sweep,target,q1_deg,q2_mm\n",
     "M.csv:1: there is no column for the target; expected x_mm, y_mm, z_mm, or ranges "
     "r1_mm, r2_mm, ... (or _m)"},
    {"a_missing_column__there_is_no_column_for_r2", "sweep,target,q1_deg,q2_mm,r1_mm,r3_mm\n",
     "M.csv:1: there is no column for r2; expected r2_mm or r2_m"},
    {"a_column_without_unit__column_q1_has_no_unit", "sweep,target,q1,q2_mm,x_mm,y_mm,z_mm\n",
     "M.csv:1:14: column \"q1\" has no unit; expected q1_deg or q1_rad"},
    {"a_column_without_unit__column_x_has_no_unit", "sweep,target,q1_deg,q2_mm,x,y,z\n",
     "M.csv:1:27: column \"x\" has no unit; expected x_mm or x_m"},
    {"a_unit_that_contradicts_the_joint__column_q1_mm_has_another_unit_and",
     "sweep,target,q1_mm,q2_mm,x_mm,y_mm,z_mm\n",
     "M.csv:1:14: column \"q1_mm\" has another unit, and joint 1 is revolute; expected "
     "q1_deg or q1_rad"},
    {"a_unit_that_contradicts_the_joint__column_q2_deg_has_another_unit_and",
     "sweep,target,q1_deg,q2_deg,x_mm,y_mm,z_mm\n",
     "M.csv:1:21: column \"q2_deg\" has another unit, and joint 2 is prismatic; expected "
     "q2_mm or q2_m"},
    {"an_unknown_unit", "sweep,target,q1_deg,q2_mm,x_inch,y_mm,z_mm\n",
     "M.csv:1:27: column \"x_inch\" has another unit; expected x_mm or x_m"},
    {"an_unknown_column__unknown_column_tarqet", "sweep,tarqet,q1_deg,q2_mm,x_mm,y_mm,z_mm\n",
     "M.csv:1:7: unknown column \"tarqet\"; expected target"},
    {"an_unknown_column__unknown_column_sweep", "sweep;target;q1_deg\n",
     "M.csv:1:1: unknown column \"sweep;target;q1_deg\"; expected --columns auto, which reads "
     "tables of other programs, or columns like sweep,target,q1_deg,x_mm,y_mm,z_mm"},
    {"an_unknown_column__a_column_without_a_name", "sweep,target,,q1_deg\n",
     "M.csv:1:14: a column without a name; expected a name between the commas"},
    {"a_column_given_twice", "sweep,target,q1_deg,q2_mm,x_mm,y_mm,z_mm,q1_rad\n",
     "M.csv:1:42: column \"q1_rad\" gives q1 a second time (first as \"q1_deg\"); expected "
     "each column once"},
    {"joints_beyond_the_arm", "sweep,target,q1_deg,q2_mm,q3_deg,x_mm,y_mm,z_mm\n",
     "M.csv:1:27: column \"q3_deg\" is for a joint outside the arm, which has 2; expected "
     "q1 to q2"},
    {"positions_and_ranges_together", "sweep,target,q1_deg,q2_mm,x_mm,y_mm,z_mm,r1_mm\n",
     "M.csv:1: there are columns for positions (x, y, z) and for ranges (r); expected one "
     "of the two"},
    {"what_is_no_number__q1_deg_abc_is_not_a_number", kHeader + "1,1,abc,0,1,2,3\n",
     "M.csv:2:5: q1_deg: \"abc\" is not a number; expected a number"},
    {"what_is_no_number__q1_deg_1_5deg_is_not_a", kHeader + "1,1,1.5deg,0,1,2,3\n",
     "M.csv:2:5: q1_deg: \"1.5deg\" is not a number; expected a number"},
    {"what_is_no_number__z_mm_3_is_not_a_number", kHeader + "1,1,0,0,1,2, \"3\"\n",
     "M.csv:2:14: z_mm: \"\"3\"\" is not a number; expected a number"},
    {"what_is_no_number__q1_deg_0x10_is_not_a_number", kHeader + "1,1,0x10,0,1,2,3\n",
     "M.csv:2:5: q1_deg: \"0x10\" is not a number; expected a number"},
    {"numbers_that_are_not_finite__x_mm_nan_is_not_a_finite", kHeader + kRow + "1,1,0,0,nan,2,3\n",
     "M.csv:3:9: x_mm: \"nan\" is not a finite number; expected a number"},
    {"numbers_that_are_not_finite__q1_deg_inf_is_not_a_finite", kHeader + "1,1,-inf,0,1,2,3\n",
     "M.csv:2:5: q1_deg: \"-inf\" is not a finite number; expected a number"},
    {"numbers_that_are_not_finite__q1_deg_1e400_is_out_of_range", kHeader + "1,1,1e400,0,1,2,3\n",
     "M.csv:2:5: q1_deg: \"1e400\" is out of range; expected a number"},
    {"a_row_with_too_few_fields", kHeader + "1,1,0,0,1,2\n",
     "M.csv:2:12: the row ends after 6 of 7 fields; expected z_mm next"},
    {"a_row_with_too_many_fields__4_follows_the_last_of_7_fields", kHeader + "1,1,0,0,1,2,3,4\n",
     "M.csv:2:15: \"4\" follows the last of 7 fields; expected the end of the row"},
    {"a_row_with_too_many_fields__follows_the_last_of_7_fields", kHeader + "1,1,0,0,1,2,3,\n",
     "M.csv:2:15: \"\" follows the last of 7 fields; expected the end of the row"},
    {"an_empty_field_that_is_needed__q1_deg_is_empty", kHeader + "1,1,,0,1,2,3\n",
     "M.csv:2:5: q1_deg is empty; expected a number"},
    {"an_empty_field_that_is_needed__sweep_is_empty", kHeader + ",1,0,0,1,2,3\n",
     "M.csv:2:1: sweep is empty; expected a number"},
    {"a_position_that_is_partly_missing", kHeader + "1,1,0,0,1,,3\n",
     "M.csv:2:11: y is empty, the rest of the position is not; expected all of x, y and z, "
     "or none of them"},
    {"a_sweep_or_target_that_is_no_integer__sweep_1_5_is_not_an_integer",
     kHeader + "1.5,1,0,0,1,2,3\n",
     "M.csv:2:1: sweep: \"1.5\" is not an integer; expected an integer"},
    {"a_sweep_or_target_that_is_no_integer__target_left_is_not_an_integer",
     kHeader + "1,left,0,0,1,2,3\n",
     "M.csv:2:3: target: \"left\" is not an integer; expected an integer"},
    {"a_sweep_or_target_that_is_no_integer__target_99999999999_is_not_an_integer",
     kHeader + "1,99999999999,0,0,1,2,3\n",
     "M.csv:2:3: target: \"99999999999\" is not an integer; expected an integer"},
    {"a_sweep_outside_the_arm__sweep_joint_3_is_outside_the_arm", kHeader + "3,1,0,0,1,2,3\n",
     "M.csv:2:1: sweep: joint 3 is outside the arm; expected 1 to 2, or 0 for a pose"},
    {"a_sweep_outside_the_arm__sweep_joint_1_is_outside_the_arm", kHeader + " -1,1,0,0,1,2,3\n",
     "M.csv:2:2: sweep: joint -1 is outside the arm; expected 1 to 2, or 0 for a pose"},
    {"a_range_that_is_not_positive", "sweep,target,q1_deg,q2_mm,r1_mm\n1,1,0,0,-5\n",
     "M.csv:2:9: range r1: \"-5\" is not positive; expected a distance above 0, or nothing "
     "where the receiver heard nothing"},
    {"a_row_without_end", kHeader + std::string(100000, '1') + "\n",
     "M.csv:2: the line is too long; expected at most 65536 characters"},
    {"a_header_without_end", std::string(100000, '1'),
     "M.csv:1: the line is too long; expected at most 65536 characters"},
    {"show_strange_bytes_as_numbers", kHeader + "1,1,\xFF\x01,0,1,2,3\n",
     "M.csv:2:5: q1_deg: \"\\xFF\\x01\" is not a number; expected a number"},
};
INSTANTIATE_TEST_SUITE_P(Measurements, RefusedMeasurements, testing::ValuesIn(kRefused),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(Measurements, refuse_a_sigma_that_is_not_positive) {
  const std::string header = "sweep,target,q1_deg,q2_mm,x_mm,y_mm,z_mm,sigma_mm\n";
  EXPECT_EQ(message_of(header + "1,1,0,0,1,2,3,0\n"),
            "M.csv:2:15: sigma: \"0\" is not positive; expected a standard deviation above 0, or "
            "nothing");
  EXPECT_EQ(message_of(header + "1,1,0,0,1,2,3,\n"), "read");
}

}  // namespace
}  // namespace armsig::tool
