// SPDX-License-Identifier: MIT
// Taught frames in a file: `armsig frames --out`, and `armsig compensate --frames` that takes it.
#include "firmware/formats/frames_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host_tests/cli/run_tool.hpp"

namespace armsig::cli {
namespace {

using tool::FramesFile;
using tool::NamedPose;

constexpr const char* kTaught =
    "frames --signature s.yaml --points " ARMSIG_EXAMPLES "/taught.csv --out frames.yaml";
constexpr const char* kInto =
    "compensate --signature s.yaml --seed q.csv --into p.mod --out c.mod ";

// The arm of the examples, and a program by the names of its tool and table.
class FramesInAFile : public testing::Test {
 protected:
  Folder folder_;

  void SetUp() override {
    const Outcome identified =
        run_tool(folder_, "identify --arm " ARMSIG_EXAMPLES
                          "/arm.yaml --measurements " ARMSIG_EXAMPLES "/sweeps.csv --out s.yaml");
    ASSERT_EQ(identified.status, 0) << identified.err;
    write_file(folder_ / "q.csv",
               "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n"
               "-15.368,-66.3287,101.987,0.1084,54.1516,-195.2181\n");
    write_file(folder_ / "p.mod",
               "MoveL [[40,30,20],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v50,fine,"
               "torch\\WObj:=table;\n");
  }
  void teach() {
    const Outcome taught = run_tool(folder_, kTaught);
    ASSERT_EQ(taught.status, 0) << taught.err;
    EXPECT_NE(taught.out.find("Written: frames.yaml"), std::string::npos) << taught.out;
  }
  [[nodiscard]] FramesFile file() const {
    auto frames = tool::read_frames_file((folder_ / "frames.yaml").string());
    EXPECT_TRUE(frames);
    return *std::move(frames);
  }
  void expect_refused(const std::string& options, int status, const std::string& words) {
    const Outcome run = run_tool(folder_, options);
    EXPECT_EQ(run.status, status) << run.out;
    EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
  }
};

std::string typed(const NamedPose& frame) {
  const Eigen::Quaterniond q(frame.X.R);
  const Vector3 p = 1e3 * frame.X.p;
  return fmt::format("{:.12f},{:.12f},{:.12f},{:.15f},{:.15f},{:.15f},{:.15f}", p.x(), p.y(), p.z(),
                     q.w(), q.x(), q.y(), q.z());
}

TEST_F(FramesInAFile, correct_a_program_as_their_numbers_do) {
  teach();
  const FramesFile frames = file();
  ASSERT_EQ(frames.tools.size(), 1U);
  ASSERT_EQ(frames.work_objects.size(), 1U);
  const Outcome by_file = run_tool(folder_, std::string(kInto) + "--frames frames.yaml");
  ASSERT_EQ(by_file.status, 0) << by_file.err;
  const std::string corrected = read_file(folder_ / "c.mod");
  EXPECT_NE(corrected, read_file(folder_ / "p.mod"));

  for (const std::string& by :
       {"--tool torch=" + typed(frames.tools[0]) + " --frame=" + typed(frames.work_objects[0]),
        std::string("--frames frames.yaml --tool TORCH=torch --frame table"),
        std::string("--frames frames.yaml --tool other=1,2,3,0,0,0")}) {
    ASSERT_EQ(run_tool(folder_, kInto + by).status, 0) << by;
    EXPECT_EQ(read_file(folder_ / "c.mod"), corrected) << by;
  }
  ASSERT_EQ(run_tool(folder_, std::string(kInto) + "--frames frames.yaml --tool torch=0,0,0,0,0,0")
                .status,
            0);
  EXPECT_NE(read_file(folder_ / "c.mod"), corrected);  // what is typed comes first
}

TEST_F(FramesInAFile, correct_poses_of_the_tool_that_is_named) {
  teach();
  write_file(folder_ / "p.csv", "x_m,y_m,z_m,qw,qx,qy,qz\n0.04,0.03,0.02,0,1,0,0\n");
  const std::string command =
      "compensate --signature s.yaml --frames frames.yaml --poses p.csv --seed q.csv --out c.csv ";
  const Outcome named = run_tool(folder_, command + "--tool torch --frame table");
  ASSERT_EQ(named.status, 0) << named.err;
  expect_refused(command, 2, "poses do not say which tool they are of");
}

TEST_F(FramesInAFile, have_the_forms_of_controllers) {
  teach();
  const std::string text = read_file(folder_ / "frames.yaml");
  for (const char* form : {"# KUKA: {X ", "# ABB: [[", "# FANUC, Yaskawa: X ", "# UR: p["}) {
    EXPECT_NE(text.find(form), std::string::npos) << form << '\n' << text;
  }
  const Outcome krl = run_tool(folder_, std::string(kTaught) + " --language krl");
  const std::size_t at = text.find("{X ");
  EXPECT_NE(krl.out.find(text.substr(at, text.find('\n', at) - at)), std::string::npos) << krl.out;
}

TEST_F(FramesInAFile, are_not_written_where_the_result_is_refused) {
  write_file(
      folder_ / "few.csv",
      "frame,point,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\ntorch,tip,9,-62,88,0,63,-170\n");
  const Outcome run =
      run_tool(folder_, "frames --signature s.yaml --points few.csv --out frames.yaml");
  EXPECT_NE(run.status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "frames.yaml"));
  expect_refused("frames --signature s.yaml --points few.csv --out s.yaml", 2, "--signature");
}

TEST_F(FramesInAFile, are_refused_with_the_reason) {
  teach();
  expect_refused(std::string(kInto) + "--frames none.yaml", 2, "none.yaml");
  expect_refused(std::string(kInto) + "--frames frames.yaml --out frames.yaml", 2, "--out");
  expect_refused(std::string(kInto) + "--frames frames.yaml --tool trch", 2,
                 "expected \"torch\" of the file of --frames, or ");
  expect_refused(std::string(kInto) + "--frames frames.yaml --tool gripper", 2,
                 "expected a name of the file of --frames, or ");
}

std::string problem_with(const std::string& lists) {
  const auto frames = tool::parse_frames("armsig: frames/1\n" + lists, "f.yaml");
  return frames ? "" : frames.error().what;
}

TEST(FramesFile, refuses_what_is_no_frame) {
  const std::string tool =
      "  - {name: cup, position_m: [0, 0, 0.1], quaternion_wxyz: [1, 0, 0, 0]}\n";
  EXPECT_EQ(problem_with("tools:\n" + tool), "");
  EXPECT_EQ(problem_with("tools:\n" + tool + tool), "tool \"cup\" is there twice");
  EXPECT_EQ(problem_with("tools: []\n"), "no frame is in it");
  EXPECT_EQ(problem_with("work_objects:\n  - {name: w, position_m: [0, 0, 0], quaternion_wxyz: "
                         "[1, 1, 0, 0]}\n"),
            "a quaternion of length 1.4142135623730951");
  EXPECT_NE(problem_with("tool:\n" + tool), "");
  EXPECT_NE(problem_with("tools:\n  - {name: cup, position_m: [0, 0, 0.1]}\n"), "");
  EXPECT_NE(
      problem_with("tools:\n  - {name: \"\", position_m: [0, 0, 0.1], quaternion_wxyz: [1, 0, "
                   "0, 0]}\n"),
      "");
}

TEST(FramesFile, is_read_as_it_was_written) {
  FramesFile frames;
  frames.tools.push_back(
      {"a \"b\" #c", {rotation_about(Vector3(1, 2, 2) / 3, 0.7), {0.1, -0.2, 1e-9}}, {}});
  const auto read = tool::parse_frames(tool::frames_text(frames), "");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->tools[0].name, frames.tools[0].name);
  EXPECT_EQ(read->tools[0].X.p, frames.tools[0].X.p);
  EXPECT_TRUE(read->tools[0].X.R.isApprox(frames.tools[0].X.R, 1e-15));
}

}  // namespace
}  // namespace armsig::cli
