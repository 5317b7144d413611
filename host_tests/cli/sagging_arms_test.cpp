// SPDX-License-Identifier: MIT
// Sound arms that gravity bends by more than features allow for: none is refused for it, no length
// is blamed, and what is stated is so.
#include <nlohmann/json.hpp>

#include "host_tests/cli/predictions.hpp"

namespace armsig::cli {
namespace {

struct JudgedArm {
  double observed_m = 0;
  double stated_m = 0;
  std::string err;
};

JudgedArm judge(const std::string& seed, const std::string& method) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  const Outcome made = run_tool(
      folder,
      "simulate --arm arm.yaml --tolerances 1 --hand-target-mm 80,30,120 --points 25 --arc 120 "
      "--mixed-poses 40 --sigma-mm 0.03 --sag-mm 4 --out m.csv --truth-out truth.yaml --seed " +
          seed);
  EXPECT_EQ(made.status, 0) << made.err;
  const auto [result, err] = identified_rows(folder, Csv::read(folder / "m.csv"), method);
  if (result.is_null()) return {};
  Csv poses = Csv::read(folder / "m.csv");
  std::erase_if(poses.rows, [&](const auto& row) { return row[poses.column("sweep")] != "0"; });
  write_joint_poses(poses, folder / "q.csv");
  return {rms_distance(predict(folder, "s.yaml", "1"), predict(folder, "truth.yaml", "1")),
          result["predicted_tool_error_m"].get<double>(), err};
}

TEST(SaggingArms, are_stated_by_the_poses_that_features_miss) {
  for (const std::string seed : {"1", "4", "8"}) {
    const JudgedArm arm = judge(seed, "encoder");
    EXPECT_NE(arm.err.find("40 poses that this method does not use are missed"), std::string::npos)
        << arm.err;
    EXPECT_GT(arm.observed_m, 1.5e-3) << seed;
    EXPECT_LT(arm.observed_m, 1.25 * arm.stated_m) << seed;
    EXPECT_GT(arm.observed_m, 0.75 * arm.stated_m) << seed;
  }
}

// Gravity shifts axes as one factor on all lengths would.
TEST(SaggingArms, have_no_lengths_blamed_for_it) {
  const JudgedArm arm = judge("5", "refined");
  EXPECT_EQ(arm.err.find("all lengths seen"), std::string::npos) << arm.err;
  EXPECT_LT(arm.stated_m, 0.3e-3);
  EXPECT_LT(arm.observed_m, 1.25 * arm.stated_m);
}

}  // namespace
}  // namespace armsig::cli
