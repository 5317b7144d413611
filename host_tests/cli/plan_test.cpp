// SPDX-License-Identifier: MIT
// `plan`, and the programs that it and `suggest` write, as a person takes them to the robot.
#include <cmath>
#include <sstream>

#include <nlohmann/json.hpp>

#include "host_tests/cli/identified_arm.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

TEST(Plan, sweeps_a_joint_after_the_other_inside_the_limits_less_the_margin) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  const Outcome outcome =
      run_tool(folder,
               "plan --arm arm.yaml --configuration 0,-90,90,30,0,0 --points 10 "
               "--margin-deg 5 --out plan.csv");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Csv plan = Csv::read(folder / "plan.csv");
  ASSERT_EQ(plan.rows.size(), 60U);
  constexpr std::array<double, 6> kLower{-160, -225, -45, -110, -100, -266};
  constexpr std::array<double, 6> kUpper{160, 45, 225, 170, 100, 266};
  for (std::size_t row = 0; row < plan.rows.size(); ++row) {
    for (std::size_t j = 0; j < 6; ++j) {
      const double reading = plan.number(row, plan.header[j]);
      EXPECT_GE(reading, kLower.at(j) + 5 - 1e-9);
      EXPECT_LE(reading, kUpper.at(j) - 5 + 1e-9);
      // All but the swept joint rest where they are held.
      if (j != row / 10) {
        EXPECT_NEAR(reading, (kLower.at(j) + kUpper.at(j)) / 2, 1e-9);
      }
    }
  }
}

// A planar arm, so that where the target goes can be seen by eye: joint 1 turns it about the base,
// at 250 + 300 mm from its axis.
constexpr const char* kPlanar =
    "armsig: arm/1\nname: planar\njoints:\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 300, alpha_deg: 0, limits_deg: [-170, "
    "170]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 250, alpha_deg: 0, limits_deg: [-170, "
    "170]}\n"
    "floor_mm: 100\n";

TEST(Plan, stays_inside_the_box) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPlanar);
  const std::string boxed =
      "plan --arm arm.yaml --configuration 0,0 --box-mm 200,-400,-50,700,400,50 --json --out p.csv";
  const Outcome outcome = run_tool(folder, boxed);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const double end_rad = json::parse(outcome.out)["sweeps"][0]["last"];
  // y = 550 sin(q1) = 400, less the 12.5 mm that the links are thick and 5 mm of room.
  EXPECT_LE(550 * std::sin(end_rad), 400 - 12.5 - 2.5);
  EXPECT_NEAR(end_rad, std::asin((400 - 12.5 - 5) / 550), 0.01);
  const Csv plan = Csv::read(folder / "p.csv");
  for (std::size_t row = 0; row < plan.rows.size(); ++row) {
    const double q1 = plan.number(row, "q1_deg") * 3.14159265358979 / 180;
    const double q2 = plan.number(row, "q2_deg") * 3.14159265358979 / 180;
    EXPECT_GE(300 * std::cos(q1) + 250 * std::cos(q1 + q2), 200 - 1e-6);
    EXPECT_LE(std::abs(300 * std::sin(q1) + 250 * std::sin(q1 + q2)), 400 + 1e-6);
  }
}

TEST(Plan, says_what_the_box_leaves_too_little_of) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPlanar);
  const auto expect = [&](const std::string& options, int status, const std::string& what) {
    const Outcome outcome = run_tool(folder, "plan --arm arm.yaml --out p.csv " + options);
    EXPECT_EQ(outcome.status, status) << options;
    EXPECT_NE(outcome.err.find(what), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "p.csv"));
  };
  expect("--configuration 0,0 --box-mm 200,-102,-50,700,102,50", 1,
         "joint 1 sweeps 18 degrees: link 2 and the box would meet; expected 30 at least");
  expect("--configuration 0,0 --box-mm -100,-100,-100,100,100,100", 1,
         "link 2 is 463 mm beyond the box; it ends at 550, 0, 0 mm of the base frame");
  expect("--arc 90,90,90", 2, "3 arcs; expected one, or 2, one a joint");
  expect("--configuration 0,175", 2, "joint 2 at 175.000°; expected -168.000° to 168.000°");
  expect("--configuration 0", 2, "1 readings; expected 2, one a joint");
  expect("--margin-deg 89", 2, "89 leaves less than half of joint 1, -170 to 170");
  expect("--format krl", 2, "krl moves no such arm; expected six revolute joints");
}

// The numbers in the brackets after `before`, pose by pose.
std::vector<std::vector<double>> numbers_after(const std::string& text, const std::string& before,
                                               char end) {
  std::vector<std::vector<double>> poses;
  for (std::size_t at = 0; (at = text.find(before, at)) != std::string::npos;) {
    at += before.size();
    std::string list = text.substr(at, text.find(end, at) - at);
    std::vector<double> numbers;
    for (std::string& word : split(list, ',')) {
      const std::size_t blank = word.find_last_of(' ');  // "A1 12.5"
      numbers.push_back(std::stod(blank == std::string::npos ? word : word.substr(blank)));
    }
    poses.push_back(numbers);
  }
  return poses;
}

std::size_t count_of(const std::string& text, const std::string& words) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; ++at) ++count;
  return count;
}

TEST(Programs, go_where_the_table_says) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  const std::string plan = "plan --arm arm.yaml --points 6 --out ";
  ASSERT_EQ(run_tool(folder, plan + "plan.csv").status, 0);
  const Csv table = Csv::read(folder / "plan.csv");
  struct Language {
    const char* format;
    const char* before;
    char end;
    double unit;
    const char* wait;
  };
  for (const Language& language :
       {Language{"urscript", "movej([", ']', 180 / 3.14159265358979323846, "sleep(1.5)"},
        Language{"rapid", ":= [[", ']', 1, "WaitTime 1.5;"},
        Language{"krl", "PTP {", '}', 1, "WAIT SEC 1.5"}}) {
    SCOPED_TRACE(language.format);
    const Outcome outcome =
        run_tool(folder, plan + "program --wait-s 1.5 --format " + language.format);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string text = read_file(folder / "program");
    const auto poses = numbers_after(text, language.before, language.end);
    // First the configuration, which the sweeps begin from.
    ASSERT_EQ(poses.size(), table.rows.size() + 1);
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      ASSERT_EQ(poses[row + 1].size(), 6U);
      for (std::size_t j = 0; j < 6; ++j) {
        EXPECT_NEAR(language.unit * poses[row + 1][j], table.number(row, table.header[j]), 1e-4);
      }
    }
    EXPECT_EQ(count_of(text, language.wait), poses.size() - count_of(text, "only gone through"));
  }
}

TEST(Programs, begin_with_what_they_do_and_stop_before_they_move) {
  const Folder folder;
  struct Language {
    const char* format;
    const char* mark;
    const char* stop;
    const char* move;
  };
  for (const Language& language : {Language{"urscript", "# ", "  popup(\"", "movej("},
                                   Language{"rapid", "! ", "    Stop;\n", "MoveAbsJ"},
                                   Language{"krl", "; ", "  HALT\n", "PTP {"}}) {
    SCOPED_TRACE(language.format);
    const Outcome outcome =
        run_tool(folder, std::string("plan --arm ur5 --out program --format ") + language.format);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string text = read_file(folder / "program");
    const std::size_t stop = text.find(language.stop);
    ASSERT_NE(stop, std::string::npos);
    EXPECT_LT(stop, text.find(language.move));
    for (const char* const words :
         {"UR5: sweeps to measure", "Assumed: the joint limits of the arm description, less 2",
          "Assumed: no link below the mounting plane", "Speed: ", "Clear the area of the arm"}) {
      const std::size_t at = text.find(std::string(language.mark) + words);
      EXPECT_LT(at, stop) << words;
    }
  }
}

// The arc of one joint is asked for by itself.
TEST(Plan, sweeps_each_joint_over_its_own_arc) {
  const Folder folder;
  const Outcome outcome =
      run_tool(folder, "plan --arm ur5 --arc 90,60,120,45,100,300 --json --out p.csv");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json sweeps = json::parse(outcome.out)["sweeps"];
  constexpr std::array<double, 6> kArcs{90, 60, 120, 45, 100, 300};
  for (std::size_t j = 0; j < 6; ++j) {
    const double arc = sweeps[j]["last"].get<double>() - sweeps[j]["first"].get<double>();
    EXPECT_NEAR(arc * 180 / 3.14159265358979, kArcs.at(j), 1e-6);
  }
}

// Where the arm description has no signature configuration one is found.
TEST(Plan, finds_a_configuration_with_good_sweeps) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  const Outcome outcome = run_tool(folder, "plan --arm arm.yaml --json --out p.csv");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const json& sweep : json::parse(outcome.out)["sweeps"]) {
    EXPECT_GT(sweep["last"].get<double>() - sweep["first"].get<double>(), 2.6);
  }
}

TEST(Suggest, keeps_a_margin_from_the_limits) {
  const Folder folder;
  identified(folder);
  ASSERT_EQ(
      run_tool(folder, "suggest --signature s.yaml --count 20 --margin-deg 4 --out n.csv").status,
      0);
  const Csv next = Csv::read(folder / "n.csv");
  double closest = 1e9;
  for (std::size_t row = 0; row < next.rows.size(); ++row) {
    closest = std::min(closest, 160 - std::abs(next.number(row, "q1_deg")));
  }
  EXPECT_GE(closest, 4 - 1e-9);
}

}  // namespace
}  // namespace armsig::cli
