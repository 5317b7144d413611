// SPDX-License-Identifier: MIT
// Input that was made to do harm: names that run code or drive a terminal, files that swell, output
// that falls on input, ends at the wrong moment.
#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

void expect_refused_at_once(const Outcome& outcome, const std::string& words) {
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
}

std::string urdf_called(const std::string& name) {
  return "<robot name=\"" + name +
         "\">\n<link name=\"b\"/><link name=\"t\"/>\n"
         "<joint name=\"j\" type=\"continuous\"><parent link=\"b\"/><child link=\"t\"/></joint>\n"
         "</robot>\n";
}

TEST(Names, with_control_characters_are_refused_in_a_urdf) {
  const Folder folder;
  for (const char* bad :
       {"Arm 7&#13;import os", "a&#10;b", "a&#27;[31m", "a&#133;b", "a&#8232;b", "a&#x202E;b"}) {
    write_file(folder / "r.urdf", urdf_called(bad));
    const Outcome outcome =
        run_tool(folder, "import --urdf r.urdf --base b --tip t --out arm.yaml");
    expect_refused_at_once(outcome, "r.urdf:1: name of the robot: the character");
    EXPECT_FALSE(std::filesystem::exists(folder / "arm.yaml"));
  }
  write_file(folder / "r.urdf", urdf_called("Gr&#246;&#223;e"));
  EXPECT_EQ(run_tool(folder, "import --urdf r.urdf --base b --tip t --out arm.yaml").status, 0);
}

TEST(Names, with_control_characters_are_refused_in_options_and_descriptions) {
  const Folder folder;
  write_file(folder / "arm.yaml", kTwoJointArm);
  write_file(folder / "m.csv", "sweep,target\n");
  expect_refused_at_once(run_tool(folder,
                                  "identify --arm arm.yaml --measurements m.csv --out s.yaml "
                                  "--serial \"$(printf 'a\\rb')\""),
                         "--serial: the character \"\\x0D\" in \"a\\x0Db\"; expected printable");
  for (const char* escape : {"\\r", "\\n", "\\e", "\\N", "\\L", "\\P", "\\0", "\\x7f"}) {
    std::string arm = kTwoJointArm;
    arm.replace(arm.find("two joints"), 10, std::string("\"a") + escape + "b\"");
    write_file(folder / "odd.yaml", arm);
    const Outcome outcome = run_tool(folder, "simulate --arm odd.yaml --json --out m.csv");
    expect_refused_at_once(outcome, "odd.yaml:2:7: the character");
  }
}

TEST(Terminals, are_given_no_command_by_what_a_message_repeats) {
  const Folder folder;
  const std::string arguments =
      "predict --signature \"$(printf 'a\\033[2J\\302\\233b')\" "
      "--joints q.csv --out \"$(printf 'o\\033c')\" --json";
  const Outcome outcome = run_tool(folder, arguments);
  expect_refused_at_once(outcome, "a\\x1B[2J\\x9Bb");
  for (const std::string& said : {outcome.out, outcome.err}) {
    EXPECT_EQ(said.find('\033'), std::string::npos) << said;
    EXPECT_EQ(said.find("\xC2\x9B"), std::string::npos) << said;
  }
  const Outcome usage = run_tool(folder, "\"$(printf 'x\\033[2J')\"");
  EXPECT_EQ(usage.status, 2);
  EXPECT_EQ(usage.err.find('\033'), std::string::npos) << usage.err;
}

TEST(Targets, beyond_thirty_two_are_refused_before_they_cost_memory) {
  const Folder folder;
  write_file(folder / "arm.yaml", kTwoJointArm);
  std::string rows = "sweep,target,q1_deg,q2_deg,x_mm,y_mm,z_mm\n";
  for (int k = 0; k < 20000; ++k) rows += "1," + std::to_string(k) + ",1,2,3,4,5\n";
  write_file(folder / "m.csv", rows);
  const Outcome outcome =
      run_tool(folder, "identify --arm arm.yaml --measurements m.csv --out s.yaml");
  expect_refused_at_once(outcome,
                         "m.csv:34:3: target 32 is one too many; expected at most 32 targets");
}

TEST(Output, is_never_one_of_the_inputs) {
  const Folder folder;
  write_file(folder / "arm.yaml", kTwoJointArm);
  ASSERT_EQ(run_tool(folder, "simulate --arm arm.yaml --out m.csv").status, 0);
  std::filesystem::create_symlink("arm.yaml", folder / "soft.yaml");
  std::filesystem::create_hard_link(folder / "arm.yaml", folder / "hard.yaml");
  const std::string identify = "identify --arm arm.yaml --measurements m.csv --out ";
  for (const char* out : {"arm.yaml", "./arm.yaml", "soft.yaml", "hard.yaml"}) {
    expect_refused_at_once(run_tool(folder, identify + out), "is the file of --arm too");
  }
  expect_refused_at_once(run_tool(folder, identify + "./m.csv"),
                         "is the file of --measurements too");
  EXPECT_EQ(read_file(folder / "arm.yaml"), kTwoJointArm);
  EXPECT_EQ(
      run_tool(folder, "simulate --arm arm.yaml --out /dev/null --truth-out /dev/null").status, 0);
}

TEST(Output, is_refused_before_the_work_where_no_file_can_be) {
  const Folder folder;
  write_file(folder / "arm.yaml", kTwoJointArm);
  std::filesystem::create_directory(folder / "folder");
  std::filesystem::create_symlink("loop", folder / "loop");
  // There are no measurements: they would be said if they had been looked for first.
  const std::string identify = "identify --arm arm.yaml --measurements none.csv --out ";
  expect_refused_at_once(run_tool(folder, identify + "''"),
                         "--out: an empty name; expected a file, or - for standard output");
  expect_refused_at_once(run_tool(folder, identify + "folder"),
                         "folder: can't be written: Is a directory");
  expect_refused_at_once(run_tool(folder, identify + "none/s.yaml"),
                         "none/s.yaml: can't be written: none: No such file or directory");
  expect_refused_at_once(run_tool(folder, identify + "loop"),
                         "loop: can't be written: Too many levels");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "loop"));
}

TEST(Output, by_a_link_to_nothing_yet_is_the_file_that_it_names) {
  const Folder folder;
  write_file(folder / "arm.yaml", kTwoJointArm);
  std::filesystem::create_directory(folder / "results");
  std::filesystem::create_symlink("results/m.csv", folder / "link.csv");
  ASSERT_EQ(run_tool(folder, "simulate --arm arm.yaml --out link.csv").status, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.csv"));
  EXPECT_TRUE(std::filesystem::is_regular_file(folder / "results/m.csv"));
  std::filesystem::remove(folder / "link.csv");
  std::filesystem::create_symlink("nowhere/m.csv", folder / "link.csv");
  expect_refused_at_once(run_tool(folder, "simulate --arm arm.yaml --out link.csv"),
                         "link.csv: can't be written: nowhere: No such file or directory");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.csv"));
}

TEST(Output, that_no_disk_has_room_for_is_told) {
  const Folder folder;
  write_file(folder / "arm.yaml", kTwoJointArm);
  const Outcome outcome = run_tool(
      folder, "simulate --arm arm.yaml --json --out m.csv > /dev/full; echo $? > status #");
  EXPECT_EQ(read_file(folder / "status"), "1\n");
}

TEST(Output, is_never_written_twice) {
  const Folder folder;
  write_file(folder / "arm.yaml", kTwoJointArm);
  for (const char* truth : {"x.yaml", "./x.yaml", "X.yaml"}) {
    expect_refused_at_once(
        run_tool(folder, std::string("simulate --arm arm.yaml --out x.yaml --truth-out ") + truth),
        "is the file of --out too");
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "x.yaml"));
}

TEST(Output, leaves_nothing_temporary_when_a_signal_ends_the_command) {
  for (const char* signal : {"HUP", "TERM"}) {
    const Folder folder;
    // Enough rows to be at work when the temporary file is seen.
    const std::string script =
        "cd '" + folder.path().string() +
        "' || exit 99; '" ARMSIG_TOOL
        "' simulate --arm puma560 --points 20000000 --out m.csv >.out 2>.err & pid=$!; n=0; "
        "while ! ls m.csv.tmp-* >/dev/null 2>&1; do "
        "n=$((n+1)); [ $n -lt 2000 ] || exit 98; sleep 0.01; done; kill -" +
        std::string(signal) + " $pid; wait $pid";
    const int raw = std::system(script.c_str());  // NOLINT(cert-env33-c): our own command line
    ASSERT_TRUE(WIFEXITED(raw));
    EXPECT_GT(WEXITSTATUS(raw), 128);
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      files += entry.path().filename().string().find("m.csv") == 0 ? 1 : 0;
    }
    EXPECT_EQ(files, 0U) << signal;
  }
}

}  // namespace
}  // namespace armsig::cli
