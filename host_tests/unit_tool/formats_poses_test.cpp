// SPDX-License-Identifier: MIT
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "firmware/formats/poses.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/temporary.hpp"

namespace armsig::tool {
namespace {

const JointTypes kTypes{JointType::kRevolute, JointType::kPrismatic};

std::string joints_message(const std::string& text) {
  const auto poses = parse_joint_poses(text, "Q.csv", kTypes);
  return poses ? "read" : render(poses.error());
}

std::string tools_message(const std::string& text) {
  const auto poses = parse_tool_poses(text, "P.csv");
  return poses ? "read" : render(poses.error());
}

TEST(JointPoses, are_given_in_si) {
  const auto poses = parse_joint_poses("q2_mm,q1_deg\n250,180\n-1,0\n", "Q.csv", kTypes);
  ASSERT_TRUE(poses) << render(poses.error());
  ASSERT_EQ(poses->size(), 2U);
  EXPECT_EQ((*poses)[0][0], kPi);
  EXPECT_EQ((*poses)[0][1], 0.25);
  EXPECT_EQ((*poses)[1][1], -0.001);
}

TEST(JointPoses, refuse_what_they_do_not_know) {
  EXPECT_EQ(joints_message("q1_deg\n1\n"),
            "Q.csv:1: there is no column for q2; expected q2_mm or q2_m");
  EXPECT_EQ(joints_message("q1_deg,q2_deg\n1,2\n"),
            "Q.csv:1:8: column \"q2_deg\" has another unit, and joint 2 is prismatic; expected "
            "q2_mm or q2_m");
  EXPECT_EQ(joints_message("q1_deg,q2_mm,q3_deg\n1,2,3\n"),
            "Q.csv:1:14: column \"q3_deg\" is for a joint outside the arm, which has 2; expected "
            "q1 to q2");
  EXPECT_EQ(joints_message("q1_deg,q2_mm\n1\n"),
            "Q.csv:2:2: the row ends after 1 of 2 fields; expected q2_mm next");
  EXPECT_EQ(joints_message("q1_deg,q2_mm\n1,\n"), "Q.csv:2:3: q2_mm is empty; expected a number");
  EXPECT_EQ(joints_message("q1_deg,q2_mm\n"),
            "Q.csv:1: the file ends after its header; expected rows of poses");
}

TEST(JointPoses, read_back_as_written) {
  const std::string path = test::temporary("joints.csv");
  const std::vector<JointVector> written{{1.0 / 3, -0.7}, {-3, 1e-9}};
  ASSERT_TRUE(write_joint_poses(path, kTypes, written, "from a test"));
  const auto read = read_joint_poses(path, kTypes);
  ASSERT_TRUE(read) << render(read.error());
  ASSERT_EQ(read->size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR((*read)[k][0], written[k][0], 1e-15);
    EXPECT_NEAR((*read)[k][1], written[k][1], 1e-15);
  }
  std::filesystem::remove(path);
}

TEST(JointPoses, that_are_not_finite_are_not_written) {
  const std::string path = test::temporary("never.csv");
  const std::vector<JointVector> poses{{std::nan(""), 0}};
  const auto written = write_joint_poses(path, kTypes, poses);
  ASSERT_FALSE(written);
  EXPECT_EQ(render(test::failure_of(written)),
            path +
                ": a pose to be written is not finite; expected finite "
                "numbers");
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(ToolPoses, are_given_in_si) {
  const auto poses =
      parse_tool_poses("x_mm,y_m,z_m,qw,qx,qy,qz\n500,2,3,0.7071,0,0,0.7071\n", "P.csv");
  ASSERT_TRUE(poses) << render(poses.error());
  EXPECT_EQ(poses->front().p, Vector3(0.5, 2, 3));
  EXPECT_TRUE(poses->front().R.isApprox(rotation_z(kPi / 2), 1e-15));
}

TEST(ToolPoses, refuse_what_they_do_not_know) {
  EXPECT_EQ(tools_message("x,y_m,z_m,qw,qx,qy,qz\n"),
            "P.csv:1:1: column \"x\" has no unit; expected x_mm or x_m");
  EXPECT_EQ(tools_message("x_m,y_m,z_m,qw,qx,qy\n"),
            "P.csv:1: there is no column for qz; expected qz");
  EXPECT_EQ(tools_message("x_m,y_m,z_m,qw,qx,qy,qz\n"),
            "P.csv:1: the file ends after its header; expected rows of poses");
  EXPECT_EQ(tools_message("x_m,y_m,z_m,qw,qx,qy,qz\n1,2,3,1,0,0,.nan\n"),
            "P.csv:2:13: qz: \".nan\" is not a finite number; expected a number");
}

TEST(ToolPoses, refuse_a_quaternion_that_is_no_unit) {
  EXPECT_EQ(tools_message("x_m,y_m,z_m,qw,qx,qy,qz\n1,2,3,1,1,0,0\n"),
            "P.csv:2:7: a quaternion of length 1.41421; expected a unit quaternion qw, qx, qy, qz");
  EXPECT_EQ(tools_message("x_m,y_m,z_m,qw,qx,qy,qz\n1,2,3,0,0,0,0\n"),
            "P.csv:2:7: a quaternion of length 0; expected a unit quaternion qw, qx, qy, qz");
}

// One rotation in every form: about z by 90, then about the new y by 30, the new x by 20 degrees.
// The numbers were computed by another program.
TEST(ToolPoses, take_orientations_as_makers_write_them) {
  const Matrix3 expected = rotation_z(radians(90)) * rotation_about(Vector3::UnitY(), radians(30)) *
                           rotation_x(radians(20));
  for (const char* form :
       {"q1,q2,q3,q4\n1,2,3,0.704416026403,-0.0616284167162,0.29883623873,0.640856382056",
        "a_deg,b_deg,c_deg\n1,2,3,90,30,20", "w_deg,p_deg,r_deg\n1,2,3,20,30,90",
        "ur_rx_rad,ur_ry_rad,ur_rz_rad\n1,2,3,-0.137046446583,0.664538321934,1.42510703033",
        "staubli_rx_deg,staubli_ry_deg,staubli_rz_deg\n1,2,3,-30,20,90"}) {
    const auto poses = parse_tool_poses(std::string("x_m,y_m,z_m,") + form + "\n", "P.csv");
    ASSERT_TRUE(poses) << render(poses.error());
    EXPECT_TRUE(poses->front().R.isApprox(expected, 1e-8)) << form;
  }
}

TEST(ToolPoses, take_a_rotation_vector_of_no_length) {
  const auto poses =
      parse_tool_poses("x_m,y_m,z_m,ur_rx_rad,ur_ry_rad,ur_rz_rad\n1,2,3,0,0,0\n", "P.csv");
  ASSERT_TRUE(poses) << render(poses.error());
  EXPECT_EQ(poses->front().R, Matrix3(Matrix3::Identity()));
}

TEST(ToolPoses, want_one_orientation) {
  EXPECT_EQ(tools_message("x_m,y_m,z_m,a_deg,b_deg,c_deg,w_deg,p_deg,r_deg\n1,2,3,0,0,0,0,0,0\n"),
            "P.csv:1: orientations by the columns a, b, c and w, p, r; expected one of the two");
  EXPECT_EQ(tools_message("x_m,y_m,z_m,a_deg,b_deg\n1,2,3,0,0\n"),
            "P.csv:1: there is no column for c; expected c_deg or c_rad");
  EXPECT_NE(tools_message("x_m,y_m,z_m\n1,2,3\n").find("there are no columns of an orientation"),
            std::string::npos);
  EXPECT_EQ(tools_message("x_m,y_m,z_m,q1_deg,q2_deg\n").find("outside the arm"),
            std::string::npos);
}

TEST(ToolPoses, read_back_as_written) {
  const std::string path = test::temporary("tools.csv");
  const std::vector<Pose> written{{rotation_z(3.1) * rotation_x(-0.4), Vector3(1, -2, 0.1)},
                                  {rotation_x(kPi), Vector3(0, 0, 1e-9)}};
  ASSERT_TRUE(write_tool_poses(path, written));
  const auto read = read_tool_poses(path);
  ASSERT_TRUE(read) << render(read.error());
  ASSERT_EQ(read->size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ((*read)[k].p, written[k].p);
    EXPECT_LT(angle_between((*read)[k].R, written[k].R), 1e-15);
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace armsig::tool
