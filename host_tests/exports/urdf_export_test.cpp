// SPDX-License-Identifier: MIT
// URDF as others read it: check_urdf of urdfdom, and the chain of KDL.
#include <cmath>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <map>

#include "host_tests/exports/exported_arm.hpp"

namespace armsig::cli {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

// Readings by the name of the joint that they move, those of mimic joints too.
std::map<std::string, double> joint_values(const Csv& joints, std::size_t row) {
  std::map<std::string, double> values;
  for (const std::string& column : joints.header) {
    const double unit = column.ends_with("_deg") ? kDegree : 1e-3;
    values["joint_" + column.substr(1, 1)] = unit * joints.number(row, column);
  }
  values["joint_3_from_2"] = -values["joint_2"];  // of kCoupledArm
  return values;
}

KDL::Frame frame_by_kdl(const KDL::Tree& tree, const std::string& tip,
                        const std::map<std::string, double>& values) {
  KDL::Chain chain;
  EXPECT_TRUE(tree.getChain("sensor", tip, chain));
  KDL::JntArray q(chain.getNrOfJoints());
  unsigned int moving = 0;
  for (const KDL::Segment& segment : chain.segments) {
    if (segment.getJoint().getType() == KDL::Joint::None) continue;
    q(moving++) = values.at(segment.getJoint().getName());
  }
  KDL::Frame frame;
  KDL::ChainFkSolverPos_recursive solver(chain);
  EXPECT_GE(solver.JntToCart(q, frame), 0);
  return frame;
}

void expect_agreement(const Folder& folder, const std::string& tip, const std::string& poses) {
  KDL::Tree tree;
  ASSERT_TRUE(kdl_parser::treeFromFile((folder / "export.out").string(), tree));
  const Csv joints = Csv::read(folder / "q.csv");
  const Csv expected = Csv::read(folder / poses);
  for (std::size_t row = 0; row < joints.rows.size(); ++row) {
    const KDL::Frame frame = frame_by_kdl(tree, tip, joint_values(joints, row));
    const double distance_m = std::hypot(frame.p.x() - expected.number(row, "x_m"),
                                         frame.p.y() - expected.number(row, "y_m"),
                                         frame.p.z() - expected.number(row, "z_m"));
    EXPECT_LT(distance_m, kExportTolerance_m) << "row " << row;
    if (tip != "last_link") continue;
    const KDL::Rotation turn =
        KDL::Rotation::Quaternion(expected.number(row, "qx"), expected.number(row, "qy"),
                                  expected.number(row, "qz"), expected.number(row, "qw"));
    EXPECT_TRUE(KDL::Equal(turn, frame.M, 1e-9)) << "row " << row;
  }
}

void expect_valid_and_exact(const Folder& folder) {
  const Outcome exported = export_as(folder, "urdf");
  ASSERT_EQ(exported.status, 0) << exported.err;
  const std::string check = "check_urdf '" + (folder / "export.out").string() + "' >'" +
                            (folder / ".check").string() + "' 2>&1";
  // NOLINTNEXTLINE(cert-env33-c): our own command line
  EXPECT_EQ(std::system(check.c_str()), 0) << read_file(folder / ".check");
  expect_agreement(folder, "last_link", "p.csv");
}

TEST(UrdfExport, is_valid_and_gives_the_poses_of_an_individual_puma) {
  const Folder folder;
  make_individual(folder, kPuma560);
  expect_valid_and_exact(folder);
}

TEST(UrdfExport, carries_the_targets) {
  const Folder folder;
  make_individual(folder, kPuma560);
  expect_valid_and_exact(folder);
  const Outcome predicted =
      run_tool(folder, "predict --signature truth.yaml --joints q.csv --target 6 --out t.csv");
  ASSERT_EQ(predicted.status, 0) << predicted.err;
  expect_agreement(folder, "target_6", "t.csv");
}

TEST(UrdfExport, is_exact_for_nearly_parallel_axes_and_for_slides) {
  for (const char* name : {"ur10e-individual-a", "ur10e-individual-b", "puma560-stone1986-robot1",
                           "stanford", "iiwa7", "cobra600"}) {
    SCOPED_TRACE(name);
    const std::string arm = shared_arm(name);
    if (arm.empty()) GTEST_SKIP() << "no arm descriptions in " << ARMSIG_SHARED_DATA;
    const Folder folder;
    make_individual(folder, arm, "");
    expect_valid_and_exact(folder);
  }
}

TEST(UrdfExport, holds_axes_that_no_denavit_hartenberg_row_can) {
  const Folder folder;
  std::string arm = kTwoJointArm;
  arm.replace(arm.find("alpha_deg: 90"), 13, "alpha_deg: 7e-7");
  make_individual(folder, arm, "");
  expect_valid_and_exact(folder);
}

TEST(UrdfExport, moves_a_coupled_joint_by_a_mimic_joint_about_the_same_axis) {
  const Folder folder;
  make_individual(folder, kCoupledArm);
  expect_valid_and_exact(folder);
}

}  // namespace
}  // namespace armsig::cli
