// SPDX-License-Identifier: MIT
// Rows pasted several times are no further measurements: what is stated stays what it is without
// the copies.
#include <nlohmann/json.hpp>

#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

nlohmann::json identified(const Folder& folder, const std::string& measurements,
                          const std::string& method) {
  const Outcome outcome = run_tool(folder,
                                   "identify --arm arm.yaml --out s.yaml --json "
                                   "--measurements " +
                                       measurements + " --method " + method);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return nlohmann::json::parse(outcome.out);
}

TEST(CopiedRows, count_once_and_are_said) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  const Outcome measured = run_tool(
      folder,
      "simulate --arm arm.yaml --tolerances 1 --flange-target-mm 80,30,120 --sigma-mm 0.05 "
      "--points 16 --free-poses 30 --seed 4 --out m.csv");
  ASSERT_EQ(measured.status, 0) << measured.err;
  Csv rows = Csv::read(folder / "m.csv");
  const std::size_t once = rows.rows.size();
  const std::vector<Fields> all = rows.rows;
  for (int copy = 0; copy < 9; ++copy) rows.rows.insert(rows.rows.end(), all.begin(), all.end());
  rows.write(folder / "pasted.csv");
  for (const std::string method : {"encoder", "refined"}) {
    SCOPED_TRACE(method);
    const auto of_once = identified(folder, "m.csv", method);
    const auto of_pasted = identified(folder, "pasted.csv", method);
    EXPECT_DOUBLE_EQ(of_pasted["predicted_tool_error_m"], of_once["predicted_tool_error_m"]);
    EXPECT_EQ(of_pasted["rows"], of_once["rows"]);
    EXPECT_EQ(of_once["warnings"].size(), of_pasted["warnings"].size() - 1);
    EXPECT_EQ(of_pasted["warnings"].back(),
              "pasted.csv: " + std::to_string(9 * once) +
                  " rows are copies of others to the last digit, and count once");
  }
}

}  // namespace
}  // namespace armsig::cli
