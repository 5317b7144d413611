// SPDX-License-Identifier: MIT
// What people get wrong in the files that are imported: said with the place, never taken in
// silence.
#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

// Three joints and a fixed one below; lines are those of the file.
constexpr const char* kGoodUrdf =
    "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n"
    "<link name=\"base\"/><link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>\n"
    "<link name=\"tip\"/>\n"
    "<joint name=\"j1\" type=\"revolute\"><parent link=\"base\"/><child link=\"a\"/>\n"
    "<origin xyz=\"0 0 0.3\"/><axis xyz=\"0 0 1\"/><limit lower=\"-2\" upper=\"2\"/></joint>\n"
    "<joint name=\"j2\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/>\n"
    "<origin xyz=\"0.1 0 0.1\" rpy=\"-1.5707963267948966 0 0\"/><axis xyz=\"0 0 1\"/>\n"
    "<limit lower=\"-2.5\" upper=\"2.5\"/></joint>\n"
    "<joint name=\"j3\" type=\"revolute\"><parent link=\"b\"/><child link=\"c\"/>\n"
    "<origin xyz=\"0.4 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\"/></joint>\n"
    "<joint name=\"f\" type=\"fixed\"><parent link=\"c\"/><child link=\"tip\"/>\n"
    "<origin xyz=\"0.3 0 0.05\" rpy=\"0 0 0\"/></joint>\n"
    "</robot>\n";

std::string changed(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), std::string::npos) << from;
  return text.replace(text.find(from), from.size(), to);
}

Outcome urdf_imported(const Folder& folder, const std::string& text) {
  write_file(folder / "r.urdf", text);
  return run_tool(folder, "import --urdf r.urdf --base base --tip tip --out a.yaml");
}

void expect_refused_urdf(const std::string& text, const std::string& said) {
  const Folder folder;
  const Outcome outcome = urdf_imported(folder, text);
  EXPECT_EQ(outcome.status, 2) << said;
  EXPECT_NE(outcome.err.find(said), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "a.yaml"));
}

TEST(ImportMistakes, takes_the_file_that_the_others_are_made_of) {
  const Folder folder;
  const Outcome outcome = urdf_imported(folder, kGoodUrdf);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out.find("made parallel"), std::string::npos) << outcome.out;
}

TEST(ImportMistakes, refuses_degrees_in_rpy) {
  expect_refused_urdf(changed(kGoodUrdf, "-1.5707963267948966 0 0", "90 0 0"),
                      "r.urdf:7: rpy: \"90 0 0\"; expected radians");
}

TEST(ImportMistakes, refuses_millimetres_in_xyz) {
  expect_refused_urdf(changed(kGoodUrdf, "0.1 0 0.1", "300 0 100"),
                      "r.urdf:7: xyz: \"300 0 100\"; expected metres");
}

TEST(ImportMistakes, refuses_limits_of_fifty_seven_turns) {
  expect_refused_urdf(
      changed(kGoodUrdf, "lower=\"-2.5\" upper=\"2.5\"", "lower=\"-360\" upper=\"360\""),
      "r.urdf:8: limit of joint \"j2\": -360 to 360; expected radians");
}

TEST(ImportMistakes, refuses_a_stroke_in_millimetres) {
  const std::string slide = changed(kGoodUrdf, "j2\" type=\"revolute", "j2\" type=\"prismatic");
  expect_refused_urdf(changed(slide, "lower=\"-2.5\" upper=\"2.5\"", "lower=\"0\" upper=\"500\""),
                      "r.urdf:8: limit of joint \"j2\": 0 to 500; expected metres");
}

TEST(ImportMistakes, names_the_exporter_that_writes_limits_of_nothing) {
  expect_refused_urdf(changed(kGoodUrdf, "lower=\"-2.5\" upper=\"2.5\"", "lower=\"0\" upper=\"0\""),
                      "r.urdf:8: limit of joint \"j2\": 0 to 0; expected the limits that the joint "
                      "has; the exporter of SolidWorks writes 0 and 0 where none are given");
}

TEST(ImportMistakes, refuses_one_limit_without_the_other) {
  expect_refused_urdf(changed(kGoodUrdf, "lower=\"-2.5\"", "lower=\"-inf\""),
                      "limit of joint \"j2\": -inf to 2.5; expected both limits");
}

TEST(ImportMistakes, refuses_a_link_with_two_parents) {
  expect_refused_urdf(
      changed(kGoodUrdf, "</robot>",
              "<joint name=\"again\" type=\"fixed\"><parent link=\"a\"/>\n"
              "<child link=\"c\"/></joint></robot>"),
      "r.urdf:13: link \"c\" hangs on joint \"j3\" and on joint \"again\"; expected one joint");
}

TEST(ImportMistakes, passes_over_definitions_of_xacro_that_stand_for_no_joint) {
  const Folder folder;
  const Outcome outcome = urdf_imported(
      folder, changed(kGoodUrdf, "<link name=\"base\"/>",
                      "<xacro:property name=\"width\" value=\"0.2\"/><link name=\"base\"/>"));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST(ImportMistakes, refuses_xacro_inside_a_joint_of_the_path) {
  expect_refused_urdf(
      changed(kGoodUrdf, "<origin xyz=\"0.4 0 0\"/>", "<xacro:insert_block name=\"origin\"/>"),
      "r.urdf:10: xacro that is not expanded, in joint \"j3\"; expected xacro FILE -o");
  expect_refused_urdf(changed(kGoodUrdf, "<link name=\"base\"/>", "<xacro:arm/><link name=\"x\"/>"),
                      "r.urdf:2: xacro that is not expanded");
}

TEST(ImportMistakes, names_the_line_of_two_joints_of_one_name) {
  expect_refused_urdf(changed(kGoodUrdf, "joint name=\"j3\"", "joint name=\"j1\""),
                      "r.urdf:9: two joints are called \"j1\"; expected a name of its own");
}

TEST(ImportMistakes, names_the_line_of_a_joint_without_a_name) {
  expect_refused_urdf(changed(kGoodUrdf, "joint name=\"j3\"", "joint"),
                      "r.urdf:9: a joint without a name; expected a name");
}

TEST(ImportMistakes, takes_a_robot_without_a_name) {
  const Folder folder;
  EXPECT_EQ(urdf_imported(folder, changed(kGoodUrdf, "robot name=\"r\"", "robot")).status, 0);
  EXPECT_NE(read_file(folder / "a.yaml").find("imported arm"), std::string::npos);
}

TEST(ImportMistakes, names_other_formats) {
  expect_refused_urdf("<mujoco model=\"r\">\n</mujoco>",
                      "r.urdf:1: the file is MJCF, a model of MuJoCo; expected a URDF file");
  expect_refused_urdf("<?xml version=\"1.0\"?>\n<sdf version=\"1.9\"></sdf>",
                      "r.urdf:2: the file is SDF, a model of Gazebo; expected a URDF file");
}

TEST(ImportMistakes, says_that_a_tip_was_straightened) {
  const Folder folder;
  const Outcome outcome =
      urdf_imported(folder, changed(kGoodUrdf, "rpy=\"0 0 0\"", "rpy=\"0.000009 0 0\""));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("the z axis of the tip link was 9e-06 rad from parallel to axis 3"),
            std::string::npos)
      << outcome.out;
}

Outcome dh_imported(const Folder& folder, const std::string& text) {
  write_file(folder / "dh.csv", text);
  return run_tool(folder, "import --dh dh.csv --out a.yaml");
}

void expect_refused_dh(const std::string& text, const std::string& said) {
  const Folder folder;
  const Outcome outcome = dh_imported(folder, text);
  EXPECT_EQ(outcome.status, 2) << said;
  EXPECT_NE(outcome.err.find(said), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "a.yaml"));
}

TEST(ImportMistakes, refuses_degrees_under_radians_and_the_reverse) {
  expect_refused_dh("theta_rad,d_m,a_m,alpha_rad\n0,0.1625,0,90\n",
                    "dh.csv:2:12: alpha_rad: \"90\"; expected radians, or a column in _deg");
  expect_refused_dh("theta_deg,d_m,a_m,alpha_deg\n0,0.1625,0,1.5708\n0,0,-0.425,0\n",
                    "all angles in degrees are parts of pi; expected degrees, or columns in _rad");
  expect_refused_dh("theta_deg,d_m,a_m,alpha_deg\n0,0.1625,0,pi/2\n",
                    "alpha_deg: \"pi/2\"; expected degrees, or a column in _rad");
}

TEST(ImportMistakes, takes_small_twists_in_degrees_beside_large_ones) {
  const Folder folder;
  EXPECT_EQ(dh_imported(folder, "theta_deg,d_m,a_m,alpha_deg\n0,0.2,0,1.5708\n0,0,0.4,90\n").status,
            0);
}

TEST(ImportMistakes, refuses_millimetres_under_metres_and_the_reverse) {
  expect_refused_dh("theta_rad,d_m,a_m,alpha_rad\n0,162.5,0,pi/2\n",
                    "dh.csv:2:3: d_m: \"162.5\"; expected metres, or a column in _mm");
  expect_refused_dh("theta_rad,d_mm,a_mm,alpha_rad\n0,0.1625,0,pi/2\n0,0,-0.425,0\n",
                    "all lengths together are 0.587 mm; expected millimetres, or columns in _m");
}

TEST(ImportMistakes, refuses_joints_in_another_order) {
  expect_refused_dh("joint,theta_rad,d_m,a_m,alpha_rad\n3,0,3,0,1.5708\n2,0,2,0,0\n1,0,1,0,0\n",
                    "dh.csv:2:1: joint: 3 in the row of joint 1; expected the joints in order");
  const Folder folder;
  EXPECT_EQ(dh_imported(folder, "joint,theta_rad,d_m,a_m,alpha_rad\n0,0,1,0,0\n1,0,0,1,0\n").status,
            0);
}

TEST(ImportMistakes, refuses_limits_of_rows_in_degrees) {
  expect_refused_dh("theta_rad,d_m,a_m,alpha_rad,lower_rad_or_m,upper_rad_or_m\n0,1,0,0,-170,170\n",
                    "limits of joint 1: -170 to 170; expected radians");
}

TEST(ImportMistakes, takes_limits_of_rows_that_mean_none) {
  const Folder folder;
  for (const char* limits : {",", "-inf,inf", "-1e16,1e16"}) {
    const Outcome outcome = dh_imported(
        folder, std::string("theta_rad,d_m,a_m,alpha_rad,lower_rad_or_m,upper_rad_or_m\n0,1,0,0,") +
                    limits + "\n");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(read_file(folder / "a.yaml").find("limits: none"), std::string::npos) << limits;
  }
}

TEST(ImportMistakes, refuses_one_limit_of_a_row_without_the_other) {
  expect_refused_dh("theta_rad,d_m,a_m,alpha_rad,lower_rad_or_m,upper_rad_or_m\n0,1,0,0,-1,inf\n",
                    "limits of joint 1: -1 to inf; expected radians; nothing in both");
}

TEST(ImportMistakes, reads_rows_as_spreadsheets_write_them) {
  const Folder folder;
  ASSERT_EQ(dh_imported(folder,
                        "theta_rad,d_m,a_m,alpha_rad\n0,0.1625,0,1.5707963267948966\n"
                        "0.78539816339744828,0,-0.425,-2.3561944901923448\n")
                .status,
            0);
  const std::string expected = read_file(folder / "a.yaml");
  for (const char* text : {"theta_rad;d_m;a_m;alpha_rad\n0;0,1625;0;pi/2\npi/4;0;-0,425;-3*pi/4\n",
                           "theta_rad\td_m\ta_m\talpha_rad\n0\t0.1625\t0\tpi / 2\n"
                           "0.25 pi\t0\t-0.425\t-0.75*pi\n",
                           "theta_rad d_m a_m alpha_rad\n0 0.1625 0 \xCF\x80/2\n"
                           "\xCF\x80/4 0 -0.425 -3*\xCF\x80/4\n"}) {
    const Outcome outcome = dh_imported(folder, text);
    EXPECT_EQ(outcome.status, 0) << text << outcome.err;
    EXPECT_EQ(read_file(folder / "a.yaml"), expected) << text;
  }
}

TEST(ImportMistakes, says_what_is_wrong_with_a_part_of_pi) {
  expect_refused_dh("theta_rad;d_m;a_m;alpha_rad\n0;0,1625;0;pi/0\n",
                    "dh.csv:2:12: alpha_rad: \"pi/0\"; expected a number, or such as pi/2");
  expect_refused_dh("theta_rad;d_m;a_m;alpha_rad\n0;0,1625;0;2pi2\n", "\"2pi2\"");
}

}  // namespace
}  // namespace armsig::cli
