// SPDX-License-Identifier: MIT
// RAPID as cells have it: names of routines, arrays, values that change while the program runs.
#include "host_tests/unit_tool/reading_programs.hpp"

namespace armsig::tool {
namespace {

const std::string kPlace = "[[300,20,400],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]";
const std::string kOther = "[[310,30,410],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]";

TEST(RapidCells, keep_a_target_apart_from_a_parameter_of_its_name) {
  const Program program = read_rapid("MODULE m\nPERS robtarget pLid:=" + kPlace +
                                         ";\nPROC lift(robtarget pLid)\nMoveL pLid,v50,fine,tool0;"
                                         "\nENDPROC\nPROC main()\nMoveL pLid,v50,fine,tool0;\n"
                                         "ENDPROC\nENDMODULE\n",
                                     {});
  ASSERT_EQ(program.targets.size(), 1U);
  EXPECT_EQ(program.targets[0].line, 2);
  expect_left(program, 4, "computed");
}

TEST(RapidCells, take_targets_that_a_routine_with_parameters_declares) {
  const Program program = read_rapid("PROC go(robtarget a,num n)\nVAR robtarget pTop:=" + kPlace +
                                         ";\nMoveJ pTop,v50,fine,tool0;\nENDPROC\n",
                                     {});
  EXPECT_TRUE(program.left.empty());
  EXPECT_EQ(program.targets.size(), 1U);
}

TEST(RapidCells, keep_targets_of_one_name_in_two_routines_apart) {
  const std::string routine = "()\nVAR robtarget pIn:=";
  const Program program =
      read_rapid("PROC a" + routine + kPlace + ";\nMoveL pIn,v50,fine,tool0;\nENDPROC\nPROC b" +
                     routine + kOther + ";\nMoveL pIn,v50,fine,tool0;\nENDPROC\n",
                 {});
  EXPECT_TRUE(program.left.empty());
  ASSERT_EQ(program.targets.size(), 2U);
  EXPECT_DOUBLE_EQ(program.targets[1].values[0], 310);
}

TEST(RapidCells, take_every_element_of_an_array) {
  const Program program =
      read_rapid("CONST robtarget pNest{2}:=[" + kPlace + ",\n" + kOther +
                     "];\nFOR i FROM 1 TO 2 DO\nMoveL pNest{i},v50,fine,tool0;\nENDFOR\n",
                 {});
  EXPECT_TRUE(program.left.empty());
  ASSERT_EQ(program.targets.size(), 2U);
  EXPECT_EQ(program.targets[0].name, "pNest{1}");
  EXPECT_EQ(program.targets[1].line, 2);
}

TEST(RapidCells, name_an_array_that_only_procedures_get) {
  expect_none(read_rapid("CONST robtarget pNest{1}:=[" + kPlace + "];\nrPick pNest{1};\n", {}), 1,
              "no instruction");
}

TEST(RapidCells, leave_a_target_that_the_program_changes) {
  const std::string declared = "PERS robtarget pFind:=" + kPlace + ";\n";
  const std::string move = "MoveL pFind,v50,fine,tool0;\n";
  for (const char* change :
       {"pFind:=CRobT();\n", "pFind.trans.z:=5;\n", "IF a=1 pFind.rot:=OrientZYX(1,0,0);\n"}) {
    expect_none(read_rapid(declared + change + move, {}), 1, "line 2 gives it another value");
  }
  EXPECT_TRUE(read_rapid(declared + "pFind.extax.eax_a:=5;\n" + move, {}).left.empty());
}

TEST(RapidCells, say_of_an_offset_whose_correction_it_moves_with) {
  const std::string declared = "CONST robtarget pTop:=" + kPlace + ";\n";
  const std::string offset = "MoveL Offs(pTop,0,0,9),v50,fine,tool0;\n";
  const Program both = read_rapid(declared + offset + "MoveL pTop,v50,fine,tool0;\n", {});
  EXPECT_EQ(both.targets.size(), 1U);
  expect_left(both, 2, "Offs(pTop,0,0,9): it moves with the correction of pTop");
  EXPECT_TRUE(both.left.front().remark);

  const Program alone = read_rapid(declared + offset, {});
  EXPECT_TRUE(is_left(alone, 1, "pTop: no instruction here goes to it"));
  EXPECT_TRUE(is_left(alone, 2, "Offs(pTop,0,0,9): it is computed"));
}

TEST(RapidCells, name_what_is_computed_in_full) {
  expect_none(read_rapid("MoveL Offs(CRobT(\\Tool:=tool0),0,0,9),v50,fine,tool0;\n", {}), 1,
              "Offs(CRobT(\\Tool:=tool0),0,0,9): it is computed");
  expect_none(read_rapid("MoveJ half_way(pA,pB),v50,fine,tool0;\n", {}), 1,
              "half_way(pA,pB): it is computed");
  expect_none(read_rapid("MoveJ pA,v50,fine,tool0;\n", {}), 1, "pA: it is not declared here");
}

TEST(RapidCells, name_a_target_that_is_assigned) {
  const Program program =
      read_rapid("VAR robtarget pNext;\npNext:=" + kPlace + ";\nMoveL pNext,v50,fine,tool0;\n", {});
  EXPECT_TRUE(program.targets.empty());
  EXPECT_TRUE(is_left(program, 2, "no instruction"));
  EXPECT_TRUE(is_left(program, 3, "computed"));
}

TEST(RapidCells, leave_targets_of_frames_that_the_program_changes) {
  const std::string frames =
      "PERS tooldata tCup:=[TRUE,[[0,0,90],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];\n"
      "PERS wobjdata wBox:=[FALSE,TRUE,\"\",[[9,0,0],[1,0,0,0]],[[5,0,0],[1,0,0,0]]];\n";
  const std::string move = "MoveL " + kPlace + ",v50,fine,tCup\\WObj:=wBox;\n";
  expect_none(read_rapid(frames + "tCup.tframe.trans.z:=95;\n" + move, {}), 4,
              "TCUP is changed in line 3");
  expect_none(read_rapid(frames + "wBox.oframe:=[[1,2,3],[1,0,0,0]];\n" + move, {}), 4,
              "WBOX is changed in line 3");
  EXPECT_EQ(read_rapid(frames + "tCup.tload.mass:=2;\n" + move, {}).targets.size(), 1U);
}

TEST(RapidCells, find_the_tool_before_a_signal) {
  for (const char* behind : {"\\WObj:=wobj0,doClamp,1", ",aoFlow,3", ",\"rSpray\""}) {
    const std::string instruction = behind[1] == 'a'   ? "MoveLAO "
                                    : behind[1] == '"' ? "MoveJSync "
                                                       : "MoveLDO ";
    const Program program =
        read_rapid(instruction + kPlace + ",v50,fine,tool0" + behind + ";\n", {});
    EXPECT_TRUE(program.left.empty()) << behind;
    EXPECT_EQ(program.targets.size(), 1U) << behind;
  }
}

TEST(RapidCells, take_the_nearest_configuration_where_the_program_says_so) {
  const std::string move = "MoveJ " + kPlace + ",v50,fine,tool0;\n";
  EXPECT_FALSE(read_rapid("ConfJ \\On;\n" + move, {}).targets.at(0).linear);
  EXPECT_TRUE(read_rapid("ConfJ\\Off;\n" + move, {}).targets.at(0).linear);
}

TEST(RapidCells, say_where_targets_are_displaced) {
  const Program program = read_rapid("PDispSet shift;\nMoveL " + kPlace + ",v50,fine,tool0;\n", {});
  EXPECT_EQ(program.targets.size(), 1U);
  expect_left(program, 1, "moves targets");
}

}  // namespace
}  // namespace armsig::tool
