// SPDX-License-Identifier: MIT
// armsig identify --instrument as a person meets it.
#include <gtest/gtest.h>

#include "host_tests/cli/run_tool.hpp"
#include "host_tests/support/touching_arm.hpp"

namespace armsig::cli {
namespace {

constexpr const char* kIdentify =
    "identify --arm arm.yaml --instrument instrument.yaml --measurements touches.csv --out s.yaml";

void write_session(const Folder& folder, const touching::Session& session) {
  write_file(folder / "arm.yaml", session.arm_yaml());
  write_file(folder / "instrument.yaml", session.instrument_yaml());
  write_file(folder / "touches.csv", session.csv());
}

touching::Session a_session(unsigned seed = 1, int touches = 60) {
  touching::Session session(touching::ur5(), seed);
  session.add_bars(4, 0.3, 0.02e-3);
  session.touch_sockets(touches);
  return session;
}

bool says(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

TEST(PlacesCommand, says_what_is_determined_and_how_accurate_it_is) {
  const Folder folder;
  write_session(folder, a_session());
  const Outcome run = run_tool(folder, kIdentify);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(says(run.out, "60 touches of 8 places: 0 rejected")) << run.out;
  EXPECT_TRUE(says(run.out, "determine 21 of the 33 numbers")) << run.out;
  EXPECT_TRUE(says(run.out, "each of 4 placements left out in turn")) << run.out;
  EXPECT_TRUE(says(run.out, "the scale of all lengths is part of it")) << run.out;
  EXPECT_TRUE(says(run.out, "ball: 1 sigma of a number is 0.0")) << run.out;
}

TEST(PlacesCommand, writes_a_signature_that_every_other_command_takes) {
  const Folder folder;
  const touching::Session session = a_session();
  write_session(folder, session);
  ASSERT_EQ(run_tool(folder, kIdentify).status, 0);
  write_file(
      folder / "q.csv",
      "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n10,-60,80,20,50,30\n-40,-90,70,-60,80,0\n");
  for (const char* command : {"predict --signature s.yaml --joints q.csv --target 1 --out p.csv",
                              "solve --signature s.yaml --poses p.csv --out back.csv",
                              "export --signature s.yaml --format urdf --out arm.urdf",
                              "export --signature s.yaml --format json --out arm.json",
                              "suggest --signature s.yaml --count 5 --out more.csv",
                              "report --signature s.yaml --out report.html"}) {
    const Outcome run = run_tool(folder, command);
    EXPECT_EQ(run.status, 0) << command << "\n" << run.err;
  }
}

TEST(PlacesCommand, gives_programs_the_same_as_json) {
  const Folder folder;
  write_session(folder, a_session());
  const Outcome run = run_tool(folder, std::string(kIdentify) + " --json");
  ASSERT_EQ(run.status, 0) << run.err;
  for (const char* key : {"\"determined\": 21", "\"scale_sigma\"", "\"known_lengths\"",
                          "\"validation\"", "\"predicted_tool_error_m\""}) {
    EXPECT_TRUE(says(run.out, key)) << key;
  }
}

TEST(PlacesCommand, warns_of_a_touch_of_another_socket_by_its_line) {
  const Folder folder;
  touching::Session session = a_session(2);
  session.readings()[9].place = session.readings()[9].place == "C1" ? "D1" : "C1";
  write_session(folder, session);
  const Outcome run = run_tool(folder, kIdentify);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(says(run.err, "line 11: named C1, but the tool was at ")) << run.err;
}

TEST(PlacesCommand, refuses_options_that_are_about_positions) {
  const Folder folder;
  write_session(folder, a_session(1, 30));
  for (const char* option : {" --correct gain --method refined", " --columns auto", " --explain"}) {
    EXPECT_EQ(run_tool(folder, std::string(kIdentify) + option).status, 2) << option;
  }
}

TEST(PlacesCommand, has_no_answer_to_too_few_touches) {
  const Folder folder;
  write_session(folder, a_session(1, 10));
  const Outcome run = run_tool(folder, kIdentify);
  EXPECT_EQ(run.status, 1);
  EXPECT_TRUE(says(run.err, "10 touches of ")) << run.err;
}

constexpr const char* kPlan = "plan --arm arm.yaml --instrument instrument.yaml --out plan.csv";

TEST(PlacesCommand, plans_touches_that_identify_takes) {
  const Folder folder;
  write_session(folder, a_session());
  const Outcome plan =
      run_tool(folder, std::string(kPlan) + " --accuracy-mm 0.16 --drawing places.svg");
  ASSERT_EQ(plan.status, 0) << plan.err;
  EXPECT_TRUE(says(plan.out, "touches of 8 places")) << plan.out;
  EXPECT_TRUE(says(plan.out, "Expected tool error, mm")) << plan.out;
  EXPECT_TRUE(says(plan.out,
                   "Next: armsig identify --arm arm.yaml --instrument instrument.yaml "
                   "--measurements touches.csv --out signature.yaml"))
      << plan.out;
  EXPECT_TRUE(says(read_file(folder / "places.svg"), ">D2: "));
  const Outcome run = run_tool(folder,
                               "identify --arm arm.yaml --instrument instrument.yaml "
                               "--measurements plan.csv --out signature.yaml");
  EXPECT_EQ(run.status, 0) << run.err;
}

TEST(PlacesCommand, has_no_plan_that_reaches_more_than_can_be_reached) {
  const Folder folder;
  write_session(folder, a_session());
  const Outcome plan = run_tool(folder, std::string(kPlan) + " --accuracy-mm 0.01 --touches 30");
  EXPECT_EQ(plan.status, 1);
  EXPECT_TRUE(says(plan.err, "30 touches leave a tool error of 0.")) << plan.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "plan.csv"));
}

TEST(PlacesCommand, has_no_plan_of_touches_too_few_to_be_identified_by) {
  const Folder folder;
  write_session(folder, a_session());
  const Outcome plan = run_tool(folder, std::string(kPlan) + " --accuracy-mm 10 --touches 10");
  EXPECT_EQ(plan.status, 1);
  EXPECT_TRUE(says(plan.err, "10 touches are too few to check 8 places")) << plan.err;
}

TEST(PlacesCommand, refuses_options_that_are_about_sweeps_or_programs) {
  const Folder folder;
  write_session(folder, a_session());
  for (const char* option : {" --arc 90", " --points 12", " --format urscript"}) {
    EXPECT_EQ(run_tool(folder, std::string(kPlan) + option).status, 2) << option;
  }
  EXPECT_EQ(run_tool(folder, "plan --arm arm.yaml --touches 50 --out plan.csv").status, 2);
}

}  // namespace
}  // namespace armsig::cli
