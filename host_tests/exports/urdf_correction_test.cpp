// SPDX-License-Identifier: MIT
// A person's own URDF with the signature put into it: read back in Python and by KDL, and compared
// byte for byte where nothing was to change.
#include <sstream>

#include "host_tests/exports/exported_arm.hpp"

namespace armsig::cli {
namespace {

// As people have them: comments, meshes, inertias, speeds, a mount and a tool by fixed joints,
// other elements called joint, axes along any direction, either quote, an origin that is not there.
constexpr const char* kRobot = R"(<?xml version="1.0" ?>
<!-- our cell, as built: <joint name="elbow"> is the old one -->
<robot name="cell 7">
  <material name="grey"><color rgba="0.7 0.7 0.7 1"/></material>
  <link name="base_link"/>
  <joint name="mount" type="fixed"><origin xyz="0 0 0.02" rpy="0 0 3.14159265"/><parent link="base_link"/><child link="plinth"/></joint>
  <link name="plinth">
    <visual><origin xyz="0 0 0" rpy="0 0 3.14"/><geometry><mesh filename="package://cell/base.dae"/></geometry></visual>
    <inertial><mass value="4.0"/><origin xyz="0 0 0.01"/><inertia ixx="0.004" ixy="0" ixz="0" iyy="0.004" iyz="0" izz="0.007"/></inertial>
  </link>
  <joint name="pan" type="revolute">
    <parent link="plinth"/>
    <child link="l1"/>
    <origin rpy="0 0 0" xyz="0 0 0.1625" /> <!-- measured with a rule -->
    <axis xyz="0 0 1"/>
    <limit effort="150" lower="-6.28" upper="6.28" velocity="3.14"/>
    <dynamics damping="0.1"/>
  </joint>
  <link name="l1"><visual><geometry><mesh filename="package://cell/l1.dae"/></geometry></visual></link>
  <joint name="lift" type="revolute">
    <parent link="l1"/><child link="l2"/>
    <axis xyz="0 -1 0"/>
    <limit effort="150" lower="-3.1" upper="3.1" velocity="3.14"/>
  </joint>
  <link name="l2"/>
  <joint name="elbow" type="revolute"><parent link="l2"/><child link="l3"/>
    <origin xyz='-0.425 0 0'/>
    <axis xyz="0 -1 0"/><limit effort="150" lower="-3.1" upper="3.1" velocity="3.14"/></joint>
  <link name="l3"/>
  <joint name="sleeve" type="fixed"><parent link="l3"/><child link="l3b"/><origin xyz="-0.1 0.01 0" rpy="0.1 0 0"/></joint>
  <link name="l3b"/>
  <joint name="wrist one" type="revolute"><parent link="l3b"/><child link="l4"/>
    <origin
      xyz="-0.2922 -0.1333 0"
      rpy="-0.1 0 0"/>
    <axis xyz="0 -1 0"/><limit effort="28" lower="-6.28" upper="6.28" velocity="6.28"/></joint>
  <link name="l4"/>
  <joint name="wrist two" type="continuous"><parent link="l4"/><child link="l5"/>
    <origin xyz="0 0 -0.0997"/>
    <axis xyz="0 0 -1"/></joint>
  <link name="l5"/>
  <joint name="wrist three" type="revolute"><parent link="l5"/><child link="l6"/>
    <origin xyz="0 -0.0996 0" rpy="1.5707963 0 0"/>
    <axis xyz="0 0 2"/><limit effort="28" lower="-6.28" upper="6.28" velocity="6.28"/></joint>
  <link name="l6"/>
  <joint name="tool" type="fixed"><parent link="l6"/><child link="tool0"/><origin xyz="0 0 0.05" rpy="0 0.3 0"/></joint>
  <link name="tool0"/>
  <transmission name="t1"><joint name="pan"><origin xyz="9 9 9"/></joint></transmission>
  <gazebo reference="l1"><![CDATA[<joint name="lift"><origin xyz="9 9 9"/></joint>]]></gazebo>
</robot>
)";

std::vector<std::string> lines_of(const std::string& text) { return split(text, '\n'); }

// Leaves robot.urdf, the signature truth.yaml of an individual of it, its readings and poses.
void make_individual_of(const Folder& folder, const std::string& urdf, const std::string& ends,
                        const std::string& options = "--tolerances 1") {
  write_file(folder / "robot.urdf", urdf);
  const Outcome imported = run_tool(folder, "import --urdf robot.urdf --out drawing.yaml " + ends);
  ASSERT_EQ(imported.status, 0) << imported.err;
  make_individual(folder, read_file(folder / "drawing.yaml"), options);
}

Outcome export_into(const Folder& folder, const std::string& options = "") {
  return run_tool(
      folder, "export --signature truth.yaml --into robot.urdf --out corrected.urdf " + options);
}

void expect_poses_of_signature(const Folder& folder, const std::string& base,
                               const std::string& tip) {
  const std::string command = "cd '" + folder.path().string() +
                              "' && /usr/bin/python3 '" ARMSIG_READ_URDF "' corrected.urdf " +
                              base + " " + tip + " q.csv p.csv >.read 2>&1";
  const int status = std::system(command.c_str());  // NOLINT(cert-env33-c): our own command line
  const std::string said = read_file(folder / ".read");
  ASSERT_EQ(status, 0) << said;
  double distance_m = 1;
  double turn = 1;
  std::istringstream(said) >> distance_m >> turn;
  EXPECT_LT(distance_m, kExportTolerance_m);
  EXPECT_LT(turn, 1e-9);
}

TEST(UrdfCorrection, puts_the_signature_into_a_person_s_own_file) {
  const Folder folder;
  make_individual_of(folder, kRobot, "--base base_link --tip tool0");
  // The names of the joints came through import and signature: nothing else says which they are.
  const Outcome corrected = export_into(folder);
  ASSERT_EQ(corrected.status, 0) << corrected.err;
  expect_poses_of_signature(folder, "plinth", "l6");
}

TEST(UrdfCorrection, is_between_the_links_that_are_asked_for) {
  const Folder folder;
  make_individual_of(folder, kRobot, "--base base_link --tip tool0");
  const Outcome corrected = export_into(folder, "--base base_link --tip tool0");
  ASSERT_EQ(corrected.status, 0) << corrected.err;
  expect_poses_of_signature(folder, "base_link", "tool0");
}

TEST(UrdfCorrection, changes_origins_of_moving_joints_and_not_a_byte_else) {
  const Folder folder;
  make_individual_of(folder, kRobot, "--base base_link --tip tool0");
  ASSERT_EQ(export_into(folder).status, 0);
  std::string text = read_file(folder / "corrected.urdf");
  const std::size_t comment = text.find("\n<!--\nJoint origins corrected by armsig.");
  ASSERT_NE(comment, std::string::npos) << text;
  text.erase(comment, text.find("-->", comment) + 3 - comment);
  // The joint that had no origin got one, laid out as what follows.
  const std::string added = "<joint name=\"lift\" type=\"revolute\">\n    <origin xyz=";
  const std::size_t at = text.find(added);
  ASSERT_NE(at, std::string::npos) << text;
  const std::size_t line = text.find('\n', at);
  text.erase(line, text.find('\n', line + 1) - line);

  const std::vector<std::string> before = lines_of(kRobot);
  const std::vector<std::string> after = lines_of(text);
  ASSERT_EQ(after.size(), before.size());
  std::vector<std::string> changed;
  for (std::size_t k = 0; k < before.size(); ++k) {
    if (after[k] != before[k]) changed.push_back(before[k]);
  }
  const std::vector<std::string> expected{
      "    <origin rpy=\"0 0 0\" xyz=\"0 0 0.1625\" /> <!-- measured with a rule -->",
      "    <origin xyz='-0.425 0 0'/>",
      "      xyz=\"-0.2922 -0.1333 0\"",
      "      rpy=\"-0.1 0 0\"/>",
      "    <origin xyz=\"0 0 -0.0997\"/>",
      "    <origin xyz=\"0 -0.0996 0\" rpy=\"1.5707963 0 0\"/>"};
  EXPECT_EQ(changed, expected);
  EXPECT_NE(text.find("\" /> <!-- measured with a rule -->"), std::string::npos);
}

TEST(UrdfCorrection, keeps_frames_near_those_of_the_file) {
  const Folder folder;
  make_individual_of(folder, kRobot, "--base base_link --tip tool0", "");  // as drawn
  const Outcome corrected = export_into(folder, "--json");
  ASSERT_EQ(corrected.status, 0) << corrected.err;
  // 1.5707963 is not pi / 2, and the drawing is made of right angles.
  std::size_t joints = 0;
  for (std::size_t at = 0; (at = corrected.out.find("\"moved_m\": ", at)) != std::string::npos;
       at += 11, ++joints) {
    EXPECT_LT(std::stod(corrected.out.substr(at + 11)), 1e-6);
  }
  EXPECT_EQ(joints, 6U);
}

TEST(UrdfCorrection, follows_mimic_joints_and_slides) {
  for (const char* arm : {kCoupledArm, kStanfordArm}) {
    const Folder folder;
    make_individual(folder, arm, "");
    ASSERT_EQ(export_as(folder, "urdf").status, 0);
    make_individual_of(folder, read_file(folder / "export.out"),
                       "--base base_link --tip last_link");
    const Outcome corrected = export_into(folder, "--base base_link --tip last_link");
    ASSERT_EQ(corrected.status, 0) << corrected.err;
    expect_poses_of_signature(folder, "base_link", "last_link");
  }
}

TEST(UrdfCorrection, writes_the_lines_to_paste_where_xacro_made_the_file) {
  const Folder folder;
  std::string made = kRobot;
  made.insert(made.find("<robot"),
              "<!-- =====\n"
              "<!-- |    This document was autogenerated by xacro from cell.urdf.xacro    | -->\n");
  made.replace(made.find("<!-- =====\n"), 11, "");
  make_individual_of(folder, made, "--base base_link --tip tool0");
  const Outcome corrected = export_into(folder);
  ASSERT_EQ(corrected.status, 0) << corrected.err;
  const std::string lines = read_file(folder / "corrected.urdf.origins.txt");
  EXPECT_NE(lines.find("to paste into cell.urdf.xacro:\n\npan\n  <origin xyz=\""),
            std::string::npos)
      << lines;
  // The very line that the corrected file has for a joint without an origin of its own.
  const std::size_t at = lines.find("lift\n  ");
  ASSERT_NE(at, std::string::npos);
  const std::string lift = lines.substr(at + 7, lines.find('\n', at + 7) - at - 7);
  EXPECT_NE(read_file(folder / "corrected.urdf").find(lift), std::string::npos) << lift;
  EXPECT_NE(corrected.out.find("Next: paste the origins of"), std::string::npos) << corrected.out;
}

TEST(UrdfCorrection, says_what_a_file_lacks) {
  const Folder folder;
  make_individual_of(folder, kRobot, "--base base_link --tip tool0");
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& what,
                          const std::string& options = "") {
    std::string text = kRobot;
    text.replace(text.find(from), from.size(), to);
    write_file(folder / "robot.urdf", text);
    const Outcome outcome = export_into(folder, options);
    EXPECT_EQ(outcome.status, 2) << what;
    EXPECT_NE(outcome.err.find(what), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "corrected.urdf"));
  };
  expect("<link name=\"base_link\"/>", "<xacro:include filename=\"a\"/><link name=\"base_link\"/>",
         "robot.urdf:5: xacro that is not expanded; expected xacro FILE -o arm.urdf first");
  expect("\"wrist two\"", "\"wrist 2\"", "there is no joint \"wrist two\"; expected the joints");
  expect("<axis xyz=\"0 0 -1\"/>", "<axis xyz=\"0 0 1\"/>",
         "the axis of joint \"wrist two\" is 179.");
  expect("\"continuous\"", "\"prismatic\"", "joint \"wrist two\" is prismatic, joint 5");
  expect("-0.425 0 0", "-0.525 0 0", "of the signature; expected a file of this arm");
  expect("<axis xyz", "<axis xyz", "5 joints move, the signature has 6",
         "--base base_link --tip l5");
}

TEST(UrdfCorrection, asks_for_the_links_where_the_signature_has_no_names) {
  const Folder folder;
  make_individual(folder, kPuma560);
  write_file(folder / "robot.urdf", kRobot);
  const Outcome outcome = export_into(folder);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("--base and --tip"), std::string::npos) << outcome.err;
  EXPECT_EQ(export_into(folder, "--base base_link").status, 2);
  EXPECT_EQ(export_into(folder, "--format urdf").status, 2);
  EXPECT_EQ(run_tool(folder, "export --signature truth.yaml --out x").status, 2);
}

TEST(UrdfCorrection, names_of_joints_come_through_to_an_export) {
  const Folder folder;
  make_individual_of(folder, kRobot, "--base base_link --tip tool0");
  ASSERT_EQ(export_as(folder, "urdf").status, 0);
  EXPECT_NE(read_file(folder / "export.out").find("<joint name=\"wrist two\" type=\"continuous\">"),
            std::string::npos);
}

}  // namespace
}  // namespace armsig::cli
