// SPDX-License-Identifier: MIT
// Readings that the arm cannot have, in every file that holds readings.
#include <array>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

// A signature s.yaml of an arm whose joints have -170 to 170 degrees.
void identify_two_joints(const Folder& folder) {
  ASSERT_EQ(measure_two_joints(folder).status, 0);
  const Outcome outcome =
      run_tool(folder, "identify --arm arm.yaml --measurements m.csv --out s.yaml");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

Outcome predict_at(const Folder& folder, const std::string& rows, const std::string& more = "") {
  std::filesystem::remove(folder / "p.csv");
  write_file(folder / "q.csv", rows);
  return run_tool(folder, "predict --signature s.yaml --joints q.csv --out p.csv " + more);
}

TEST(BeyondLimits, within_them_and_a_little_beyond_nothing_is_said) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(identify_two_joints(folder));
  const Outcome outcome = predict_at(folder, "q1_deg,q2_deg\n-170,170\n172,0\n");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err, "");
}

TEST(BeyondLimits, are_said_with_row_and_joint) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(identify_two_joints(folder));
  const char* rows = "q1_deg,q2_deg\n0,0\n0,190\n-250,0\n";
  const Outcome outcome = predict_at(folder, rows);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(
      outcome.err.find("warning: q.csv: 2 of 3 rows are beyond the joint limits, farthest row "
                       "3: joint 1 reads -250.000°, its limits are -170.000° to 170.000°"),
      std::string::npos)
      << outcome.err;
  const auto json = nlohmann::json::parse(predict_at(folder, rows, "--json").out);
  EXPECT_EQ(json["warnings"].size(), 1U);
}

TEST(BeyondLimits, by_turns_are_refused) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(identify_two_joints(folder));
  // Degrees under the name of radians.
  const Outcome outcome = predict_at(folder, "q1_rad,q2_rad\n0,0\n30,-90\n");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("q.csv: 1 of 2 rows is beyond the joint limits, farthest row 2: joint "
                             "2 reads -5156.620°"),
            std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("in the unit that the column's name says"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "p.csv"));
}

// m.csv with 4200 degrees for joint 2 in so many rows from `first` on, as spoilt.csv; "LINE:COLUMN"
// of the first of them.
std::string spoil(const Folder& folder, std::size_t first, std::size_t count) {
  Csv rows = Csv::read(folder / "m.csv");
  const std::size_t column = rows.column("q2_deg");
  for (std::size_t k = first; k < first + count; ++k) rows.rows[k][column] = "4200";
  rows.write(folder / "spoilt.csv");
  const std::vector<std::string> lines = split(read_file(folder / "spoilt.csv"), '\n');
  return std::to_string(first + 2) + ":" + std::to_string(lines[first + 1].find("4200") + 1);
}

// All that take measurements.
const std::array<const char*, 4> kTakers{
    "identify --arm arm.yaml --measurements spoilt.csv --method encoder --out other.yaml",
    "identify --arm arm.yaml --measurements spoilt.csv --method refined --out other.yaml",
    "check --signature s.yaml --measurements spoilt.csv",
    "report --signature s.yaml --measurements spoilt.csv --out r.html"};

TEST(BeyondLimits, by_turns_in_one_row_of_measurements_are_refused_with_their_place) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(identify_two_joints(folder));
  const std::string place = spoil(folder, 30, 1);
  EXPECT_EQ(place.substr(0, 3), "32:");
  for (const char* command : kTakers) {
    const Outcome outcome = run_tool(folder, command);
    EXPECT_EQ(outcome.status, 2) << command;
    EXPECT_EQ(outcome.err,
              "armsig: spoilt.csv:" + place +
                  ": joint 2 reads 4200.000°, its limits are -170.000° to 170.000°; expected "
                  "readings in the unit that the header says; whole turns taken off a joint that "
                  "turns without an end\n")
        << command;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "other.yaml"));
}

TEST(BeyondLimits, by_turns_in_half_of_the_rows_are_a_wrong_unit_or_order) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(identify_two_joints(folder));
  const std::size_t rows = Csv::read(folder / "m.csv").rows.size();
  ASSERT_EQ(rows, 48U);
  for (const std::size_t count : {rows / 2, rows}) {
    const std::string place = spoil(folder, 0, count);
    for (const char* command : kTakers) {
      const Outcome outcome = run_tool(folder, command);
      EXPECT_EQ(outcome.status, 2) << command;
      EXPECT_EQ(outcome.err.find("armsig: spoilt.csv:" + place +
                                 ": joint 2 reads 4200.000°, its limits are -170.000° to "
                                 "170.000°; " +
                                 std::to_string(count) +
                                 " of 48 rows are so: the unit (degrees or radians) or the order "
                                 "of the joints is wrong; expected"),
                0U)
          << command << ": " << outcome.err;
    }
  }
  spoil(folder, 0, rows / 2 - 1);
  EXPECT_NE(run_tool(folder, kTakers[0]).err.find("; 23 of 48 rows are so; expected"),
            std::string::npos);
}

// A controller may count a turn more than the drawing does, and limits are not stops.
TEST(BeyondLimits, by_no_more_than_a_turn_in_measurements_are_taken) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(identify_two_joints(folder));
  Csv rows = Csv::read(folder / "m.csv");
  const std::size_t column = rows.column("q2_deg");
  for (Fields& row : rows.rows) row[column] = std::to_string(std::stod(row[column]) + 360);
  rows.write(folder / "spoilt.csv");
  const Outcome outcome = run_tool(folder, kTakers[0]);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST(BeyondLimits, of_a_seed_by_turns_are_refused) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(identify_two_joints(folder));
  ASSERT_EQ(predict_at(folder, "q1_deg,q2_deg\n10,20\n").status, 0);
  write_file(folder / "seed.csv", "q1_deg,q2_deg\n1e308,0\n");
  const Outcome outcome =
      run_tool(folder, "solve --signature s.yaml --poses p.csv --seed seed.csv --out r.csv");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("seed.csv: row 1: joint 1 reads 1e+308°"), std::string::npos)
      << outcome.err;
}

}  // namespace
}  // namespace armsig::cli
