// SPDX-License-Identifier: MIT
// What the readers of robot programs take for targets, and what they leave, by line.
#include <gtest/gtest.h>

#include "firmware/host_tool/programs/readers.hpp"
#include "host_tests/unit_tool/reading_programs.hpp"

namespace armsig::tool {
namespace {

TEST(Frames, are_read_as_mm_and_degrees_quaternion_or_urscript) {
  const auto abc = parse_frame("--tool", "1000, 0, 0, 90, 0, 0");
  const auto quaternion = parse_frame("--tool", "1000,0,0,0.70710678118,0,0,0.70710678118");
  const auto ur = parse_frame("--tool", "p[1, 0, 0, 0, 0, 1.5707963267949]");
  ASSERT_TRUE(abc && quaternion && ur);
  const Vector3 there(1, 1, 0);
  EXPECT_LT((*abc * Vector3::UnitX() - there).norm(), 1e-9);
  EXPECT_LT((*quaternion * Vector3::UnitX() - there).norm(), 1e-9);
  EXPECT_LT((*ur * Vector3::UnitX() - there).norm(), 1e-9);
}

TEST(Frames, of_another_count_of_numbers_are_refused) {
  for (const char* text : {"", "1,2,3", "1,2,3,4,5,x", "p[1,2,3,4,5,6,7]", "1,0,0,0,0,0,0"}) {
    EXPECT_FALSE(parse_frame("--tool", text)) << text;
  }
}

TEST(Urscript, takes_poses_and_readings_of_moves) {
  const std::string text = "movej([0.1, -1.2, 3e-1, 0, 0, 0], a=1)\nmovel(p[1,2,3,0,0,0.5], v=2)\n";
  const Program program = read_urscript(text, flange());
  ASSERT_EQ(program.targets.size(), 2U);
  EXPECT_TRUE(program.left.empty());
  EXPECT_TRUE(program.targets[0].joints);
  EXPECT_DOUBLE_EQ(program.targets[0].values[2], 0.3);
  EXPECT_EQ(program.targets[1].line, 2);
  const Bytes last = program.targets[1].numbers[5];
  EXPECT_EQ(text.substr(last.begin, last.end - last.begin), "0.5");
}

TEST(Urscript, takes_both_poses_of_an_arc) {
  const Program program = read_urscript("movec(p[1,2,3,0,0,0], p[1,2,4,0,0,0], r=0.01)", flange());
  EXPECT_EQ(program.targets.size(), 2U);
}

TEST(Urscript, takes_a_variable_once_where_it_is_written) {
  const Program program =
      read_urscript("global home = p[1,2,3,0,0,0]\nmovel(home)\nmovel(home)\n", flange());
  ASSERT_EQ(program.targets.size(), 1U);
  EXPECT_EQ(program.targets[0].line, 1);
  EXPECT_EQ(program.targets[0].name, "home");
}

TEST(Urscript, leaves_what_is_computed) {
  expect_left(read_urscript("\nmovel(pose_trans(a, p[1,2,3,0,0,0]))", flange()), 2, "computed");
  const Program changed = read_urscript("h = p[1,2,3,0,0,0]\nh[2] = 0.5\nmovel(h)", flange());
  EXPECT_TRUE(is_left(changed, 1, "no move here goes to it"));
  EXPECT_TRUE(is_left(changed, 3, "computed"));
  expect_left(read_urscript("movel(p[1,2,3,0,0,d2r(90)])", flange()), 1, "computed");
}

TEST(Urscript, leaves_comments_and_strings) {
  const Program program =
      read_urscript("# movel(p[1,2,3,0,0,0])\ntextmsg(\"movel(p[1,2,3,0,0,0])\")", flange());
  EXPECT_TRUE(program.targets.empty());
  EXPECT_TRUE(program.left.empty());
}

TEST(Urscript, needs_the_tool) {
  expect_left(read_urscript("movel(p[1,2,3,0,0,0])", {}), 1, "--tool");
  expect_left(read_urscript("set_tcp(f())\nmovel(p[1,2,3,0,0,0])", flange()), 2, "line 1");
}

TEST(Urscript, takes_the_tool_that_the_program_sets) {
  const Program program = read_urscript("set_tcp(p[0,0,0.1,0,0,0])\nmovel(p[1,2,3,0,0,0])", {});
  ASSERT_EQ(program.targets.size(), 1U);
  EXPECT_DOUBLE_EQ(program.targets[0].X_FT.p.z(), 0.1);
}

constexpr const char* kRobtarget =
    "CONST robtarget p10:=[[1,2,3],[1,0,0,0],[0,-1,1,2],[9E9,9E9,9E9,9E9,9E9,9E9]];\n";

TEST(Rapid, takes_a_robtarget_with_its_configuration) {
  const Program program = read_rapid(std::string(kRobtarget) + "MoveL p10,v100,z10,tool0;", {});
  ASSERT_EQ(program.targets.size(), 1U);
  EXPECT_TRUE(program.left.empty());
  EXPECT_EQ(program.targets[0].configuration, (std::vector<long>{0, -1, 1, 2}));
  EXPECT_EQ(program.targets[0].name, "p10");
  EXPECT_TRUE(program.targets[0].linear);
}

TEST(Rapid, takes_tool_and_work_object_of_the_module) {
  const Program program = read_rapid(
      std::string(kRobtarget) +
          "PERS tooldata t:=[TRUE,[[0,0,100],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];\n"
          "PERS wobjdata w:=[FALSE,TRUE,\"\",[[10,0,0],[1,0,0,0]],[[5,0,0],[1,0,0,0]]];\n"
          "ArcL \\On, p10,v100,seam1,weld1,z10,T\\WObj:=w;",
      {});
  ASSERT_EQ(program.targets.size(), 1U) << program.left.size();
  EXPECT_DOUBLE_EQ(program.targets[0].X_FT.p.z(), 0.1);
  EXPECT_DOUBLE_EQ(program.targets[0].X_BW.p.x(), 0.015);
}

TEST(Rapid, takes_a_target_in_the_instruction) {
  const Program program = read_rapid(
      "PROC main()\n MoveJ [[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v100,fine,"
      "tool0;",
      {});
  ASSERT_EQ(program.targets.size(), 1U);
  EXPECT_EQ(program.targets[0].line, 2);
}

TEST(Rapid, names_what_it_leaves) {
  const std::string p10(kRobtarget);
  expect_left(read_rapid(p10 + "MoveL p10,v100,z10,tGun;", {}), 1, "--tool TGUN=");
  expect_left(read_rapid("MoveL p20,v100,z10,tool0;", {}), 1, "not declared here");
  expect_left(read_rapid(p10, {}), 1, "no instruction");
  const Program offset =
      read_rapid(p10 + "MoveL p10,v1,z1,tool0;\nMoveL Offs(p10,0,0,9),v1,z1,tool0;", {});
  expect_left(offset, 3, "moves with the correction of p10");
  EXPECT_EQ(offset.targets.size(), 1U);
}

TEST(Rapid, finds_a_given_tool_in_small_and_capital_letters) {
  ProgramFrames frames;
  EXPECT_TRUE(frames.tools.add("--tool", "tGun=0,0,100,0,0,0"));
  const Program program = read_rapid(std::string(kRobtarget) + "MoveL p10,v1,z1,TGUN;", frames);
  ASSERT_EQ(program.targets.size(), 1U);
  EXPECT_DOUBLE_EQ(program.targets[0].X_FT.p.z(), 0.1);
}

TEST(Rapid, leaves_a_tool_that_the_robot_does_not_hold) {
  expect_left(read_rapid(std::string(kRobtarget) +
                             "PERS tooldata t:=[FALSE,[[0,0,1],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],"
                             "0,0,0]];\nMoveL p10,v100,z10,t;",
                         {}),
              1, "not held by the robot");
}

TEST(Rapid, names_a_target_of_two_tools) {
  ProgramFrames frames;
  EXPECT_TRUE(frames.tools.add("--tool", "TGUN=0,0,1,0,0,0"));
  const Program program =
      read_rapid(std::string(kRobtarget) + "MoveL p10,v1,z1,tool0;\nMoveL p10,v1,z1,tGun;", frames);
  expect_left(program, 3, "another tool");
}

constexpr const char* kPos = "{X 1,Y 2.5,Z -3,A 10,B 20,C 30,S 2,T 10}";

TEST(Krl, takes_poses_of_motions_with_status_and_turn) {
  const Program program =
      read_krl("$TOOL=$NULLFRAME\n$BASE={X 10,Y 0,Z 0,A 0,B 0,C 0}\nLIN " + std::string(kPos) +
                   " C_DIS\nptp {a1 1,a2 2,a3 3,a4 4,a5 5,a6 6}\n",
               {});
  ASSERT_EQ(program.targets.size(), 2U);
  EXPECT_EQ(program.targets[0].configuration, (std::vector<long>{2, 10}));
  EXPECT_DOUBLE_EQ(program.targets[0].X_BW.p.x(), 0.01);
  EXPECT_TRUE(program.targets[1].joints);
  EXPECT_FALSE(program.targets[1].linear);
}

TEST(Krl, takes_points_of_a_dat_with_the_numbers_of_their_tools) {
  ProgramFrames frames;
  EXPECT_TRUE(frames.tools.add("--tool", "3=0,0,100,0,0,0"));
  const Program program =
      read_krl("DEFDAT X\nDECL E6POS XP1=" + std::string(kPos) +
                   "\nDECL FDAT FP1={TOOL_NO 3,BASE_NO 0,IPO_FRAME #BASE,POINT2[] \" \"}\nENDDAT\n",
               frames);
  ASSERT_EQ(program.targets.size(), 1U);
  EXPECT_EQ(program.targets[0].name, "XP1");
  EXPECT_DOUBLE_EQ(program.targets[0].X_FT.p.z(), 0.1);
}

TEST(Krl, names_what_it_leaves) {
  expect_left(read_krl("LIN " + std::string(kPos), {}), 1, "--tool");
  expect_left(read_krl("LIN XP1", flange()), 1, "declared elsewhere");
  expect_left(read_krl("LIN {X 5}", flange()), 1, "all of X to C");
  expect_left(read_krl("LIN_REL {X 5}", flange()), 1, "relative");
  const Program shifted = read_krl("XP1=" + std::string(kPos) + "\nLIN XP1:XP2", flange());
  EXPECT_TRUE(is_left(shifted, 1, "no motion here goes to it"));
  EXPECT_TRUE(is_left(shifted, 2, "computed"));
  expect_left(read_krl("$TOOL=TOOL_DATA[4]\nLIN " + std::string(kPos), {}), 2, "--tool 4=");
}

TEST(Krl, leaves_a_point_that_is_written_twice) {
  const std::string point = "XP1=" + std::string(kPos) + "\n";
  const Program program = read_krl(point + point, flange());
  EXPECT_TRUE(is_left(program, 1, "several values"));
  EXPECT_TRUE(is_left(program, 2, "several values"));
  EXPECT_TRUE(program.targets.empty());
}

TEST(Krl, takes_both_poses_of_an_arc) {
  const Program program =
      read_krl("CIRC " + std::string(kPos) + ", " + kPos + ", CA 90 C_DIS", flange());
  EXPECT_EQ(program.targets.size(), 2U);
}

constexpr const char* kFanucPositions =
    "/POS\nP[1]{\n   GP1:\n\tUF : 0, UT : 3,\t\tCONFIG : 'N U T, 0, 0, 0',\n\tX =   100.5  mm,\tY "
    "= "
    "2 mm,\tZ = 3 mm,\n\tW = 10 deg,\tP = 20 deg,\tR = 30 deg\n};\nP[2]{\n   GP1:\n\tUF : 0, UT : "
    "3,\n\tJ1= 1 deg,\tJ2= 2 deg,\tJ3= 3 deg,\n\tJ4= 4 deg,\tJ5= 5 deg,\tJ6= 6 "
    "deg\n};\n/END\n";

ProgramFrames tool_3() {
  ProgramFrames frames;
  EXPECT_TRUE(frames.tools.add("--tool", "3=0,0,100,0,0,0"));
  return frames;
}

TEST(Fanuc, takes_positions_in_the_order_of_the_motions) {
  const Program program =
      read_fanuc("/MN\n 1:J P[2] 50% FINE ;\n 2:L P[1:\"weld\"] 100mm/sec FINE ;\n" +
                     std::string(kFanucPositions),
                 tool_3());
  EXPECT_TRUE(program.left.empty());
  ASSERT_EQ(program.targets.size(), 2U);
  EXPECT_TRUE(program.targets[0].joints);
  EXPECT_EQ(program.targets[1].name, "P[1]");
  EXPECT_DOUBLE_EQ(program.targets[1].values[0], 100.5);
  EXPECT_DOUBLE_EQ(program.targets[1].X_FT.p.z(), 0.1);
}

TEST(Fanuc, names_what_it_leaves) {
  const std::string both = " 9:J P[1] 5% FINE ;\n 9:J P[2] 5% FINE ;\n";
  const std::string positions(kFanucPositions);
  expect_left(read_fanuc("/MN\n" + both + positions, {}), 5, "user tool");
  expect_left(read_fanuc("/MN\n" + both + " 1:L PR[4] 5mm/sec FINE ;\n" + positions, tool_3()), 4,
              "register");
  expect_left(read_fanuc("/MN\n" + both + " 1:L P[9] 5mm/sec FINE ;\n" + positions, tool_3()), 4,
              "not in /POS");
  expect_left(
      read_fanuc("/MN\n" + both + " 1:L P[1] 5mm/sec FINE Offset,PR[1] ;\n" + positions, tool_3()),
      4, "offset");
}

TEST(Jbi, takes_positions_with_their_tool_and_user_frame) {
  ProgramFrames frames = tool_3();
  EXPECT_TRUE(frames.frames.add("--frame", "2=10,0,0,0,0,0"));
  const Program program = read_jbi(
      "/JOB\n//POS\n///USER 2\n///TOOL 3\n///POSTYPE USER\n///RECTAN\n///RCONF 1,0,0,0,0,0\n"
      "C00000=1.5,2,3,4,5,6\n///POSTYPE BASE\nC00001=7,2,3,4,5,6\n//INST\nMOVJ C00000 VJ=1\n",
      frames);
  EXPECT_TRUE(program.left.empty());
  ASSERT_EQ(program.targets.size(), 2U);
  EXPECT_DOUBLE_EQ(program.targets[0].X_BW.p.x(), 0.01);
  EXPECT_DOUBLE_EQ(program.targets[1].X_BW.p.x(), 0);
}

TEST(Jbi, names_what_it_leaves) {
  expect_left(read_jbi("///POSTYPE PULSE\n///PULSE\nC00000=1,2,3,4,5,6", flange()), 3, "pulses");
  expect_left(read_jbi("///TOOL 5\n///POSTYPE BASE\nC00000=1,2,3,4,5,6", {}), 3, "--tool 5=");
  expect_left(read_jbi("///POSTYPE USER\n///USER 4\nC00000=1,2,3,4,5,6", tool_3()), 3, "tool 0");
  expect_left(read_jbi("///POSTYPE BASE\nC00000=1,2,3", flange()), 2, "six numbers");
}

TEST(Gcode, takes_straight_moves_with_all_axes) {
  const std::string text =
      "N10 G21 G90 (X1 Y2 Z3 A4 B5 C6)\nG1X1.5Y-2 Z3 A4 B5 C6 F100\nX2 Y2 Z3 A4 B5 C6\n";
  const Program program = read_gcode(text, flange());
  EXPECT_TRUE(program.left.empty());
  ASSERT_EQ(program.targets.size(), 2U);
  EXPECT_DOUBLE_EQ(program.targets[0].values[1], -2);
  EXPECT_EQ(program.targets[1].line, 3);
}

TEST(Gcode, names_what_it_leaves) {
  const std::string all = " X1 Y2 Z3 A4 B5 C6";
  expect_left(read_gcode("G1 X1 Y2", flange()), 1, "not all of");
  expect_left(read_gcode("G2" + all + " I1 J0", flange()), 1, "no straight move");
  expect_left(read_gcode("G91 G1" + all, flange()), 1, "G91");
  expect_left(read_gcode("G20\nG1" + all, flange()), 2, "inches");
  expect_left(read_gcode("G1 X#1 Y2 Z3 A4 B5 C6", flange()), 1, "computed");
  expect_left(read_gcode("G1 X[1+2] Y2 Z3 A4 B5 C6", flange()), 1, "computed");
  expect_left(read_gcode("G92" + all, flange()), 1, "other coordinates");
  expect_left(read_gcode("G1" + all, {}), 1, "--tool");
}

TEST(Languages, are_known_by_the_suffix) {
  EXPECT_EQ(language_of("a.b/weld.SRC")->name, "krl");
  EXPECT_EQ(language_of("x.mod")->name, "rapid");
  EXPECT_EQ(language_of("x.script")->name, "urscript");
  EXPECT_EQ(language_of("x.ls")->name, "fanuc");
  EXPECT_EQ(language_of("x.JBI")->name, "jbi");
  EXPECT_EQ(language_of("x.txt"), nullptr);
  EXPECT_EQ(language_of("x."), nullptr);
}

}  // namespace
}  // namespace armsig::tool
