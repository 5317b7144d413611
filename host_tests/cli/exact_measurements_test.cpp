// SPDX-License-Identifier: MIT
// Measurements that were computed, or are as good: what rounding leaves of them accuses nothing.
#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

constexpr const char* kEightJointArm =
    "armsig: arm/1\nname: seven axes and a finger\njoints:\n"
    "  - {type: revolute, theta_deg: 0, d_mm: -181, a_mm: 0, alpha_deg: -90}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 90, limits_deg: [-128, 128]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: -410, a_mm: 0, alpha_deg: 90}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: -11, a_mm: 0, alpha_deg: -90, limits_deg: [-161, "
    "161]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: -311, a_mm: 0, alpha_deg: -90}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 90, limits_deg: [-159, 159]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: -210, a_mm: 31, alpha_deg: -90}\n"
    "  - {type: revolute, theta_deg: -7.4, d_mm: 0, a_mm: 32, alpha_deg: 0, limits_deg: [0, 46]}\n";

// What `identify` says of an arm measured with that sigma, in sweeps or in sweeps and free poses.
void expect_no_accusation(const Folder& folder, const std::string& arm, const std::string& sigma_mm,
                          int seed, const std::string& poses) {
  SCOPED_TRACE(arm + " sigma " + sigma_mm + " seed " + std::to_string(seed) + poses);
  const Outcome simulated = run_tool(
      folder, "simulate --arm " + arm + " --sigma-mm " + sigma_mm + " --tolerances 1" + poses +
                  " --seed " + std::to_string(seed) + " --out m.csv --truth-out t.yaml");
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const Outcome found =
      run_tool(folder, "identify --arm " + arm + " --measurements m.csv --out s.yaml");
  EXPECT_EQ(found.status, 0) << found.err;
  for (const char* word : {"warning", "nan", "another place", "not of one scale", "bends"}) {
    EXPECT_EQ(found.err.find(word), std::string::npos) << found.err;
  }
  EXPECT_EQ(found.out.find("far off"), std::string::npos) << found.out;
}

TEST(ExactMeasurements, of_sweeps_accuse_nothing) {
  const Folder folder;
  for (const char* arm : {"ur5e", "fr3", "kr6-r700", "puma560", "stanford"}) {
    for (const char* sigma_mm : {"0", "0.0001"}) expect_no_accusation(folder, arm, sigma_mm, 2, "");
  }
}

TEST(ExactMeasurements, of_free_poses_accuse_nothing) {
  const Folder folder;
  for (const char* arm : {"ur5e", "irb120"}) {
    expect_no_accusation(folder, arm, "0", 3, " --free-poses 40");
  }
}

TEST(ExactMeasurements, of_eight_axes_accuse_nothing) {
  const Folder folder;
  write_file(folder / "eight.yaml", kEightJointArm);
  for (int seed = 1; seed <= 8; ++seed) {
    expect_no_accusation(folder, "eight.yaml", "0.0001", seed, "");
  }
}

}  // namespace
}  // namespace armsig::cli
