// SPDX-License-Identifier: MIT
// What a person gets who mistypes, and what a program gets.
#include <nlohmann/json.hpp>

#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

void expect_words(const std::string& arguments, const std::string& words) {
  const Folder folder;
  const Outcome outcome = run_tool(folder, arguments);
  EXPECT_EQ(outcome.status, 2) << arguments;
  EXPECT_EQ(outcome.err, "armsig: " + words + "\n");
  EXPECT_EQ(outcome.out, "");
}

TEST(Usage, names_the_command_that_was_meant) {
  expect_words("idenfity --arm a.yaml", "\"idenfity\" is no command; expected identify");
  expect_words("xyz", "\"xyz\" is no command; expected one that armsig --help lists");
}

std::string help(const std::string& arguments) {
  const Folder folder;
  const Outcome outcome = run_tool(folder, arguments);
  EXPECT_EQ(outcome.status, 0) << arguments;
  EXPECT_EQ(outcome.err, "");
  return outcome.out;
}

TEST(Usage, gives_help_however_it_is_asked_for) {
  const std::string of_all = help("--help");
  EXPECT_NE(of_all.find("\n  identify "), std::string::npos) << of_all;
  EXPECT_EQ(help(""), of_all);
  EXPECT_EQ(help("help"), of_all);
  EXPECT_EQ(help("-h"), of_all);
  EXPECT_EQ(help("help check"), help("check --help"));
  EXPECT_EQ(help("-V"), help("--version"));
  expect_words("help chek", "\"chek\" is no command; expected check");
}

TEST(Usage, shows_what_an_option_takes_in_words) {
  const std::string simulate = help("simulate --help");
  for (const char* line :
       {"\n  --points NUMBER             points a sweep (2 to 100000000) (default 36)\n",
        "\n  -o,--out FILE               measurements to write (CSV) (required)\n",
        "\n  --flange-target-mm NUMBER   ", "(3 numbers) (not with\n",
        "\n  --configuration NUMBER ...  "}) {
    EXPECT_NE(simulate.find(line), std::string::npos) << line << simulate;
  }
  const std::string plan = help("plan --help");
  EXPECT_NE(plan.find("\n  --format csv|urscript|rapid|krl\n"), std::string::npos) << plan;
  for (const char* of_the_parser : {"TEXT:", "FLOAT", "INT", "REQUIRED", "Needs:", "Excludes:"}) {
    EXPECT_EQ(simulate.find(of_the_parser), std::string::npos) << of_the_parser << simulate;
    EXPECT_EQ(plan.find(of_the_parser), std::string::npos) << of_the_parser << plan;
  }
}

TEST(Usage, takes_the_short_name_of_the_output_and_words_in_any_case) {
  const Folder folder;
  ASSERT_EQ(run_tool(folder, "plan --arm UR10e -o poses.txt --format RAPID").status, 0);
  EXPECT_NE(read_file(folder / "poses.txt").find("MODULE"), std::string::npos);
  const Outcome outcome = run_tool(folder, "plan --arm ur10e -o -");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.out.find("Next:"), std::string::npos) << outcome.out;
}

TEST(Usage, names_the_option_that_was_meant) {
  expect_words("identify --measurments m.csv",
               "armsig identify has no option \"--measurments\"; expected --measurements");
  expect_words("report --signature=s.yaml --ouy=r.html",
               "armsig report has no option \"--ouy\"; expected --out");
  expect_words("report --frobnicate",
               "armsig report has no option \"--frobnicate\"; expected one that armsig report "
               "--help lists");
}

TEST(Usage, wraps_what_it_refuses_where_it_is_read_on_a_terminal) {
  const Folder folder;
  const std::string wrong = "report --frobnicate";
  const std::string line = run_tool(folder, wrong).err;
  ASSERT_EQ(line.size(), 97);
  EXPECT_EQ(shown_on_terminal(folder, wrong, 96), line);
  EXPECT_EQ(shown_on_terminal(folder, wrong, 95),
            "armsig: armsig report has no option \"--frobnicate\"; expected one that armsig report "
            "--help\n  lists\n");
  const std::string at_80 =
      "armsig: armsig report has no option \"--frobnicate\"; expected one that armsig\n"
      "  report --help lists\n";
  EXPECT_EQ(shown_on_terminal(folder, wrong, 80), at_80);
  EXPECT_EQ(shown_on_terminal(folder, wrong, 0), at_80);  // a terminal that does not know
}

TEST(Usage, names_the_word_that_was_meant) {
  expect_words("export --signature s.yaml --format urd --out x",
               "--format: \"urd\" is none of its words; expected urdf");
}

TEST(Usage, says_which_numbers_an_option_takes) {
  const std::string simulate = "simulate --arm ur10e --out m.csv ";
  expect_words(simulate + "--sigma-mm -1",
               "--sigma-mm: \"-1\" is out of its range; expected 0 or more");
  expect_words(simulate + "--free-poses -1",
               "--free-poses: \"-1\" is out of its range; expected a number from 0 to 100000000");
  expect_words(simulate + "--target-radius-mm 0",
               "--target-radius-mm: \"0\" is out of its range; expected a number above 0");
  expect_words(simulate + "--maps-deg 0.6",
               "--maps-deg: \"0.6\" is out of its range; expected a number from 0 to 0.5");
  expect_words("plan --arm ur10e --out p.csv --points five",
               "--points: \"five\" is not a number; expected a number from 6 to 1000");
}

// A comparison with a range lets "nan" pass.
TEST(Usage, takes_no_number_that_is_not_finite) {
  const std::string plan = "plan --arm ur10e --out p.csv ";
  expect_words(plan + "--arc nan", "--arc: \"nan\" is not a finite number; expected a number");
  expect_words(plan + "--box-mm 0,0,-inf,1,1,1",
               "--box-mm: \"-inf\" is not a finite number; expected a number");
  expect_words("suggest --signature s.yaml --out n.csv --sigma-mm nan",
               "--sigma-mm: \"nan\" is not a finite number; expected a number");
  expect_words("simulate --arm ur10e --out m.csv --sigma-mm NaN",
               "--sigma-mm: \"NaN\" is not a finite number; expected a number");
}

TEST(Usage, names_the_option_of_the_program_that_was_meant) {
  expect_words("--hlep", "armsig has no option \"--hlep\"; expected --help");
  expect_words("-x", "armsig has no option \"-x\"; expected what armsig --help lists");
}

TEST(Usage, says_what_is_missing) {
  expect_words("report --signature s.yaml",
               "--out is required; expected what armsig report --help says");
}

TEST(Usage, names_the_arm_that_was_meant) {
  const Folder folder;
  const Outcome outcome = run_tool(folder, "arms --show ur10f");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("expected ur10"), std::string::npos) << outcome.err;
}

TEST(Usage, tells_programs_of_mistakes_as_of_results) {
  const Folder folder;
  for (const char* arguments : {"idenfity --json", "report --json", "arms --show nobody --json"}) {
    const Outcome outcome = run_tool(folder, arguments);
    EXPECT_EQ(outcome.status, 2);
    const json result = json::parse(outcome.out);
    EXPECT_EQ(result["schema"], "armsig-result/1");
    EXPECT_EQ(result["status"], 2);
    EXPECT_FALSE(result["error"]["what"].get<std::string>().empty());
    EXPECT_FALSE(result["error"]["expected"].get<std::string>().empty());
  }
  const Outcome listed = run_tool(folder, "arms --json");
  EXPECT_EQ(listed.status, 0);
  const json result = json::parse(listed.out);
  EXPECT_EQ(result["schema"], "armsig-result/1");
  EXPECT_EQ(result["status"], 0);
}

TEST(Usage, writes_the_file_to_standard_output_and_its_words_elsewhere) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  ASSERT_EQ(run_tool(folder, "plan --arm arm.yaml --points 6 --out plan.csv").status, 0);
  for (const char* out : {"--out -", "--out=-"}) {
    const Outcome outcome = run_tool(folder, std::string("plan --arm arm.yaml --points 6 ") + out);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, read_file(folder / "plan.csv"));
    EXPECT_NE(outcome.err.find("Next: "), std::string::npos);
  }
  const Outcome simulated = run_tool(folder, "simulate --arm arm.yaml --out -");
  EXPECT_EQ(simulated.status, 0);
  EXPECT_NE(simulated.err.find(" rows on standard output; "), std::string::npos) << simulated.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "-"));
}

// The last line that a command says is what to do next.
TEST(Usage, says_what_to_do_next_at_the_end_of_every_command) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  for (const char* arguments :
       {"simulate --arm arm.yaml --flange-target-mm 80,30,120 --points 12 --free-poses 30 "
        "--sigma-mm 0.05 --out m.csv "
        "--truth-out t.yaml",
        "plan --arm arm.yaml --out plan.csv",
        "identify --arm arm.yaml --measurements m.csv --method refined --out s.yaml",
        "simulate --arm arm.yaml --truth t.yaml --flange-target-mm 80,30,120 --points 4 "
        "--free-poses 20 --sigma-mm 0.05 --seed 2 --out later.csv",
        "check --signature s.yaml --measurements later.csv",
        "report --signature s.yaml --out r.html",
        "suggest --signature s.yaml --count 2 --out n.csv",
        "predict --signature s.yaml --joints n.csv --target 1 --out p.csv",
        "solve --signature s.yaml --poses p.csv --target 1 --seed n.csv --out q.csv",
        "export --signature s.yaml --format urdf --out a.urdf",
        "import --urdf a.urdf --base base_link --tip last_link --out b.yaml", "arms"}) {
    const Outcome outcome = run_tool(folder, arguments);
    ASSERT_EQ(outcome.status, 0) << arguments << ": " << outcome.err;
    const Fields lines = split(outcome.out, '\n');
    EXPECT_TRUE(lines.back().starts_with("Next: ")) << arguments << ": " << lines.back();
  }
}

// What the command writes it reads again: bends that no file may hold are no simulation's either.
TEST(Usage, refuses_to_simulate_bends_that_no_signature_could_tell) {
  const Folder folder;
  const auto simulate = [&](const std::string& bends) {
    return run_tool(
        folder, "simulate --arm cobra600 --sigma-mm 0.1 --out m.csv --truth-out t.yaml " + bends);
  };
  EXPECT_EQ(simulate("--maps-deg 0.05 --deflection-mm 2").status, 0);
  const Outcome steep = simulate("--maps-deg 0.5");
  EXPECT_EQ(steep.status, 2);
  EXPECT_NE(steep.err.find("--maps-deg: 0.5 is too steep a map of joint "), std::string::npos)
      << steep.err;
  // A hand's breadth of an arm that sags by the most that can be asked for.
  write_file(folder / "short.yaml",
             "armsig: arm/1\nname: short\njoints:\n"
             "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: -90}\n"
             "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 80, alpha_deg: 0}\n");
  const Outcome weak = run_tool(folder, "simulate --arm short.yaml --deflection-mm 20 --out m.csv");
  EXPECT_EQ(weak.status, 2);
  EXPECT_NE(weak.err.find("--deflection-mm: 20 turns joint 2 by "), std::string::npos) << weak.err;
}

}  // namespace
}  // namespace armsig::cli
