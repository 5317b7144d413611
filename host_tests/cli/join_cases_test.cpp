// SPDX-License-Identifier: MIT
// Files as programs export them, in ../shared/data/cases/join: what a person expects of each, its
// true values or a refusal that names the cure.
#include <algorithm>
#include <cmath>
#include <set>

#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

const std::filesystem::path kShared = ARMSIG_SHARED_DATA;
const std::filesystem::path kCases = kShared / "cases/join";

// Value of a column in a row of what was written.
struct Value {
  std::size_t row;
  const char* column;
  double value;
};

struct Case {
  const char* name;
  const char* arguments;  // of `join`, or of `identify` where they begin with --measurements
  int status;
  std::vector<const char*> words;  // of standard output and error
  std::size_t rows = 0;
  std::vector<Value> values = {};  // NOLINT(readability-redundant-member-init)
};

class JoinCases : public testing::TestWithParam<Case> {};

TEST_P(JoinCases, are_read_or_refused_with_the_cure) {
  if (!std::filesystem::exists(kCases)) GTEST_SKIP() << "no " << kCases;
  const Case& one = GetParam();
  const Folder folder;
  for (const auto& file : std::filesystem::directory_iterator(kCases)) {
    std::filesystem::copy_file(file.path(), folder / file.path().filename().string());
  }
  const std::string arguments = one.arguments;
  const bool identify = arguments.starts_with("--measurements");
  const std::string arm = arguments.contains("--arm ") ? "" : " --arm arm3.yaml";
  const Outcome outcome =
      run_tool(folder, (identify ? "identify " : "join ") + arguments + arm + " --out out.csv");
  EXPECT_EQ(outcome.status, one.status) << outcome.err;
  for (const char* words : one.words) {
    EXPECT_NE((outcome.out + outcome.err).find(words), std::string::npos)
        << words << "\n"
        << outcome.out << outcome.err;
  }
  ASSERT_EQ(std::filesystem::exists(folder / "out.csv"), one.status == 0);
  if (one.status != 0) return;
  const Csv csv = Csv::read(folder / "out.csv");
  EXPECT_EQ(csv.rows.size(), one.rows);
  for (const Value& value : one.values) {
    ASSERT_LT(value.row, csv.rows.size());
    EXPECT_NEAR(csv.number(value.row, value.column), value.value, 1e-9) << value.column;
  }
}

const Case kWanted[] = {
    {"points_by_name",
     "--joints joints.csv --points points.csv",
     0,
     {"2 points with their poses"},
     2,
     {{0, "q1_deg", 10.5}, {1, "q3_deg", 31.75}, {0, "x_mm", 812.31}, {1, "y_mm", 31.2}}},
    {"points_with_commas_for_points_and_between_columns",
     "--joints joints.csv --points points-comma-comma.csv",
     2,
     {"points-comma-comma.csv:2: the row has 7 columns, its header 4; expected decimal points"}},
    {"joints_with_commas_for_points_and_between_columns",
     "--joints joints-comma-comma.csv --points points.csv",
     2,
     {"joints-comma-comma.csv:2: the row has 7 columns, its header 4; expected decimal points"}},
    {"measurements_with_commas_for_points_and_between_columns",
     "--measurements sweeps-comma-comma.csv --columns auto",
     2,
     {"sweeps-comma-comma.csv:2: the row has 14 columns, its header 8; expected decimal points"}},
    {"joints_under_the_names_of_the_arm_in_another_order",
     "--joints joints-ros.csv --points points.csv",
     0,
     {"1 point with its pose", "1 point without a pose, the first in line 3"},
     1,
     {{0, "q1_deg", 0.3 * 180 / M_PI},
      {0, "q2_deg", 0.2 * 180 / M_PI},
      {0, "q3_deg", 0.1 * 180 / M_PI}}},
    {"one_in_the_afternoon",
     "--joints log-24h.csv --points points-pm.csv --by time",
     0,
     {"1 point with its pose"},
     1,
     {{0, "q1_deg", 50}, {0, "q2_deg", 60}, {0, "q3_deg", 70}, {0, "x_mm", 812.31}}},
    {"an_hour_of_another_zone",
     "--joints log-utc.csv --points points-local.csv --by time",
     0,
     {"1 point with its pose"},
     1,
     {{0, "q1_deg", 10}, {0, "q2_deg", 20}, {0, "q3_deg", 30}}},
    {"a_date_and_a_time_of_day",
     "--joints log-24h.csv --points points-local.csv --by time",
     2,
     {"points-local.csv:2: a date and time with its offset from UTC, and in log-24h.csv a time of "
      "day",
      "--clock-offset-s"}},
    {"joints_without_a_unit",
     "--arm puma560 --joints joints-by-name.csv --points spatialanalyzer-with-times.txt",
     2,
     {"joints-by-name.csv:1: no header with the readings of 6 joints and their units: column "
      "\"J1\" has no unit; expected such as A1 [deg]",
      "--units deg,mm"}},
    {"spatial_analyzer_with_times_and_its_unit",
     "--arm puma560 --joints joints-by-name.csv --points spatialanalyzer-with-times.txt --units "
     "deg",
     0,
     {"3 points with their poses"},
     3,
     {{0, "q1_deg", 1}, {2, "q1_deg", 3}, {0, "x_mm", 2100.1}, {2, "z_mm", -442.3}}},
    {"spatial_analyzer_by_ambiguous_dates",
     "--arm puma560 --joints joints-time-with-unit.csv --points spatialanalyzer-with-times.txt "
     "--by "
     "time",
     2,
     {"spatialanalyzer-with-times.txt:4: \"03/04/25 10:00:01\" may begin with its day or with its "
      "month; expected --dates day-first or month-first"}},
    {"spatial_analyzer_on_another_clock",
     "--arm puma560 --joints joints-time-with-unit.csv --points spatialanalyzer-with-times.txt "
     "--by "
     "time --dates day-first",
     2,
     {"a date and time, and in joints-time-with-unit.csv a number of seconds"}},
    // 3 April 2025, 10:00:01 UTC is 1743674401 s.
    {"spatial_analyzer_with_the_offset_of_the_clocks",
     "--arm puma560 --joints joints-time-with-unit.csv --points spatialanalyzer-with-times.txt "
     "--by "
     "time --dates day-first --clock-offset-s -1743674400",
     0,
     {"1 point with its pose", "2 points without a pose"},
     1,
     {{0, "x_mm", 2100.1}, {0, "q6_deg", 6}}},
    {"joints_from_zero_without_a_unit",
     "--arm ur5 --joints joints-from-zero.txt --points points-tabs.txt --by order --units m",
     2,
     {"column \"Joint0\" has no unit"}},
    {"joints_from_zero",
     "--arm ur5 --joints joints-from-zero.txt --points points-tabs.txt --by order --units rad,m",
     0,
     {"2 points with their poses"},
     2,
     {{0, "q1_deg", 0.066 * 180 / M_PI},
      {1, "q1_deg", 0.166 * 180 / M_PI},
      {0, "q6_deg", -1.491 * 180 / M_PI},
      {0, "x_mm", -821},
      {1, "y_mm", 2357}}},
    {"time_with_a_unit",
     "--arm ur5 --joints joints-time-with-unit.csv --points points-time-with-unit.csv --by time",
     0,
     {"1 point with its pose"},
     1,
     {{0, "q1_deg", 1}, {0, "q6_deg", 6}, {0, "z_mm", 3}}},
    {"a_coordinate_measuring_machine_without_a_unit",
     "--arm ur5 --joints joints-from-zero.txt --points keyence-points.csv --by order --units rad",
     2,
     {"column \"MX Coord.\" has no unit; expected such as X [mm], or X and --units mm"}},
    {"a_coordinate_measuring_machine",
     "--arm ur5 --joints joints-from-zero.txt --points keyence-points.csv --by order --units "
     "rad,mm",
     0,
     {"keyence-points.csv: not used: Number and Deviation"},
     2,
     {{0, "x_mm", -63.1}, {0, "y_mm", -40.6}, {1, "z_mm", 116.7}}},
    {"names_that_are_not_those_of_the_poses",
     "--arm ur5 --joints joints-by-name.csv --points keyence-points.csv --units deg,mm",
     2,
     {"no point goes with any pose by name: the first is \"Point001\", the first pose \"P1\""}},
    {"measurements_without_a_header",
     "--measurements no-header.csv --columns auto --arm ur5",
     2,
     {"no-header.csv: no line of it names joint readings and a position with their units",
      "--columns with a pair for each column, x_mm=THEIR NAME or x_mm=@7"}},
    // It is read, and two rows are no signature.
    {"measurements_without_a_header_by_places",
     "--measurements no-header.csv --arm ur5 --columns "
     "'sweep=#0,target=#1,q1_deg=@1,q2_deg=@2,q3_deg=@3,q4_deg=@4,q5_deg=@5,q6_deg=@6,x_mm=@7,"
     "y_mm=@8,z_mm=@9'",
     1,
     {"Columns (no header, commas)", "x_mm       from  @7"}},
    {"a_joint_log_without_a_header",
     "--arm ur5 --joints no-header.csv --points points.csv --by order",
     2,
     {"no-header.csv:1: no header with the readings of 6 joints and their units",
      "--joint-columns with a pair for each column, q1_deg=THEIR NAME or q1_deg=@2"}},
    {"a_joint_log_without_a_header_by_places",
     "--arm ur5 --joints no-header.csv --points points.csv --by order --joint-columns "
     "q1_deg=@1,q2_deg=@2,q3_deg=@3,q4_deg=@4,q5_deg=@5,q6_deg=@6",
     0,
     {"no-header.csv: not used: column 7, column 8 and column 9"},
     2,
     {{0, "q1_deg", 1}, {1, "q1_deg", 2}, {1, "q6_deg", 6}, {1, "x_mm", 815.77}}},
    // Poses in which any joint may have moved, of one reflector; two of them are no signature.
    {"poses_without_a_sweep",
     "--measurements poses-without-sweep.csv --columns auto --arm ur5",
     1,
     {"sweep      from  #0", "target     from  #1", "q6_deg     from  J6 [deg]"}},
    {"targets_of_a_program",
     "--arm ur5 --joints rapid-jointtargets.txt --points points.csv --by order",
     2,
     {"rapid-jointtargets.txt:1: no header with the readings of 6 joints and their units; expected "
      "such as A1 [deg]"}},
    {"ros_with_nanoseconds",
     "--arm ur5 --joints ros-nanoseconds-joints.csv --points ros-nanoseconds-points.csv --by time "
     "--units deg,mm",
     0,
     {"3 points with their poses"},
     3,
     {{0, "q1_deg", 1}, {2, "q6_deg", 6}, {2, "x_mm", 1}}},
    {"a_ros_message_under_names_of_its_own",
     "--arm ur5 --joints rostopic-echo-p.csv --points ros-nanoseconds-points.csv --by time --units "
     "mm",
     2,
     {"rostopic-echo-p.csv:1: no header with the readings of 6 joints",
      "q1_deg=THEIR NAME or q1_deg=@2"}},
    {"a_ros_message_as_told",
     "--arm ur5 --joints rostopic-echo-p.csv --points ros-nanoseconds-points.csv --by time "
     "--within-s 0.85 --units mm --joint-columns time_ns=%time,q1_rad=field.position0,"
     "q2_rad=field.position1,q3_rad=field.position2,q4_rad=field.position3,"
     "q5_rad=field.position4,q6_rad=field.position5",
     0,
     {"1 point with its pose", "not used: field.header.seq, field.header.stamp"},
     1,
     {{0, "q2_deg", -180 / M_PI}, {0, "q6_deg", -1.5 * 180 / M_PI}, {0, "y_mm", 2}}},
};
INSTANTIATE_TEST_SUITE_P(All, JoinCases, testing::ValuesIn(kWanted),
                         [](const auto& one) { return std::string(one.param.name); });

// Every file is in a case, above or below.
TEST(JoinCasesTable, has_every_file) {
  if (!std::filesystem::exists(kCases)) GTEST_SKIP() << "no " << kCases;
  for (const auto& file : std::filesystem::directory_iterator(kCases)) {
    const std::string name = file.path().filename().string();
    if (name.ends_with(".yaml") || name.starts_with("ur5-")) continue;
    const bool named = std::ranges::any_of(
        kWanted, [&](const Case& one) { return std::string(one.arguments).contains(" " + name); });
    EXPECT_TRUE(named) << name;
  }
}

// The 120 poses of the real UR5 that the ur5-* files hold, from the table that they were made of:
// by the readings, which were rounded to 1e-5 degrees, as positions were to 1e-4 mm.
class Ur5Files : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kCases)) GTEST_SKIP() << "no " << kCases;
    grid_ = Csv::read(kShared / "ur5-laser-tracker/grid.csv");
    for (const char* name :
         {"ur5-joints.csv", "ur5-points.txt", "ur5-one-table.csv", "ur5-rtde.csv"}) {
      std::filesystem::copy_file(kCases / name, folder_ / name);
    }
  }

  // The row of the grid with these readings.
  std::size_t row_like(const Csv& csv, std::size_t k) const {
    for (std::size_t g = 0; g < grid_.rows.size(); ++g) {
      bool same = true;
      for (const char* q : {"q1_deg", "q2_deg", "q3_deg", "q4_deg", "q5_deg", "q6_deg"}) {
        same = same && std::abs(csv.number(k, q) - grid_.number(g, q)) < 2e-5;
      }
      if (same) return g;
    }
    ADD_FAILURE() << "row " << k << " is none of the grid's";
    return 0;
  }

  void expect_rows_of_the_grid(const std::string& file, double tolerance_mm) const {
    const Csv csv = Csv::read(folder_ / file);
    ASSERT_EQ(csv.rows.size(), 120U);
    std::set<std::size_t> used;
    for (std::size_t k = 0; k < csv.rows.size(); ++k) {
      const std::size_t g = row_like(csv, k);
      used.insert(g);
      for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
        EXPECT_NEAR(csv.number(k, axis), grid_.number(g, axis), tolerance_mm) << k << axis;
      }
    }
    EXPECT_EQ(used.size(), 120U);
  }

  Folder folder_;
  Csv grid_;
};

TEST_F(Ur5Files, joints_and_points_are_the_rows_of_the_grid_by_name) {
  const Outcome outcome = run_tool(
      folder_,
      "join --arm ur5 --joints ur5-joints.csv --points ur5-points.txt --units mm --out out.csv");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  expect_rows_of_the_grid("out.csv", 1e-4);
}

TEST_F(Ur5Files, the_log_of_its_real_time_interface_needs_no_units) {
  const Outcome outcome =
      run_tool(folder_,
               "join --arm ur5 --joints ur5-rtde.csv --points ur5-points.txt --units mm --by order "
               "--out out.csv");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  expect_rows_of_the_grid("out.csv", 1e-4);
}

// One table and two files are the same rows: the signatures agree in every number but the time.
TEST_F(Ur5Files, one_table_gives_the_signature_of_the_two_files) {
  ASSERT_EQ(run_tool(folder_,
                     "join --arm ur5 --joints ur5-joints.csv --points ur5-points.txt --units mm "
                     "--out out.csv")
                .status,
            0);
  const Outcome two = run_tool(
      folder_, "identify --arm ur5 --measurements out.csv --method refined --out two.yaml");
  const Outcome one = run_tool(folder_,
                               "identify --arm ur5 --measurements ur5-one-table.csv --columns auto "
                               "--method refined --out one.yaml");
  ASSERT_EQ(two.status, 0) << two.err;
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_NE(one.err.find("header in line 2, semicolons, decimal commas"), std::string::npos);
  const auto found = [&](const char* name) {
    const std::string text = read_file(folder_ / name);
    const std::size_t from = text.find("\njoints:");
    return text.substr(from, text.find("\ncrc32:") - from);
  };
  EXPECT_EQ(found("one.yaml"), found("two.yaml"));
}

}  // namespace
}  // namespace armsig::cli
