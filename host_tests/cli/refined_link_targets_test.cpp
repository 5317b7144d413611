// SPDX-License-Identifier: MIT
// The set-up of the paper, one target on each link seen in the sweep of its joint alone: what the
// refinement states for the tool is what its predictions miss by anywhere else.
#include <cmath>

#include "host_tests/cli/refined_arm.hpp"

namespace armsig::cli {
namespace {

struct Squares {
  double observed = 0;
  double stated = 0;
};

// Of the target on link 6, in 30 poses that were never measured.
Squares missed_and_stated(const std::string& arm, int seed) {
  const Folder folder;
  const auto run = [&](const std::string& arguments) {
    const Outcome outcome = run_tool(folder, arguments);
    EXPECT_EQ(outcome.status, 0) << arguments << "\n" << outcome.err;
  };
  const std::string simulate = "simulate --arm " + arm + " --sigma-mm 0.1 --seed ";
  run(simulate + std::to_string(seed) + " --tolerances 1 --out m.csv --truth-out truth.yaml");
  run(simulate + "99 --truth truth.yaml --points 2 --arc 30 --mixed-poses 30 --out other.csv");
  run("identify --arm " + arm + " --measurements m.csv --method refined --out s.yaml");
  Csv poses = Csv::read(folder / "other.csv");
  keep_mixed(poses);
  std::erase_if(poses.rows, [&](const Fields& row) { return row[poses.column("target")] != "6"; });
  write_joint_poses(poses, folder / "q.csv");
  run("predict --signature truth.yaml --joints q.csv --target 6 --out true.csv");
  run("predict --signature s.yaml --joints q.csv --target 6 --sigma --out p.csv");
  const Csv truth = Csv::read(folder / "true.csv");
  const Csv predicted = Csv::read(folder / "p.csv");
  EXPECT_EQ(predicted.rows.size(), 30U);
  Squares sum;
  for (std::size_t k = 0; k < predicted.rows.size(); ++k) {
    for (const char* axis : {"x_m", "y_m", "z_m"}) {
      sum.observed += std::pow(predicted.number(k, axis) - truth.number(k, axis), 2);
    }
    sum.stated += std::pow(predicted.number(k, "sigma_m"), 2);
  }
  return sum;
}

TEST(RefinedLinkTargets, miss_by_what_is_stated) {
  for (const char* arm : {"puma560", "ur10e"}) {
    Squares all;
    for (int seed = 1; seed <= 8; ++seed) {
      const Squares one = missed_and_stated(arm, seed);
      all.observed += one.observed;
      all.stated += one.stated;
    }
    const double ratio = std::sqrt(all.observed / all.stated);
    EXPECT_GT(ratio, 0.8) << arm;
    EXPECT_LT(ratio, 1.25) << arm;
  }
}

}  // namespace
}  // namespace armsig::cli
