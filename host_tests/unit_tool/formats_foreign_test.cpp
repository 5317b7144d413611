// SPDX-License-Identifier: MIT
// Tables of other software: what is read from each, or why it is refused. Nothing is passed over.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "firmware/formats/foreign_columns.hpp"
#include "firmware/formats/measurements.hpp"

namespace armsig::tool {
namespace {

const NamedJoints kJoints({JointType::kRevolute, JointType::kPrismatic}, {"shoulder", "rail"});

class Foreign : public testing::Test {
 protected:
  ~Foreign() override {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }

  Read<MappedTable> mapped(const std::string& text, const std::string& mapping = "auto",
                           const StatedUnits& units = {}) {
    std::ofstream(path_, std::ios::binary) << text;
    return map_measurements(path_, mapping, kJoints, units);
  }
  // What was made of the table, lines separated by bars; or the refusal without the file's name.
  std::string result(const std::string& text, const std::string& mapping = "auto",
                     const StatedUnits& units = {}) {
    const auto read = mapped(text, mapping, units);
    std::string words = read ? read->text : render(read.error());
    std::ranges::replace(words, '\n', '|');
    if (const auto at = words.find(path_); at != std::string::npos) words.erase(at, path_.size());
    return words;
  }

  std::string path_ =
      (std::filesystem::temp_directory_path() / ("armsig-foreign-" + std::to_string(getpid())))
          .string();
};

const std::string kHeader = "Sweep;Target;A1 [deg];A2 [mm];X [mm];Y [mm];Z [mm]\n";
const std::string kOurs = "sweep,target,q1_deg,q2_mm,x_mm,y_mm,z_mm|";

void expect_in(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << text;
}

TEST_F(Foreign, tables_are_read_by_any_separator) {
  for (const char separator : {';', '\t', ','}) {
    std::string text = kHeader + "1;2;10;20.5;1;2;3\n";
    std::ranges::replace(text, ';', separator);
    EXPECT_EQ(result(text), kOurs + "1,2,10,20.5,1,2,3|");
  }
  EXPECT_EQ(result("Sweep Target A1 [deg] A2 (mm) X [mm] Y [mm] Z [mm]\n1 2 10  20.5\t1 2 3\n"),
            kOurs + "1,2,10,20.5,1,2,3|");
  // A semicolon in a title makes no column.
  EXPECT_EQ(result("Cell 7; AT402\nA1 [deg],A2 [mm],X [mm],Y [mm],Z [mm]\n1,2,3,4,5\n"),
            "|q1_deg,q2_mm,x_mm,y_mm,z_mm,sweep,target|1,2,3,4,5,0,1|");
}

TEST_F(Foreign, lines_keep_their_numbers) {
  EXPECT_EQ(result("title\n\n" + kHeader + "# note\n\n1;2;10;20;1;2;3\r\n"),
            "||" + kOurs + "||1,2,10,20,1,2,3|");
}

TEST_F(Foreign, decimal_commas_are_read_where_no_comma_separates) {
  EXPECT_EQ(result(kHeader + "1;2;10,5;20;1,25;-2;3\n"), kOurs + "1,2,10.5,20,1.25,-2,3|");
  expect_in(result(kHeader + "1;2;10,5;20;1.25;-2;3\n"),
            ":2: X [mm]: \"1.25\" has another decimal");
  expect_in(result(kHeader + "1;2;1.234,5;20;1;-2;3\n"), "has more than a decimal separator");
  expect_in(result(kHeader + "1;2;10;20;1,234;-2;3\n1;2;10;20;812;-2;3\n"),
            ":2: X [mm]: \"1,234\" may have a thousands separator");
}

TEST_F(Foreign, a_row_wider_than_the_header_is_refused) {
  expect_in(result(kHeader + "1;2;10;20;1;2;3;4\n"),
            ":2: the row has 8 columns, its header 7; expected as many in every row");
  // Commas for points and between columns.
  expect_in(result("A1 [deg],A2 [mm],X [mm],Y [mm],Z [mm]\n1,5,2,5,3,5,4,5,5,5\n"),
            ":2: the row has 10 columns, its header 5; expected decimal points where commas");
  EXPECT_EQ(result(kHeader + "1;2;10;20;1;2;3;;\n"), kOurs + "1,2,10,20,1,2,3|");
}

TEST_F(Foreign, a_row_that_ends_early_is_refused) {
  // As a log that was cut off: no position is not the same as none seen.
  expect_in(result(kHeader + "1;2;10;20;1;2;3\n1;2;10;20"), ":3: the row ends before \"X [mm]\"");
  EXPECT_EQ(result(kHeader + "1;2;10;20;;;\n"), kOurs + "1,2,10,20,,,|");
  // What nothing is made of may be missing.
  EXPECT_EQ(result("A1 [deg];A2 [mm];X [mm];Y [mm];Z [mm];Remark\n1;2;3;4;5\n"),
            "q1_deg,q2_mm,x_mm,y_mm,z_mm,sweep,target|1,2,3,4,5,0,1|");
  // Between blanks nobody knows which cell is missing.
  expect_in(result("A1 [deg] A2 [mm] X [mm] Y [mm] Z [mm] Remark\n1 2 3 4 5\n"),
            ":2: the row has 5 columns, its header 6");
}

TEST_F(Foreign, a_letter_more_is_refused_at_every_place_of_a_row) {
  const std::string row = "1;2;10.5;-20;1e1;2;3";
  for (std::size_t at = 0; at <= row.size(); ++at) {
    for (const char c : std::string_view("xZ?%:'")) {
      std::string changed = row;
      changed.insert(at, 1, c);
      // Numbers are read by the reader of our own tables, which has to refuse what comes through.
      const auto read = mapped(kHeader + changed + "\n");
      if (!read) continue;
      auto reader = MeasurementReader::over(read->text, "F", kJoints.types, read->first_line);
      ASSERT_TRUE(reader);
      MeasurementRow taken;
      EXPECT_FALSE(reader->next(taken)) << changed;
    }
  }
}

TEST_F(Foreign, what_follows_the_table_is_refused) {
  expect_in(result(kHeader + "1;2;10;20;1;2;3\nEnd of file\n"), ":3: the row ends before");
  const std::string again = result(kHeader + "1;2;10;20;1;2;3\n" + kHeader);
  expect_in(again, ":3: Target: \"Target\" is no number; expected the number of a reflector");
}

TEST_F(Foreign, units_may_stand_in_a_line_of_their_own) {
  EXPECT_EQ(result("Sweep;Target;A1;A2;X;Y;Z\n;;deg;mm;mm;mm;mm\n1;2;10;20;1;2;3\n"),
            kOurs + "|1,2,10,20,1,2,3|");
  EXPECT_EQ(result("A1,A2,X,Y,Z\n[rad],[mm],[m],[m],[m]\n1,2,3,4,5\n"),
            "q1_rad,q2_mm,x_m,y_m,z_m,sweep,target||1,2,3,4,5,0,1|");
}

TEST_F(Foreign, units_are_stated_or_refused) {
  const std::string bare = "A1;A2;X;Y;Z\n1;2;3;4;5\n";
  expect_in(result(bare),
            "no line of it names joint readings and a position with their units: "
            "column \"A1\" has no unit");
  EXPECT_EQ(result(bare, "auto", {.angle = "deg", .length = "m"}),
            "q1_deg,q2_m,x_m,y_m,z_m,sweep,target|1,2,3,4,5,0,1|");
  expect_in(result("A1 [deg];A2 [mm];X [inch];Y [inch];Z [inch]\n1;2;3;4;5\n"), "no line of it");
  expect_in(result("A1 [deg];A2 [deg];X [mm];Y [mm];Z [mm]\n1;2;3;4;5\n"),
            "column \"A2 [deg]\" has another unit than q2_mm or q2_m");
}

TEST_F(Foreign, joints_count_from_one_or_zero_or_have_names) {
  const std::string ours = "q1_deg,q2_mm,x_mm,y_mm,z_mm,sweep,target|1,2,3,4,5,0,1|";
  EXPECT_EQ(result("Joint 0 [deg];Joint 1 [mm];X [mm];Y [mm];Z [mm]\n1;2;3;4;5\n"), ours);
  EXPECT_EQ(result("Shoulder (deg);RAIL [mm];X [mm];Y [mm];Z [mm]\n1;2;3;4;5\n"), ours);
  // A seventh joint of an arm of six is another arm, or counted from zero.
  expect_in(result("J1 [deg];J2 [mm];J3 [deg];X [mm];Y [mm];Z [mm]\n1;2;3;4;5;6\n"),
            ":1: column \"J3 [deg]\" is for a joint outside the arm, which has 2; expected");
  expect_in(result("J0 [deg];J1 [mm];J2 [deg];X [mm];Y [mm];Z [mm]\n1;2;3;4;5;6\n"),
            "column \"J2 [deg]\" is for a joint outside the arm");
}

TEST_F(Foreign, a_column_that_is_there_twice_is_chosen_by_its_name_or_place) {
  const std::string text = "A1 [deg];J1 [deg];A2 [mm];X [mm];X [mm];Y [mm];Z [mm]\n1;2;3;4;5;6;7\n";
  expect_in(
      result(text, "auto,q1_deg=J1 [deg]"),
      ":1: x may come from \"X [mm]\" or from \"X [mm]\"; expected --columns auto,x_mm=@4, or "
      "x_mm=@5");
  EXPECT_EQ(result(text, "auto,q1_deg=J1 [deg],x_mm=@5"),
            "q1_deg,x_mm,q2_mm,y_mm,z_mm,sweep,target|2,5,3,6,7,0,1|");
  expect_in(
      result(text, "auto,q1_deg=J1 [deg],x_mm=X [mm]"),
      "more than one column is called \"X [mm]\"; expected one by its place, such as x_mm=@4");
  // Nor does a doubled name of something unused matter.
  EXPECT_EQ(result("A1 [deg];A2 [mm];X [mm];Y [mm];Z [mm];RMS;RMS\n1;2;3;4;5;6;7\n"),
            "q1_deg,q2_mm,x_mm,y_mm,z_mm,sweep,target|1,2,3,4,5,0,1|");
}

TEST_F(Foreign, places_do_without_a_header) {
  EXPECT_EQ(
      result("a title\n1;2;3;4;5\n", "sweep=#0,target=#1,q1_deg=@1,q2_mm=@2,x_m=@3,y_m=@4,z_m=@5"),
      "sweep,target,q1_deg,q2_mm,x_m,y_m,z_m||0,1,1,2,3,4,5|");
  for (const char* wrong : {"x_mm=@0", "x_mm=@", "x_mm=@1a", "x_mm", "=X", "x_mm="}) {
    expect_in(result("1;2\n", wrong), "is no mapping; expected auto");
  }
}

// The header of a file without one would be line 0: rows keep the numbers that they have.
TEST_F(Foreign, rows_without_a_header_keep_their_numbers) {
  const auto read = mapped("1;2;3;4;5\n1;2;3;4;5\n", "sweep=#0,q1_deg=@1,x_m=@3");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->first_line, 0U);
  EXPECT_EQ(read->text, "sweep,q1_deg,x_m\n0,1,3\n0,1,3\n");
}

TEST_F(Foreign, a_header_may_stand_in_a_comment) {
  EXPECT_EQ(result("# A1 [deg],A2 [mm],X [mm],Y [mm],Z [mm]\n1,2,3,4,5\n"),
            "q1_deg,q2_mm,x_mm,y_mm,z_mm,sweep,target|1,2,3,4,5,0,1|");
  // Not where the rows are others.
  expect_in(result("# A1 [deg],A2 [mm],X [mm],Y [mm],Z [mm]\n1,2,3\n"), "no line of it names");
}

TEST_F(Foreign, quotes_are_closed) {
  EXPECT_EQ(result("\"Sweep\";\"Target\";\"A1 [deg]\";A2 [mm];X [mm];Y [mm];Z [mm]\n"
                   "\"1\";2;\"10,5\";20;1;2;3\n"),
            kOurs + "1,2,10.5,20,1,2,3|");
  expect_in(result(kHeader + "1;2;\"10;20;1;2;3\n"), ":2: a quote that is not closed");
  expect_in(result(kHeader + "1;2;\"10\"5;20;1;2;3\n"), ":2: a quote that is not closed, or text");
}

TEST_F(Foreign, what_is_left_aside_is_listed) {
  const auto read = mapped("A1 [deg];A2 [mm];;X [mm];Y [mm];Z [mm];RMS\n1;2;9;3;4;5;6\n");
  ASSERT_TRUE(read);
  EXPECT_EQ(words_of_unused(read->layout), "not used: column 3 and RMS");
}

TEST_F(Foreign, what_is_no_file_of_rows_is_called_so) {
  EXPECT_EQ(result(""),
            ": the file is empty; expected a header line, then one row a line; //, # and "
            "! begin comments");
  expect_in(result("\n\n"), "the file holds only blank lines");
  expect_in(result("// A\n# B\n"), "the file holds only comments");
  expect_in(result(kHeader + std::string(100000, '1')), ":2: the line is too long");
}

TEST_F(Foreign, utf_16_and_carriage_returns_are_read) {
  const std::string text = kHeader + "1;2;10,5;20;1;2;3\n";
  std::string wide = "\xFF\xFE";
  for (const char c : text) wide += std::string{c, '\0'};
  EXPECT_EQ(result(wide), kOurs + "1,2,10.5,20,1,2,3|");
  std::string returns = "\xEF\xBB\xBF" + text;
  std::ranges::replace(returns, '\n', '\r');
  EXPECT_EQ(result(returns), kOurs + "1,2,10.5,20,1,2,3|");
}

}  // namespace
}  // namespace armsig::tool
