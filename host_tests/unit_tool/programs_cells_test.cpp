// SPDX-License-Identifier: MIT
// FANUC, INFORM, URScript and G-code as cells have them: what goes by a target, and what changes
// it.
#include "host_tests/unit_tool/reading_programs.hpp"

namespace armsig::tool {
namespace {

std::string position(int number) {
  return "P[" + std::to_string(number) +
         "]{\n GP1:\n UF : 0, UT : 0,\n X = 400 mm, Y = 5 mm, Z = 300 mm,\n W = 180 deg, P = 0 "
         "deg, R = 0 deg\n};\n";
}

Program fanuc(const std::string& lines, const std::string& positions) {
  return read_fanuc("/MN\n" + lines + "/POS\n" + positions + "/END\n", flange());
}

TEST(FanucCells, leave_a_position_that_a_motion_goes_by) {
  expect_none(fanuc(" 1:L P[1] 50mm/sec FINE INC ;\n", position(1)), 4, "INC");
}

TEST(FanucCells, name_an_offset_once_and_correct_its_position) {
  const Program program = fanuc(" 1:L P[1] 50mm/sec FINE Tool_Offset,PR[3] ;\n", position(1));
  EXPECT_EQ(program.targets.size(), 1U);
  expect_left(program, 2, "an offset moves it");
  EXPECT_TRUE(program.left.front().remark);  // its position is corrected
}

TEST(FanucCells, read_no_words_in_names_of_positions) {
  const Program program = fanuc(" 1:J P[1:INC OFFSET] 5% FINE ;\n", position(1));
  EXPECT_EQ(program.targets.size(), 1U);
  EXPECT_TRUE(program.left.empty());
}

TEST(FanucCells, take_a_motion_behind_a_condition_with_a_negation) {
  const Program program =
      fanuc(" 1:  IF (!DI[3]) THEN ;\n 2:J P[1] 5% FINE ;\n 3:  ENDIF ;\n", position(1));
  EXPECT_EQ(program.targets.size(), 1U);
}

TEST(FanucCells, leave_positions_that_only_a_register_or_a_remark_has) {
  expect_none(fanuc(" 1:  PR[4]=P[1]    ;\n", position(1)), 4, "no motion");
  expect_none(fanuc(" 1:  //J P[1] 5% FINE ;\n", position(1)), 4, "no motion");
}

TEST(FanucCells, take_both_positions_of_an_arc) {
  const Program program = fanuc(
      " 1:C P[1] \n  :  P[2] 50mm/sec FINE ;\n 2:C P[1] \n  :  PR[7] "
      "50mm/sec FINE ;\n",
      position(1) + position(2));
  EXPECT_EQ(program.targets.size(), 2U);
  expect_left(program, 5, "PR[7]");
}

TEST(FanucCells, name_registers_as_the_program_has_them) {
  expect_left(fanuc(" 1:L PR[R[98]] 9mm/sec FINE ;\n", ""), 2, "PR[R[98]]: it is a register");
  expect_left(fanuc(" 1:L PR[4:Pick up] 9mm/sec FINE ;\n", ""), 2, "PR[4]: it is a register");
  const Program program = fanuc(" 1:J P[R[3]] 5% FINE ;\n", position(1));
  EXPECT_TRUE(is_left(program, 2, "P[R[3]]: a register says which position it is"));
  EXPECT_TRUE(is_left(program, 4, "P[1]: no motion here goes to it"));
}

TEST(FanucCells, leave_positions_whose_frame_the_program_sets) {
  std::string in_frame = position(1);
  in_frame.replace(in_frame.find("UF : 0"), 6, "UF : 4");
  const std::string motion = " 2:L P[1] 9mm/sec FINE ;\n";
  const std::string sets = " 1:  UFRAME[4:Cart]=PR[R[9]] ;\n";
  expect_none(fanuc(sets + motion, in_frame), 5, "user frame 4 is changed in line 2");
  expect_none(fanuc(" 1:  UFRAME[R[2]]=PR[9] ;\n" + motion, in_frame), 5, "changed in line 2");
  expect_none(fanuc(" 1:  UFRAME[R[2]]=PR[9] ;\n 1:  UTOOL[2]=PR[9] ;\n" + motion, in_frame), 6,
              "changed in line 2");
  EXPECT_EQ(fanuc(" 1:  UFRAME[5]=PR[9] ;\n" + motion, in_frame).targets.size(), 1U);
  EXPECT_EQ(fanuc(sets + motion, position(1)).targets.size(), 1U);  // the world stays
}

constexpr const char* kVariable =
    "///TOOL 0\n///POSTYPE ROBOT\n///RECTAN\nP00007=400,5,300,180,0,0\n";

TEST(JbiCells, take_a_position_variable_that_a_motion_goes_to) {
  const Program program =
      read_jbi(std::string(kVariable) + "//INST\nNOP\nMOVL P007 V=50\n", flange());
  EXPECT_TRUE(program.left.empty());
  EXPECT_EQ(program.targets.size(), 1U);
}

TEST(JbiCells, leave_a_position_variable_that_is_no_place) {
  const std::string job = std::string(kVariable) + "//INST\nNOP\n";
  expect_none(read_jbi(job + "IMOV P007 V=50 RF\n", flange()), 4, "IMOV");
  expect_none(read_jbi(job + "ADD P003 P007\n", flange()), 4, "no motion");
  expect_none(read_jbi(job + "MOVL P007 V=5\nSUB P007 P003\n", flange()), 4, "line 8");
  expect_none(read_jbi(job + "'MOVL P007 V=5\n", flange()), 4, "no motion");
}

TEST(JbiCells, leave_positions_of_another_group) {
  const std::string steps =
      "///TOOL 0\n///POSTYPE ROBOT\n///RECTAN\nC00000=400,5,300,180,0,0\n"
      "C00001=300,5,300,180,0,0\n//INST\n///GROUP1 RB1\n///GROUP2 RB2\nNOP\n";
  for (const char* both :
       {"MOVL C000 V=50 +MOVL C001 V=50\n", "MOVJ C00000 VJ=5\n +MOVJ C00001\n"}) {
    const Program program = read_jbi(steps + both, flange());
    ASSERT_EQ(program.targets.size(), 1U) << both;
    EXPECT_EQ(program.targets[0].name, "C00000");
    expect_left(program, 5, "another group of the job moves to it");
  }
  expect_none(
      read_jbi(std::string(kVariable) + "//INST\nNOP\nMOVL P001 V=5 +MOVL P007 V=5\n", flange()), 4,
      "another group");
}

TEST(JbiCells, say_that_a_type_of_position_is_missing) {
  expect_none(read_jbi("C00000=1,2,3,4,5,6\n//INST\nMOVJ C00000\n", {}), 1, "POSTYPE");
}

TEST(JbiCells, say_where_a_shift_moves_targets) {
  EXPECT_TRUE(is_left(
      read_jbi(std::string(kVariable) + "//INST\nNOP\nSFTON P001 RF\nMOVL P007 V=5\n", flange()), 7,
      "SFTON"));
}

TEST(UrCells, take_a_pose_of_the_inverse_kinematics_near_readings) {
  const Program program = read_urscript(
      "W_p=p[0.3,0.1,0.4,0,3,0]\nW_q=[0.1,-1,1,-1,-1,0]\n"
      "movej(get_inverse_kin(W_p, qnear=W_q), a=1)\nmovej(get_inverse_kin(p[0.3,0,0.4,0,3,0]))\n",
      flange());
  EXPECT_TRUE(program.left.empty());
  ASSERT_EQ(program.targets.size(), 2U);
  EXPECT_FALSE(program.targets[0].joints);
  EXPECT_EQ(program.targets[0].line, 1);
}

TEST(UrCells, take_targets_by_the_names_of_their_parameters) {
  const Program program =
      read_urscript("movej(q=[0,-1,1,-1,-1,0], a=1)\nmovel(pose = p[0.3,0,0.4,0,3,0])\n", flange());
  EXPECT_TRUE(program.left.empty());
  EXPECT_EQ(program.targets.size(), 2U);
}

TEST(UrCells, keep_a_variable_apart_from_a_parameter_of_its_name) {
  const Program program = read_urscript(
      "def go(spot):\n  movel(spot)\nend\nspot=p[0.3,0,0.4,0,3,0]\ngo(spot)\n", flange());
  EXPECT_TRUE(program.targets.empty());
  EXPECT_TRUE(is_left(program, 2, "computed"));
  EXPECT_TRUE(is_left(program, 4, "spot: no move here goes to it"));
}

TEST(UrCells, name_poses_that_no_move_goes_to) {
  expect_none(read_urscript("go(p[0.3,0,0.4,0,3,0])\n", flange()), 1, "target: no move");
  EXPECT_TRUE(read_urscript("force_mode(p[0,0,0,0,0,0], 1)\n", flange()).left.empty());
}

TEST(UrCells, take_the_tool_of_a_variable) {
  const Program program =
      read_urscript("grip=p[0,0,0.2,0,0,0]\nset_tcp(grip)\nmovel(p[0.3,0,0.4,0,3,0])\n", {});
  ASSERT_EQ(program.targets.size(), 1U);
  EXPECT_DOUBLE_EQ(program.targets[0].X_FT.p.z(), 0.2);
}

const std::string kAxes = " X400 Y5 Z300 A180 B0 C0";

TEST(GcodeCells, take_a_move_whose_speed_is_computed) {
  EXPECT_EQ(read_gcode("G1" + kAxes + " F#<speed>\n", flange()).targets.size(), 1U);
  EXPECT_EQ(read_gcode("G1 F[#2 * 3]" + kAxes + "\n", flange()).targets.size(), 1U);
  EXPECT_EQ(read_gcode("F#2 G1" + kAxes + "\n", flange()).targets.size(), 1U);
}

TEST(GcodeCells, leave_moves_behind_a_moved_origin) {
  const std::string move = "G1" + kAxes + "\n";
  for (const char* moves : {"G92 Z5\n", "G10 L2 P1 X5\n", "G52 X1\n"}) {
    const Program program = read_gcode(moves + move, flange());
    EXPECT_TRUE(program.targets.empty()) << moves;
    EXPECT_TRUE(is_left(program, 2, "line 1 moves the origin"));
  }
  EXPECT_EQ(read_gcode("G92 Z5\nG92.1\n" + move, flange()).targets.size(), 1U);
  EXPECT_EQ(read_gcode("G10 L1 P1 Z5\n" + move, flange()).targets.size(), 1U);
}

TEST(GcodeCells, leave_what_is_no_straight_move) {
  for (const char* code : {"G5", "G5.1", "G33", "G38.5", "G76"}) {
    expect_none(read_gcode("G1 F9\n" + (code + kAxes), flange()), 2, "no straight move");
  }
}

TEST(GcodeCells, leave_moves_of_other_kinematics) {
  const Program program = read_gcode("M429\nG1" + kAxes + "\nM428\nG1" + kAxes + "\n", flange());
  EXPECT_EQ(program.targets.size(), 1U);
  expect_left(program, 2, "kinematics");
}

TEST(GcodeCells, take_the_frame_of_their_coordinate_system) {
  ProgramFrames frames = flange();
  EXPECT_TRUE(frames.frames.add("--frame", "G55=70,0,0,0,0,0"));
  const Program program = read_gcode("G1" + kAxes + "\nG55 G1" + kAxes + "\n", frames);
  ASSERT_EQ(program.targets.size(), 2U);
  EXPECT_DOUBLE_EQ(program.targets[0].X_BW.p.x(), 0);
  EXPECT_DOUBLE_EQ(program.targets[1].X_BW.p.x(), 0.07);
}

}  // namespace
}  // namespace armsig::tool
