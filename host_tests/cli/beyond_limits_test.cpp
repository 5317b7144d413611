// SPDX-License-Identifier: MIT
// `predict` for readings that the arm cannot have.
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
