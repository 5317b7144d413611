// SPDX-License-Identifier: MIT
// KRL as cells have it: tools and bases of one motion, points that are computed, status as bits.
#include "host_tests/unit_tool/reading_programs.hpp"

namespace armsig::tool {
namespace {

const std::string kPoint = "{X 500,Y 20,Z 600,A 10,B 80,C 5,S 2,T 10}";

TEST(KrlCells, leave_a_point_that_the_program_computes) {
  const std::string point = "P_UP=" + kPoint + "\n";
  const Program component = read_krl(point + "P_UP.Z=P_UP.Z+50\nLIN P_UP\n", flange());
  EXPECT_TRUE(component.targets.empty());
  EXPECT_TRUE(is_left(component, 3, "in line 2"));
  expect_none(read_krl("P_UP=P_DOWN\nLIN P_UP\n", flange()), 2, "a computed one, in line 1");
}

TEST(KrlCells, name_a_point_that_no_motion_goes_to) {
  const Program program = read_krl("P_REST=" + kPoint + "\nLIN " + kPoint + "\n", flange());
  EXPECT_EQ(program.targets.size(), 1U);
  expect_left(program, 1, "P_REST: no motion here goes to it");
}

TEST(KrlCells, take_elements_of_an_array_by_their_number) {
  const std::string points = "P[1]=" + kPoint + "\nP[2]=" + kPoint + "\n";
  EXPECT_EQ(read_krl(points + "PTP P[2]\nLIN P[1]\n", flange()).targets.size(), 2U);
  const Program counted = read_krl(points + "LIN P[I]\n", flange());
  EXPECT_TRUE(counted.targets.empty());
  EXPECT_TRUE(is_left(counted, 3, "computed"));
}

TEST(KrlCells, take_tool_and_base_of_one_motion) {
  ProgramFrames frames = flange();
  EXPECT_TRUE(frames.tools.add("--tool", "4=0,0,80,0,0,0"));
  const Program program = read_krl("SLIN " + kPoint +
                                       " WITH $VEL=SVEL_CP(0.5, , L1), $TOOL=TOOL_DATA[4], "
                                       "$BASE={X 30,Y 0,Z 0,A 0,B 0,C 0}\nSLIN " +
                                       kPoint + " C_SPL\n",
                                   frames);
  ASSERT_EQ(program.targets.size(), 2U);
  EXPECT_DOUBLE_EQ(program.targets[0].X_FT.p.z(), 0.08);
  EXPECT_DOUBLE_EQ(program.targets[0].X_BW.p.x(), 0.03);
  EXPECT_DOUBLE_EQ(program.targets[1].X_FT.p.z(), 0);
}

TEST(KrlCells, take_tool_and_base_of_a_spline_to_its_end) {
  ProgramFrames frames = flange();
  EXPECT_TRUE(frames.tools.add("--tool", "4=0,0,80,0,0,0"));
  const Program program = read_krl(
      "SPLINE WITH $TOOL=TOOL_DATA[4]\nSPL " + kPoint + "\nENDSPLINE\nLIN " + kPoint + "\n",
      frames);
  ASSERT_EQ(program.targets.size(), 2U);
  EXPECT_DOUBLE_EQ(program.targets[0].X_FT.p.z(), 0.08);
  EXPECT_DOUBLE_EQ(program.targets[1].X_FT.p.z(), 0);
}

TEST(KrlCells, leave_targets_of_a_frame_that_is_computed) {
  for (const char* set : {"$BASE.Z=$BASE.Z+20", "$BASE=BASE_DATA[1]:SHIFT", "$BASE=BASE_DATA[N]",
                          "$TOOL.X=3", "$TOOL={X 0,Y 0,Z 9,A 0,B 0,C 0}:TIP"}) {
    expect_none(read_krl(std::string(set) + "\nLIN " + kPoint + "\n", flange()), 2, "is computed");
  }
  expect_none(
      read_krl("BASE_DATA[2].Z=BASE_DATA[2].Z+9\n$BASE=BASE_DATA[2]\nLIN " + kPoint, flange()), 3,
      "BASE_DATA[2] is changed in line 1");
}

TEST(KrlCells, leave_targets_where_the_robot_holds_the_work_piece) {
  expect_none(read_krl("$IPO_MODE=#TCP\nLIN " + kPoint, flange()), 2, "#TCP");
  expect_none(read_krl("XP1=" + kPoint + "\nFP1={TOOL_NO 1,BASE_NO 1,IPO_FRAME #TCP}\n", flange()),
              1, "#TCP");
}

TEST(KrlCells, take_status_and_turn_as_bits) {
  const Program program =
      read_krl("PTP {X 5,Y 2,Z 6,A 1,B 8,C 5,S 'B 110',T 'B110010'}\n", flange());
  const Program hexadecimal = read_krl("PTP {X 5,Y 2,Z 6,A 1,B 8,C 5,S 6,T 'H1A'}\n", flange());
  ASSERT_EQ(program.targets.size(), 1U);
  EXPECT_EQ(program.targets[0].configuration, (std::vector<long>{6, 50}));
  EXPECT_EQ(hexadecimal.targets.at(0).configuration, (std::vector<long>{6, 26}));
}

TEST(KrlCells, take_no_frame_of_a_dat_for_a_point) {
  expect_none(read_krl("DECL FRAME SHELF={X 5,Y 2,Z 6,A 1,B 8,C 5}\n", flange()), 1,
              "may be no target");
  EXPECT_TRUE(read_krl("LOAD_DATA[1]={M 2,CM {X 5,Y 2,Z 6,A 1,B 8,C 5},J {X 0,Y 0,Z 0}}\n"
                       "BASE_DATA[3]={X 5,Y 2,Z 6,A 1,B 8,C 5}\n",
                       flange())
                  .left.empty());
}

TEST(KrlCells, say_that_a_motion_to_where_the_arm_stands_needs_nothing) {
  expect_none(read_krl("PTP $AXIS_ACT\n", flange()), 1, "where the arm stands");
}

}  // namespace
}  // namespace armsig::tool
