// SPDX-License-Identifier: MIT
// `solve` for an arm that can't choose all of a pose.
#include "host_tests/cli/refined_arm.hpp"

namespace armsig::cli {
namespace {

constexpr const char* kScara =
    "armsig: arm/1\n"
    "name: Scara\n"
    "joints:\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 150, a_mm: 400, alpha_deg: 0, limits_deg: [-150, "
    "150]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 200, alpha_deg: 0, limits_deg: [-150, "
    "150]}\n"
    "  - {type: prismatic, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 0, limits_mm: [0, 400]}\n";

// The poses of the target at the mixed readings of a SCARA as it was built, in p.csv.
Csv poses_of_scara(const Folder& folder) {
  const Csv rows = simulated(folder, "--sigma-mm 0", kScara);
  write_joint_poses(rows, folder / "q.csv");
  return predict(folder, "truth.yaml", "1");
}

Outcome solve(const Folder& folder) {
  return run_tool(folder, "solve --signature truth.yaml --poses p.csv --target 1 --out q.csv");
}

// Its axes are not quite parallel: the other elbow reaches the position only.
TEST(Solve, takes_the_elbow_that_meets_the_whole_pose) {
  const Folder folder;
  const Csv asked = poses_of_scara(folder);
  const Outcome solved = solve(folder);
  ASSERT_EQ(solved.status, 0) << solved.err;
  EXPECT_EQ(solved.out.find("orientation"), std::string::npos) << solved.out;
  EXPECT_LT(largest_distance(predict(folder, "truth.yaml", "1"), asked), 1e-8);
}

TEST(Solve, meets_the_position_of_the_target_and_says_by_how_much_the_orientation_is_missed) {
  const Folder folder;
  Csv asked = poses_of_scara(folder);
  for (auto& row : asked.rows) {
    row[asked.column("qw")] = "0.6";
    row[asked.column("qx")] = "0.8";
    row[asked.column("qy")] = "0";
    row[asked.column("qz")] = "0";
  }
  asked.write(folder / "p.csv");
  const Outcome solved = solve(folder);
  expect_said(solved, "positions are met, orientations missed by up to ");
  EXPECT_LT(largest_distance(predict(folder, "truth.yaml", "1"), asked), 1e-8);
}

}  // namespace
}  // namespace armsig::cli
