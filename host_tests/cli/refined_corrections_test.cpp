// SPDX-License-Identifier: MIT
// Corrections of the readings beside an arm that is not as its model says: nothing sound is
// refused, and a pose at which several targets deviate alike is the arm's, not a blunder.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <sstream>

#include <nlohmann/json.hpp>

#include "host_tests/cli/refined_arm.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

// Rows `first`, `first` + `step`, ... of a shared set, with a stated sigma unless it is empty.
Csv some_rows(const std::string& file, std::size_t count, const std::string& sigma_mm) {
  Csv all = Csv::read(kShared / file);
  Csv some;
  some.header = all.header;
  if (!sigma_mm.empty()) some.header.push_back("sigma_mm");
  const std::size_t step = all.rows.size() / count;
  for (std::size_t k = 0; k < count; ++k) {
    some.rows.push_back(all.rows[k * step]);
    if (!sigma_mm.empty()) some.rows.back().push_back(sigma_mm);
  }
  return some;
}

TEST(RefinedCorrections, advised_ones_fit_the_ur5_and_leave_rows_out) {
  if (!std::filesystem::exists(kShared)) GTEST_SKIP() << "no measured data";
  const Folder folder;
  std::filesystem::copy_file(kShared / "arms" / "ur5.yaml", folder / "arm.yaml");
  for (const char* terms :
       {"gain,first-order", "gain,first-order,second-order", "readings-that-help"}) {
    const Outcome outcome = refine(folder, some_rows("ur5-laser-tracker/grid.csv", 142, ""),
                                   std::string("--json --correct ") + terms);
    ASSERT_EQ(outcome.status, 0) << terms << outcome.err;
    const json result = json::parse(outcome.out);
    EXPECT_EQ(result["cross_validation"]["rows"], 142) << terms;
    EXPECT_LT(result["cross_validation"]["mean_m"], 0.1e-3) << terms;
  }
}

TEST(RefinedCorrections, are_not_refused_for_a_sigma_far_below_the_error_of_the_model) {
  if (!std::filesystem::exists(kShared)) GTEST_SKIP() << "no measured data";
  const Folder folder;
  std::filesystem::copy_file(kShared / "arms" / "ur10.yaml", folder / "arm.yaml");
  for (const char* sigma_mm : {"0.001", "0.003", "0.01"}) {
    for (const std::size_t count : {30U, 60U}) {
      const Outcome outcome =
          refine(folder, some_rows("ur10-laser-tracker/poses.csv", count, sigma_mm),
                 "--json --correct gain");
      ASSERT_EQ(outcome.status, 0) << sigma_mm << ' ' << count << ' ' << outcome.err;
      const json result = json::parse(outcome.out);
      EXPECT_GT(result["refinement"]["model_error_m"], 0.03e-3);
      EXPECT_EQ(result["cross_validation"]["rows"], count);
    }
  }
}

// Three targets at thirty poses, at two of which the whole hand is 1.5 mm lower.
Csv with_two_low_poses(const Folder& folder) {
  Csv all;
  for (const char* target : {"80,30,120", "-60,50,90", "10,-90,140"}) {
    write_file(folder / "arm.yaml", kPuma560);
    const Outcome outcome = run_tool(
        folder, std::string("simulate --arm arm.yaml --tolerances 1 --sigma-mm 0.03 --arc 90 "
                            "--points 10 --free-poses 30 --seed 21 --out good.csv --truth-out "
                            "truth.yaml --flange-target-mm ") +
                    target);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    Csv rows = Csv::read(folder / "good.csv");
    keep_mixed(rows);
    const std::string number = std::to_string(all.rows.size() / 30 + 1);
    all.header = rows.header;
    for (std::size_t k = 0; k < rows.rows.size(); ++k) {
      Fields& row = rows.rows[k];
      row[rows.column("target")] = number;
      std::string& z = row[rows.column("z_mm")];
      if (k == 7 || k == 19) z = std::to_string(std::stod(z) - 1.5);
      all.rows.push_back(row);
    }
  }
  return all;
}

TEST(RefinedCorrections, a_pose_at_which_all_targets_deviate_alike_is_no_blunder) {
  const Folder folder;
  const Csv rows = with_two_low_poses(folder);
  ASSERT_EQ(rows.rows.size(), 90U);
  for (const char* options : {"--json", "--json --correct first-order"}) {
    const Outcome outcome = refine(folder, rows, options);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json result = json::parse(outcome.out);
    EXPECT_EQ(result["refinement"]["rows_rejected"], 0) << options;
    EXPECT_EQ(result["cross_validation"]["rows"], 90) << options;
    // Left out, these two poses are wrong by what they are low, and the others hardly.
    const double low_m = 1.5e-3 * std::sqrt(2.0 / 30);
    EXPECT_GT(result["cross_validation"]["rms_m"], 0.95 * low_m) << options;
    EXPECT_LT(result["cross_validation"]["rms_m"], 1.35 * low_m) << options;
  }
}

TEST(RefinedCorrections, a_blunder_of_one_target_is_still_found) {
  const Folder folder;
  Csv rows = with_two_low_poses(folder);
  std::string& x = rows.rows[41][rows.column("x_mm")];
  x = std::to_string(std::stod(x) + 20);
  const Outcome outcome = refine(folder, rows, "--json --correct first-order");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["refinement"]["rows_rejected"], 1);
  // It counts among the rows left out.
  EXPECT_EQ(result["cross_validation"]["rows"], 90);
  EXPECT_GT(result["cross_validation"]["largest_m"], 19e-3);
}

TEST(RefinedCorrections, do_not_depend_on_the_order_of_the_rows) {
  const Folder folder;
  const Csv by_target = with_two_low_poses(folder);
  Csv by_pose = by_target;
  by_pose.rows.clear();
  for (std::size_t k = 0; k < 30; ++k) {
    for (std::size_t t = 0; t < 3; ++t) by_pose.rows.push_back(by_target.rows[30 * t + k]);
  }
  Csv shuffled = by_target;
  std::shuffle(shuffled.rows.begin(), shuffled.rows.end(), std::mt19937_64(7));
  std::vector<double> rms;
  std::vector<double> predicted;
  for (const Csv* rows : std::array<const Csv*, 3>{&by_target, &by_pose, &shuffled}) {
    const Outcome outcome = refine(folder, *rows, "--json --correct gain,first-order");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json result = json::parse(outcome.out);
    rms.push_back(result["cross_validation"]["rms_m"]);
    predicted.push_back(result["predicted_tool_error_m"]);
  }
  for (std::size_t k = 1; k < rms.size(); ++k) {
    EXPECT_NEAR(rms[k], rms[0], 1e-6 * rms[0]);
    EXPECT_NEAR(predicted[k], predicted[0], 1e-6 * predicted[0]);
  }
}

}  // namespace
}  // namespace armsig::cli
