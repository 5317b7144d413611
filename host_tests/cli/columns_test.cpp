// SPDX-License-Identifier: MIT
// Measurements of other software: what a laser tracker's program writes.
#include <algorithm>
#include <map>

#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

// A sweep of each joint of kTwoJointArm, exact, as m.csv in our format.
void simulate_two_joints(const Folder& folder) {
  write_file(folder / "arm.yaml", kTwoJointArm);
  const Outcome outcome = run_tool(
      folder,
      "simulate --arm arm.yaml --sigma-mm 0 --arc 90 --points 12 --out m.csv --truth-out t.yaml");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

// m.csv with other names, separator and decimal sign, after some lines of something else.
void write_as_others_do(const Folder& folder, const std::map<std::string, std::string>& names,
                        const std::string& preamble, char decimal = ',') {
  Csv csv = Csv::read(folder / "m.csv");
  std::string text = preamble;
  for (std::size_t k = 0; k < csv.header.size(); ++k) {
    text += (k == 0 ? "" : ";") + names.at(csv.header[k]);
  }
  for (const Fields& row : csv.rows) {
    std::string line = join(row, ';');
    std::ranges::replace(line, '.', decimal);
    text += "\r\n" + line;
  }
  write_file(folder / "theirs.txt", text + "\r\n");
}

const std::map<std::string, std::string> kTracker{
    {"sweep", "Sweep"},         {"target", "Punkt"},        {"q1_deg", "A1 [°]"},
    {"q2_deg", "Achse2 (deg)"}, {"x_mm", "X [mm]"},         {"y_mm", "\"Y [mm]\""},
    {"z_mm", "Z [mm]"},         {"sigma_mm", "Sigma [mm]"}, {"air_c", "T air [°C]"}};

Outcome identify_theirs(const Folder& folder, const std::string& columns) {
  return run_tool(
      folder,
      "identify --arm arm.yaml --measurements theirs.txt --out s.yaml --columns '" + columns + "'");
}

void expect_the_same_signature(const Folder& folder) {
  const Outcome ours =
      run_tool(folder, "identify --arm arm.yaml --measurements m.csv --out ours.yaml");
  ASSERT_EQ(ours.status, 0) << ours.err;
  const auto joints = [](const std::string& text) {
    return text.substr(text.find("\njoints:"), 4000);
  };
  EXPECT_EQ(joints(read_file(folder / "s.yaml")), joints(read_file(folder / "ours.yaml")));
}

TEST(Columns, are_mapped_by_name_and_unit_and_printed_back) {
  const Folder folder;
  simulate_two_joints(folder);
  write_as_others_do(folder, kTracker, "Laser tracker export\r\nOperator;Smith\r\n\r\n");
  const Outcome outcome = identify_theirs(folder, "auto");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* said :
       {"header in line 4, semicolons, decimal commas", "q1_deg     from  A1 [°]",
        "q2_deg     from  Achse2 (deg)", "y_mm       from  Y [mm]"}) {
    EXPECT_NE(outcome.err.find(said), std::string::npos) << said << "\n" << outcome.err;
  }
  expect_the_same_signature(folder);
}

TEST(Columns, are_mapped_as_asked_with_constants_for_what_the_file_lacks) {
  const Folder folder;
  simulate_two_joints(folder);
  auto names = kTracker;
  names["x_mm"] = "East";
  names["target"] = "Remark";
  write_as_others_do(folder, names, "", '.');
  const Outcome outcome = identify_theirs(folder, "auto,x_mm=East,target=#1");
  // Each joint's sweep has a target of its own, and now all have one number.
  ASSERT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("one target number stands for points that are not one point"),
            std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("x_mm       from  East"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("target     from  #1"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("not used: Remark"), std::string::npos) << outcome.err;
}

TEST(Columns, never_guess_a_unit) {
  const Folder folder;
  simulate_two_joints(folder);
  auto names = kTracker;
  names["x_mm"] = "X";
  write_as_others_do(folder, names, "");
  const Outcome outcome = identify_theirs(folder, "auto");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("column \"X\" has no unit"), std::string::npos) << outcome.err;
}

TEST(Columns, never_guess_which_of_two_is_meant) {
  const Folder folder;
  simulate_two_joints(folder);
  auto names = kTracker;
  names["target"] = "J1 [deg]";
  write_as_others_do(folder, names, "");
  const Outcome two = identify_theirs(folder, "auto");
  EXPECT_EQ(two.status, 2);
  EXPECT_NE(two.err.find("theirs.txt:1: q1 may come from \"J1 [deg]\" or from \"A1 [°]\"; "
                         "expected --columns auto,q1_deg=J1 [deg], or q1_deg=A1 [°]"),
            std::string::npos)
      << two.err;
  // As it says.
  EXPECT_EQ(identify_theirs(folder, "auto,q1_deg=A1 [°],target=#1").err.find("may come from"),
            std::string::npos);
  names["target"] = "X [mm]";
  write_as_others_do(folder, names, "");
  const Outcome same = identify_theirs(folder, "auto");
  EXPECT_EQ(same.status, 2);
  EXPECT_NE(same.err.find("expected --columns auto,x_mm=@2, or x_mm=@5"), std::string::npos)
      << same.err;
}

TEST(Columns, refuse_a_mapping_against_the_stated_unit) {
  const Folder folder;
  simulate_two_joints(folder);
  write_as_others_do(folder, kTracker, "");
  const Outcome outcome = identify_theirs(folder, "auto,x_m=X [mm]");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("x_m is to come from \"X [mm]\"; expected x_mm"), std::string::npos)
      << outcome.err;
}

TEST(Columns, name_the_line_of_the_file_in_problems) {
  const Folder folder;
  simulate_two_joints(folder);
  write_as_others_do(folder, kTracker, "Export\r\n");
  std::string text = read_file(folder / "theirs.txt");
  const std::size_t third = text.find('\n', text.find('\n', text.find('\n') + 1) + 1) + 1;
  text.replace(third, text.find('\r', third) - third, "1;1;1.234,5;0,0;1,0;2,0;3,0");
  write_file(folder / "theirs.txt", text);
  const Outcome outcome = identify_theirs(folder, "auto");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("theirs.txt:4: A1 [°]: \"1.234,5\" has more than a decimal separator"),
            std::string::npos)
      << outcome.err;
}

// Three columns of a table that has no other separator than the comma.
std::string quoted_numbers(const std::string& x) {
  return "Sweep,Point,A1 [deg],Achse2 [deg],X [mm],Y [mm],Z [mm]\n1,1,0,0," + x + ",2,3\n";
}

TEST(Columns, never_take_a_thousands_separator_for_a_decimal_comma) {
  const Folder folder;
  simulate_two_joints(folder);
  write_file(folder / "theirs.txt", quoted_numbers("\"-1,211\""));
  const Outcome outcome = identify_theirs(folder, "auto");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("theirs.txt:2: X [mm]: \"-1,211\" may have a decimal comma or a "
                             "thousands separator; expected decimal points"),
            std::string::npos)
      << outcome.err;
}

TEST(Columns, refuse_decimal_points_and_commas_in_one_file) {
  const Folder folder;
  simulate_two_joints(folder);
  std::string text = quoted_numbers("1,5") + "1,1,0,0,1.211,2,3\n";
  std::ranges::replace(text, ',', ';');
  text.replace(text.find(";5;"), 2, ",5");
  write_file(folder / "theirs.txt", text);
  const Outcome outcome = identify_theirs(folder, "auto");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("theirs.txt:3: X [mm]: \"1.211\" has another decimal separator"),
            std::string::npos)
      << outcome.err;
}

TEST(Columns, refuse_a_header_with_control_characters) {
  const Folder folder;
  simulate_two_joints(folder);
  std::string text = quoted_numbers("1");
  text.replace(text.find("Sweep"), 5, "Sweep,Note \x1b[31m");
  write_file(folder / "theirs.txt", text);
  const Outcome outcome = identify_theirs(folder, "auto");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("theirs.txt:1:12: the byte \"\\x1B\" in the header"),
            std::string::npos)
      << outcome.err;
}

TEST(Columns, say_what_a_header_should_look_like_where_there_is_none) {
  const Folder folder;
  simulate_two_joints(folder);
  write_file(folder / "theirs.txt", "1;2;3\n4;5;6\n");
  Outcome outcome = identify_theirs(folder, "auto");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("no line of it names joint readings"), std::string::npos)
      << outcome.err;
  outcome = identify_theirs(folder, "x_mm=East");
  EXPECT_NE(outcome.err.find("no line of it has the columns East"), std::string::npos)
      << outcome.err;
  outcome = identify_theirs(folder, "x_mm");
  EXPECT_NE(outcome.err.find("\"x_mm\" is no mapping"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace armsig::cli
