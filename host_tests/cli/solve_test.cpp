// SPDX-License-Identifier: MIT
// `solve` for an arm that can't choose all of a pose, and from seeds far from it.
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

// Half a turn from the seed the sine of what is missed is zero, as where nothing is missed.
TEST(Solve, never_takes_a_seed_half_a_turn_away_for_the_answer) {
  const Folder folder;
  const Csv measured = simulated(folder, "--sigma-mm 0");
  write_joint_poses(measured, folder / "q.csv");
  const Csv seeds = Csv::read(folder / "q.csv");
  const Csv reached = predict(folder, "truth.yaml", "1");
  int solved_poses = 0;
  for (std::size_t k = 0; k < 6; ++k) {
    Csv seed = seeds;
    seed.rows = {seeds.rows[k]};
    seed.write(folder / "seed.csv");
    Csv asked = reached;
    asked.rows = {reached.rows[k]};
    Fields& row = asked.rows[0];  // times half a turn about the tool's x axis
    const auto w = row[asked.column("qw")];
    const auto y = row[asked.column("qy")];
    row[asked.column("qw")] = std::to_string(-reached.number(k, "qx"));
    row[asked.column("qx")] = w;
    row[asked.column("qy")] = row[asked.column("qz")];
    row[asked.column("qz")] = std::to_string(-std::stod(y));
    asked.write(folder / "p.csv");
    const Outcome solved = run_tool(
        folder,
        "solve --signature truth.yaml --poses p.csv --seed seed.csv --target 1 --out q.csv");
    if (solved.status != 0) continue;
    ++solved_poses;
    const Csv answer = predict(folder, "truth.yaml", "1");
    double cosine_of_half = 0;
    for (const char* part : {"qw", "qx", "qy", "qz"}) {
      cosine_of_half += answer.number(0, part) * asked.number(0, part);
    }
    EXPECT_NEAR(std::abs(cosine_of_half), 1, 1e-5) << "pose " << k + 1;
    EXPECT_LT(largest_distance(answer, asked), 1e-6) << "pose " << k + 1;
  }
  EXPECT_GT(solved_poses, 0);
}

}  // namespace
}  // namespace armsig::cli
