// SPDX-License-Identifier: MIT
// A cause is named where there is one: sound measurements, some of them too few or too noisy for
// the method, are no mistake of anybody's.
#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

// A reach of a quarter of a metre, which a millimetre of noise tells little of.
constexpr const char* kSmallArm =
    "armsig: arm/1\nname: small\njoints:\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 58.219, a_mm: 0, alpha_deg: 180, limits_deg: "
    "[-138.8, 94.2]}\n"
    "  - {type: revolute, theta_deg: 90, d_mm: 0, a_mm: 0, alpha_deg: 180, limits_deg: [-190, "
    "158.8]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 117.284, a_mm: 0, alpha_deg: 180, limits_deg: "
    "[-67.3, 57.2]}\n"
    "  - {type: revolute, theta_deg: -90, d_mm: 88.206, a_mm: 0, alpha_deg: 45, limits_deg: "
    "[-167.9, 131.7]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 45, limits_deg: [-178.2, "
    "139.8]}\n";

constexpr const char* kArmWithSlides =
    "armsig: arm/1\nname: slides\njoints:\n"
    "  - {type: prismatic, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: -90, limits_mm: [-242, "
    "323]}\n"
    "  - {type: revolute, theta_deg: 90, d_mm: 0, a_mm: 452.588, alpha_deg: 90, limits_deg: "
    "[-75.1, 137.6]}\n"
    "  - {type: prismatic, theta_deg: -90, d_mm: 0, a_mm: 386.7, alpha_deg: 90, limits_mm: [-242, "
    "323]}\n"
    "  - {type: revolute, theta_deg: 90, d_mm: 0, a_mm: 0, alpha_deg: 0, limits_deg: [-191.9, "
    "56.9]}\n"
    "  - {type: prismatic, theta_deg: -90, d_mm: 0, a_mm: 0, alpha_deg: -90, limits_mm: [-242, "
    "323]}\n"
    "  - {type: revolute, theta_deg: -90, d_mm: 0, a_mm: 0, alpha_deg: 45, limits_deg: [-141.5, "
    "157.4]}\n";

// Its joints 2 and 3 have one axis; the sweep of joint 1 alone tells where the base is.
constexpr const char* kParallelArm =
    "armsig: arm/1\nname: parallel\njoints:\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 45, limits_deg: [-59.7, "
    "187.5]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 1972.909, a_mm: 0, alpha_deg: 0, limits_deg: "
    "[-117.8, 111.6]}\n"
    "  - {type: revolute, theta_deg: -90, d_mm: 0, a_mm: 0, alpha_deg: 0, limits_deg: [-165.3, "
    "51.6]}\n"
    "  - {type: prismatic, theta_deg: 0, d_mm: 566.993, a_mm: 0, alpha_deg: 0, limits_mm: [-1052, "
    "1403]}\n"
    "  - {type: revolute, theta_deg: 90, d_mm: 0, a_mm: 0, alpha_deg: -90, limits_deg: [-170.5, "
    "108]}\n";

void simulate(const Folder& folder, const char* arm, const std::string& options) {
  write_file(folder / "arm.yaml", arm);
  const Outcome outcome = run_tool(folder, "simulate --arm arm.yaml --out m.csv " + options);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

Outcome identify_by_paper(const Folder& folder) {
  return run_tool(folder,
                  "identify --arm arm.yaml --measurements m.csv --method paper --out s.yaml");
}

TEST(Causes, a_small_arm_and_a_noisy_sensor_are_no_wrong_unit_of_the_arms_lengths) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(
      simulate(folder, kSmallArm,
               "--tolerances 0.5 --sigma-mm 1 --points 40 --free-poses 80 --arc 60 --seed 15 "
               "--flange-target-mm 31.94,12.78,38.33"));
  const Outcome outcome = identify_by_paper(folder);
  ASSERT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("the arc is too short"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("most likely"), std::string::npos) << outcome.err;
}

TEST(Causes, short_arcs_of_an_arm_with_slides_are_no_wrong_unit_of_a_reading) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(
      simulate(folder, kArmWithSlides,
               "--tolerances 0 --sigma-mm 1 --points 24 --free-poses 20 --arc 60 --seed 47 "
               "--maps-deg 0.02 --deflection-mm 0.4 --flange-target-mm 80.7,32.3,96.9"));
  const Outcome outcome = identify_by_paper(folder);
  ASSERT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("the arc is too short"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("most likely"), std::string::npos) << outcome.err;
}

// Four of five sweeps agree to the last digit wherever the base leans.
TEST(Causes, exact_rows_of_an_exact_arm_are_one_arm_in_one_place) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(
      simulate(folder, kParallelArm, "--sigma-mm 0 --points 24 --arc 180 --seed 6"));
  EXPECT_EQ(identify_by_paper(folder).status, 0);
}

}  // namespace
}  // namespace armsig::cli
