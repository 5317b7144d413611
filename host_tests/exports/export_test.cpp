// SPDX-License-Identifier: MIT
// Exports evaluated in Python by the conventions of the software that reads them.
#include <algorithm>
#include <sstream>

#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "host_tests/exports/exported_arm.hpp"

namespace armsig::cli {
namespace {

struct Difference {
  double distance_m = 1;
  double turn = 1;
};

Difference read_back(const Folder& folder, const std::string& format) {
  const Outcome exported = export_as(folder, format);
  EXPECT_EQ(exported.status, 0) << exported.err;
  const std::string command = "cd '" + folder.path().string() +
                              "' && /usr/bin/python3 '" ARMSIG_READ_EXPORT "' " + format +
                              " export.out q.csv p.csv >.read 2>&1";
  const int status = std::system(command.c_str());  // NOLINT(cert-env33-c): our own command line
  const std::string said = read_file(folder / ".read");
  EXPECT_EQ(status, 0) << said;
  Difference difference;
  std::istringstream(said) >> difference.distance_m >> difference.turn;
  return difference;
}

void expect_same_poses(const Folder& folder, const std::vector<std::string>& formats) {
  for (const std::string& format : formats) {
    SCOPED_TRACE(format);
    const Difference difference = read_back(folder, format);
    EXPECT_LT(difference.distance_m, kExportTolerance_m);
    EXPECT_LT(difference.turn, 1e-9);
  }
}

const std::vector<std::string> kOfAnySix{"linuxcnc", "dh-csv", "mdh-csv", "rtb", "json"};

TEST(Export, gives_the_poses_of_an_individual_puma_in_every_format) {
  const Folder folder;
  make_individual(folder, kPuma560);
  expect_same_poses(folder, kOfAnySix);
}

TEST(Export, holds_real_arms_whose_nearly_parallel_axes_put_d_hundreds_of_metres_away) {
  const std::string arm = shared_arm("ur10e-individual-a");
  if (arm.empty()) GTEST_SKIP() << "no arm descriptions in " << ARMSIG_SHARED_DATA;
  const Folder folder;
  make_individual(folder, arm, "");
  expect_same_poses(folder, kOfAnySix);
  expect_same_poses(folder, {"ur-yaml"});
}

TEST(Export, gives_the_drivers_of_universal_robots_each_of_their_arms) {
  for (const tool::KnownArm& known : tool::known_arms()) {
    if (!known.name.starts_with("ur")) continue;
    SCOPED_TRACE(known.name);
    const Folder folder;
    make_individual(folder, std::string(known.text), "--tolerances 3");
    expect_same_poses(folder, {"ur-yaml"});
  }
}

TEST(Export, refuses_to_tell_those_drivers_of_any_other_arm) {
  const std::string longer = [] {
    const auto ur5e = std::ranges::find(tool::known_arms(), "ur5e", &tool::KnownArm::name);
    std::string text(ur5e->text);
    const std::size_t at = text.find("a_mm: -425");
    EXPECT_NE(at, std::string::npos) << text;
    return text.replace(at, 10, "a_mm: -525");
  }();
  for (const auto& [arm, nearest] :
       {std::pair{std::string(kPuma560), "ur"}, std::pair{longer, "ur16e, 92 mm off"}}) {
    const Folder folder;
    make_individual(folder, arm);
    const Outcome outcome = export_as(folder, "ur-yaml");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.err.find("its axes are those of no arm of Universal Robots; nearest is the " +
                               std::string(nearest)),
              std::string::npos)
        << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "export.out"));
  }
}

TEST(Export, holds_prismatic_joints_where_the_format_can) {
  const Folder folder;
  make_individual(folder, kStanfordArm);
  expect_same_poses(folder, {"dh-csv", "mdh-csv", "rtb", "json"});
}

TEST(Export, carries_couplings_along) {
  const Folder folder;
  make_individual(folder, kCoupledArm);
  expect_same_poses(folder, {"linuxcnc", "dh-csv", "mdh-csv", "rtb", "json"});
}

const std::string kBent = "--tolerances 1 --maps-deg 0.02 --deflection-mm 0.5";

TEST(Export, carries_gravity_and_maps_in_json_and_as_a_table) {
  for (const char* arm : {kPuma560, kStanfordArm, kCoupledArm}) {
    const Folder folder;
    make_individual(folder, arm, kBent);
    expect_same_poses(folder, {"json"});
    std::filesystem::rename(folder / "export.out", folder / "geometry.json");
    expect_same_poses(folder, {"maps-csv"});
  }
}

TEST(Export, carries_maps_as_compensation_tables_of_linuxcnc) {
  const Folder folder;
  make_individual(folder, kPuma560, "--tolerances 1 --maps-deg 0.02");
  const Difference with_tables = read_back(folder, "linuxcnc");
  EXPECT_LT(with_tables.distance_m, 2e-5);  // straight lines between 256 points
  EXPECT_TRUE(std::filesystem::exists(folder / "export.out.joint-5.comp"));
  EXPECT_NE(read_file(folder / "export.out").find("[JOINT_5] COMP_FILE_TYPE = 0"),
            std::string::npos);
  for (int joint = 0; joint < 6; ++joint) {
    std::filesystem::remove(folder / ("export.out.joint-" + std::to_string(joint) + ".comp"));
  }
  const std::string command = "cd '" + folder.path().string() +
                              "' && /usr/bin/python3 '" ARMSIG_READ_EXPORT
                              "' linuxcnc export.out q.csv p.csv >.read 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);  // NOLINT(cert-env33-c): our own command line
  EXPECT_GT(std::stod(read_file(folder / ".read")), 10 * with_tables.distance_m);
}

TEST(Export, fits_the_geometry_anew_where_gravity_and_maps_are_lost_and_says_what_that_costs) {
  const Folder folder;
  make_individual(folder, kPuma560, kBent);
  for (const std::string format : {"dh-csv", "mdh-csv", "rtb", "linuxcnc"}) {
    SCOPED_TRACE(format);
    const Outcome exported = run_tool(
        folder, "export --signature truth.yaml --json --format " + format + " --out export.out");
    ASSERT_EQ(exported.status, 0) << exported.err;
    EXPECT_NE(exported.err.find("its geometry is the best without"), std::string::npos)
        << exported.err;
    EXPECT_NE(read_file(folder / "export.out").find("geometry fitted anew without gravity"),
              std::string::npos);
    const std::string key = "\"lost_rms_m\":";
    ASSERT_NE(exported.out.find(key), std::string::npos) << exported.out;
    const double lost_m = std::stod(exported.out.substr(exported.out.find(key) + key.size()));
    EXPECT_GT(lost_m, 2e-5);
    EXPECT_LT(lost_m, 4e-4);
    // All of it, and not more: the largest of fifty poses.
    const Difference difference = read_back(folder, format);
    EXPECT_GT(difference.distance_m, lost_m);
    EXPECT_LT(difference.distance_m, 5 * lost_m);
  }
}

TEST(Export, refuses_a_table_of_maps_where_there_are_none) {
  const Folder folder;
  make_individual(folder, kTwoJointArm);
  const Outcome outcome = export_as(folder, "maps-csv");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("no gravity and no joint error maps"), std::string::npos)
      << outcome.err;
}

TEST(Export, refuses_a_prismatic_joint_where_the_format_knows_none) {
  const Folder folder;
  make_individual(folder, kStanfordArm);
  for (const char* format : {"linuxcnc", "ur-yaml"}) {
    const Outcome outcome = export_as(folder, format);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.err, std::string("armsig: truth.yaml: ") + format +
                               " can't hold this arm: joint 3 is prismatic; expected six revolute "
                               "joints; urdf holds any arm\n");
    EXPECT_FALSE(std::filesystem::exists(folder / "export.out"));
  }
}

TEST(Export, refuses_another_number_of_joints_where_the_format_needs_six) {
  const Folder folder;
  make_individual(folder, kTwoJointArm);
  for (const char* format : {"linuxcnc", "ur-yaml"}) {
    const Outcome outcome = export_as(folder, format);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.err.find("it has 2 joints"), std::string::npos) << outcome.err;
  }
}

TEST(Export, refuses_couplings_that_the_format_cannot_express) {
  const Folder folder;
  std::string arm = kCoupledArm;
  make_individual(folder, arm);
  EXPECT_NE(export_as(folder, "ur-yaml").err.find("its joints are coupled"), std::string::npos);
  arm.replace(arm.find("ratio: -1"), 9, "ratio: 0.5");
  make_individual(folder, arm);
  const Outcome outcome = export_as(folder, "linuxcnc");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("joint 3 is coupled to joint 2 by 0.5"), std::string::npos);
}

TEST(Export, refuses_rows_for_axes_too_nearly_parallel_and_names_formats_that_hold_them) {
  const Folder folder;
  std::string arm = kTwoJointArm;
  arm.replace(arm.find("alpha_deg: 90"), 13, "alpha_deg: 7e-7");
  make_individual(folder, arm, "");
  const Outcome outcome = export_as(folder, "dh-csv");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("so nearly parallel"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("expected urdf, ur-yaml or json"), std::string::npos) << outcome.err;
  expect_same_poses(folder, {"json"});
}

TEST(Export, refuses_readings_that_are_corrected_by_more_than_an_offset) {
  const Folder folder;
  make_individual(folder, kPuma560);
  ASSERT_EQ(run_tool(folder,
                     "simulate --arm arm.yaml --tolerances 1 --sigma-mm 0.1 --free-poses 20 --out "
                     "m.csv")
                .status,
            0);
  const Outcome identified =
      run_tool(folder,
               "identify --arm arm.yaml --measurements m.csv --method refined --correct gain --out "
               "truth.yaml");
  ASSERT_EQ(identified.status, 0) << identified.err;
  for (const std::string& format : kOfAnySix) {
    const Outcome outcome = export_as(folder, format);
    EXPECT_EQ(outcome.status, 1) << format;
    EXPECT_NE(outcome.err.find("its joint readings are corrected"), std::string::npos)
        << outcome.err;
  }
}

TEST(Export, refuses_an_unknown_format_as_wrong_usage) {
  const Folder folder;
  make_individual(folder, kTwoJointArm);
  EXPECT_EQ(export_as(folder, "step").status, 2);
}

}  // namespace
}  // namespace armsig::cli
