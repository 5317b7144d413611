// SPDX-License-Identifier: MIT
// Sweeps that contradict each other: the arm found by their features misses the points of some of
// them as a whole, which no fold of one sweep tells. It is counted, and stated.
#include <cmath>

#include "host_tests/cli/predictions.hpp"

namespace armsig::cli {
namespace {

constexpr const char* kWarning = "the sweeps contradict each other";
constexpr std::size_t kRows = 6 * 24;

// One target on the hand, which all sweeps share; poses anywhere to judge by.
Csv sweeps_of_a_puma(const Folder& folder) {
  write_file(folder / "arm.yaml", kPuma560);
  const std::string simulate =
      "simulate --arm arm.yaml --arc 150 --points 24 --flange-target-mm 120,50,180 ";
  const Outcome swept = run_tool(folder, simulate +
                                             "--tolerances 1 --sigma-mm 0.05 --seed 3 --out m.csv "
                                             "--truth-out truth.yaml");
  EXPECT_EQ(swept.status, 0) << swept.err;
  const Outcome held = run_tool(folder, simulate +
                                            "--truth truth.yaml --free-poses 100 --sigma-mm 0 "
                                            "--seed 9 --out held.csv");
  EXPECT_EQ(held.status, 0) << held.err;
  return Csv::read(folder / "m.csv");
}

// The tracker stood elsewhere while sweeps 3 and 4 were measured.
Csv with_a_moved_tracker(Csv rows, double shift_mm) {
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    if (rows.number(k, "sweep") < 3 || rows.number(k, "sweep") > 4) continue;
    rows.rows[k][rows.column("y_mm")] = std::to_string(rows.number(k, "y_mm") + shift_mm);
  }
  return rows;
}

struct JudgedSweeps {
  double ratio = 0;  // observed over stated tool error
  nlohmann::json left_out;
  std::string err;
};

JudgedSweeps judge_sweeps(const Folder& folder, const Csv& rows, const std::string& method) {
  const auto [result, err] = identified_rows(folder, rows, method);
  if (result.is_null()) return {};
  Csv held = Csv::read(folder / "held.csv");
  std::erase_if(held.rows,
                [&](const Fields& row) { return row[held.column("sweep")] != std::string("0"); });
  write_joint_poses(held, folder / "q.csv");
  const double observed_m =
      rms_distance(predict(folder, "s.yaml", "1"), predict(folder, "truth.yaml", "1"));
  return {observed_m / result["predicted_tool_error_m"].get<double>(), result["cross_validation"],
          err};
}

TEST(ContradictingSweeps, are_not_found_in_a_sound_file) {
  const Folder folder;
  const Csv rows = sweeps_of_a_puma(folder);
  for (const std::string method : {"paper", "encoder"}) {
    const JudgedSweeps sound = judge_sweeps(folder, rows, method);
    EXPECT_GT(sound.ratio, 0.5) << method;
    EXPECT_LT(sound.ratio, 2) << method;  // of one arm
    EXPECT_EQ(sound.left_out["rows"], kRows);
    EXPECT_EQ(sound.err.find(kWarning), std::string::npos) << sound.err;
  }
}

TEST(ContradictingSweeps, are_counted_and_stated) {
  const Folder folder;
  const Csv rows = with_a_moved_tracker(sweeps_of_a_puma(folder), 1);
  for (const std::string method : {"paper", "encoder"}) {
    const JudgedSweeps moved = judge_sweeps(folder, rows, method);
    EXPECT_LT(moved.ratio, 1.2) << method;  // 4 by the features alone
    EXPECT_GT(moved.ratio, 0.3) << method;
    EXPECT_EQ(moved.left_out["rows"], kRows);
    EXPECT_GT(moved.left_out["largest_m"], 0.5e-3);
    EXPECT_NE(moved.err.find(kWarning), std::string::npos) << moved.err;
  }
}

// A blunder is in the figure, and beside it is the one without.
TEST(ContradictingSweeps, are_told_from_blunders) {
  const Folder folder;
  Csv rows = sweeps_of_a_puma(folder);
  for (const std::size_t k : {5U, 40U, 77U}) {
    rows.rows[k][rows.column("x_mm")] = std::to_string(rows.number(k, "x_mm") + 40);
  }
  const JudgedSweeps blundered = judge_sweeps(folder, rows, "encoder");
  EXPECT_LT(blundered.ratio, 2);
  EXPECT_EQ(blundered.left_out["rows"], kRows);
  EXPECT_GT(blundered.left_out["largest_m"], 30e-3);
  EXPECT_EQ(blundered.left_out["rejected"], 3);
  EXPECT_LT(blundered.left_out["rms_kept_m"], 0.3e-3);
  EXPECT_EQ(blundered.err.find(kWarning), std::string::npos) << blundered.err;
}

}  // namespace
}  // namespace armsig::cli
