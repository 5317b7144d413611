// SPDX-License-Identifier: MIT
// `compensate --into`: every byte but numbers of targets stays, and what is left is said.
#include <algorithm>
#include <cctype>

#include "host_tests/cli/run_tool.hpp"

namespace armsig::cli {
namespace {

constexpr const char* kCompensate = "compensate --signature t.yaml --tool 0,0,0,0,0,0 ";

void simulate_irb120(const Folder& folder) {
  const Outcome simulated = run_tool(
      folder, "simulate --arm irb120 --tolerances 1 --points 4 --out m.csv --truth-out t.yaml");
  ASSERT_EQ(simulated.status, 0) << simulated.err;
}

std::string without_numbers(const std::string& text) {
  std::string rest;
  std::ranges::copy_if(text, std::back_inserter(rest), [](unsigned char c) {
    return std::isdigit(c) == 0 && c != '.' && c != '-';
  });
  return rest;
}

TEST(ProgramsLeft, keep_marks_line_ends_and_letters_of_other_encodings) {
  const Folder folder;
  simulate_irb120(folder);
  const std::string program =
      "\xEF\xBB\xBFMODULE m\r\n\t! Gr\xFC\xDF"
      "e, MoveAbsJ [[1,2,3,4,5,6]]\r\n"
      "\tMoveAbsJ [[10,20,-10,5,40,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v50,fine,tool0;\r\n"
      "\tTPWrite \"MoveAbsJ [[1,1,1,1,1,1],[9E9,9E9,9E9,9E9,9E9,9E9]]\";\r\nENDMODULE";
  write_file(folder / "p.mod", program);
  const Outcome outcome = run_tool(folder, std::string(kCompensate) + "--into p.mod --out q.mod");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(outcome.err.empty()) << outcome.err;
  const std::string corrected = read_file(folder / "q.mod");
  EXPECT_NE(corrected, program);
  EXPECT_EQ(without_numbers(corrected), without_numbers(program));
}

TEST(ProgramsLeft, of_one_reason_are_said_in_runs_of_lines) {
  const Folder folder;
  simulate_irb120(folder);
  write_file(folder / "p.ngc", "G90 G21\nG0 X1\nG0 Y2\nG1 Z3 F9\nG91\nG0 X1\n");
  const std::string command =
      std::string(kCompensate) + "--frame 0,0,0,0,0,0 --into p.ngc --out q.ngc";
  const Outcome outcome = run_tool(folder, command);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("lines 2 to 4: move: it has not all of"), std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("line 6: move: it is relative"), std::string::npos) << outcome.err;
}

TEST(ProgramsLeft, of_one_reason_are_said_at_once_whatever_their_names) {
  const Folder folder;
  simulate_irb120(folder);
  std::string declared, moves;
  for (int k = 1; k <= 14; ++k) {
    const std::string name = "p" + std::to_string(k);
    declared += "CONST robtarget " + name +
                ":=[[9000,0,0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n" +
                (k % 2 == 0 ? "\n" : "");
    moves += "MoveJ " + name + ",v50,fine,tool0;\n";
  }
  write_file(folder / "p.mod", declared + moves);
  const std::string command = std::string(kCompensate) + "--into p.mod --out q.mod";
  EXPECT_EQ(run_tool(folder, command).err,
            "armsig: warning: p.mod: lines 1 to 2, 4 to 5, 7 to 8, 10 to 11, 13 to 14, 16 to 17, "
            "19 to 20: p1 to p14: the nominal model does not reach it; left as they are\n"
            "armsig: p.mod: none of its targets can be corrected; expected a program with targets "
            "that both models reach\n");
}

TEST(ProgramsLeft, are_apart_from_remarks_on_corrected_targets) {
  const Folder folder;
  simulate_irb120(folder);
  const std::string position =
      "{\n GP1:\n UF : 0, UT : 1,\n J1= 10 deg, J2= 20 deg, J3= -10 deg,\n J4= 5 deg, J5= 40 deg, "
      "J6= 0 deg,\n E1= ";
  write_file(folder / "p.ls",
             "/MN\n 1:J P[1] 5% FINE Offset,PR[1] ;\n 2:J P[2] 5% FINE ;\n/POS\nP[1]" + position +
                 "0.000 mm\n};\nP[2]" + position + "70.000 mm\n};\n/END\n");
  const std::string command = std::string(kCompensate) + "--into p.ls --out q.ls";
  const Outcome outcome = run_tool(folder, command);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err,
            "armsig: warning: p.ls: line 2: P[1]: an offset moves it, with its correction\n"
            "armsig: warning: p.ls: line 12: P[2]: external axis 1 moves; targets are corrected as "
            "if it did not move the arm's base\n");
  EXPECT_NE(outcome.out.find("2 targets corrected"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("left uncorrected"), std::string::npos) << outcome.out;
  const Outcome json = run_tool(folder, command + " --json");
  EXPECT_NE(json.out.find("\"left\": []"), std::string::npos) << json.out;
}

TEST(ProgramsLeft, say_that_a_program_has_no_targets) {
  const Folder folder;
  simulate_irb120(folder);
  write_file(folder / "p.script", "textmsg(\"no move\")\n");
  const Outcome outcome =
      run_tool(folder, std::string(kCompensate) + "--into p.script --out q.script");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("no target is written in it"), std::string::npos) << outcome.err;
}

TEST(ProgramsLeft, take_the_inverse_kinematics_near_the_readings_that_the_program_names) {
  const Folder folder;
  ASSERT_EQ(run_tool(folder,
                     "simulate --arm ur5e --tolerances 1 --points 4 --out m.csv "
                     "--truth-out t.yaml")
                .status,
            0);
  write_file(
      folder / "p.script",
      "movej(get_inverse_kin(p[0.4,-0.3,0.3,0,3,0.2], qnear=[-0.6,-1.6,1.9,-1.8,-1.5,0]))\n");
  const Outcome outcome =
      run_tool(folder, std::string(kCompensate) + "--into p.script --out q.script --check --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("\"corrected\": 1"), std::string::npos) << outcome.out;
  EXPECT_NE(read_file(folder / "q.script").find("qnear=[-0.6,-1.6,1.9,-1.8,-1.5,0]"),
            std::string::npos);
}

}  // namespace
}  // namespace armsig::cli
