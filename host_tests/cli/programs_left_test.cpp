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
