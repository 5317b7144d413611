// SPDX-License-Identifier: MIT
// Every way in which the input of `armsig identify` can be wrong: its own message, the right
// status, no output file.
#include <functional>
#include <map>

#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

// Measurements of a good arm, changed by `change`, then identified.
Outcome identify_changed(const Folder& folder, const std::function<void(Csv&)>& change,
                         const std::string& options = "") {
  write_file(folder / "arm.yaml", kTwoJointArm);
  const Outcome simulated = run_tool(
      folder, "simulate --arm arm.yaml --sigma-mm 0.1 --points 24 --seed 5 --out good.csv");
  EXPECT_EQ(simulated.status, 0) << simulated.err;
  Csv csv = Csv::read(folder / "good.csv");
  change(csv);
  csv.write(folder / "m.csv");
  return run_tool(folder, "identify --arm arm.yaml --measurements m.csv --out s.yaml " + options);
}

Outcome identify(const Folder& folder, const std::string& arm = "arm.yaml") {
  return run_tool(folder, "identify --arm " + arm + " --measurements m.csv --out s.yaml");
}

void expect_refused(const Folder& folder, const Outcome& outcome, int status,
                    const std::string& words) {
  EXPECT_EQ(outcome.status, status);
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "s.yaml"));
}

// Rows of one sweep.
void for_sweep(Csv& csv, const std::string& sweep, const std::function<void(Fields&)>& change) {
  for (Fields& row : csv.rows) {
    if (row[csv.column("sweep")] == sweep) change(row);
  }
}

TEST(Identify, accepts_what_the_simulator_writes) {
  const Folder folder;
  const Outcome outcome = identify_changed(folder, [](Csv&) {});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "s.yaml"));
}

// One thing wrong with good measurements.
struct Mistake {
  const char* name;
  std::function<void(Csv&)> make;
  int status;
  const char* words;  // of the message
};

// In a field of the row of line 5, sweep 1.
std::function<void(Csv&)> field(const std::string& column, const std::string& text) {
  return [column, text](Csv& csv) { csv.rows[3][csv.column(column)] = text; };
}

// In fields of every row of sweep 2.
std::function<void(Csv&)> second_sweep(const std::map<std::string, std::string>& fields) {
  return [fields](Csv& csv) {
    for_sweep(csv, "2", [&](Fields& row) {
      for (const auto& [column, text] : fields) row[csv.column(column)] = text;
    });
  };
}

// All but the first `kept` rows of sweep 2 are missing.
std::function<void(Csv&)> rows_of_second_sweep(int kept) {
  return [kept](Csv& csv) {
    int seen = 0;
    std::erase_if(csv.rows, [&](const Fields& row) {
      return row[csv.column("sweep")] == "2" && ++seen > kept;
    });
  };
}

void without_y(Csv& csv) {
  const auto y = static_cast<std::ptrdiff_t>(csv.column("y_mm"));
  csv.header.erase(csv.header.begin() + y);
  for (Fields& row : csv.rows) row.erase(row.begin() + y);
}

class WrongMeasurements : public testing::TestWithParam<Mistake> {};

TEST_P(WrongMeasurements, are_refused_by_identify) {
  const Folder folder;
  const Outcome outcome = identify_changed(folder, GetParam().make);
  expect_refused(folder, outcome, GetParam().status, GetParam().words);
}

INSTANTIATE_TEST_SUITE_P(
    All, WrongMeasurements,
    testing::Values(
        Mistake{"a_missing_column", without_y, 2, "y_mm"},
        Mistake{"a_column_without_a_unit",
                [](Csv& csv) { csv.header[csv.column("q2_deg")] = "q2"; }, 2, "q2_deg"},
        Mistake{"what_is_no_number", field("x_mm", "12,O"), 2, "m.csv:5:"},
        Mistake{"nan", field("x_mm", "nan"), 2, "nan"},
        Mistake{"too_few_fields", [](Csv& csv) { csv.rows[3].pop_back(); }, 2, "m.csv:5"},
        Mistake{"a_joint_outside_the_arm", field("sweep", "3"), 2, "m.csv:5"},
        Mistake{"the_joint_of_another_sweep_moves", field("q2_deg", "5"), 1,
                "sweep 1 moves joint 2"},
        Mistake{"a_joint_that_is_not_swept", rows_of_second_sweep(0), 1, "joint 2 is not swept"},
        Mistake{"one_reading_repeated", second_sweep({{"q2_deg", "10"}}), 1, "sweep 2"},
        Mistake{"fewer_points_than_unknowns", rows_of_second_sweep(2), 1,
                "fewer points than unknowns"},
        Mistake{"points_that_are_all_equal",
                second_sweep({{"x_mm", "1"}, {"y_mm", "2"}, {"z_mm", "3"}}), 1, "sweep 2"}),
    [](const auto& mistake) { return std::string(mistake.param.name); });

TEST(Identify, refuses_an_empty_file) {
  const Folder folder;
  write_file(folder / "arm.yaml", kTwoJointArm);
  write_file(folder / "m.csv", "");
  const Outcome outcome = identify(folder);
  expect_refused(folder, outcome, 2, "m.csv");
}

TEST(Identify, refuses_sweeps_that_disagree_about_the_signature_configuration) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  ASSERT_EQ(run_tool(folder, "simulate --arm arm.yaml --out good.csv").status, 0);
  Csv csv = Csv::read(folder / "good.csv");
  for_sweep(csv, "4", [&](Fields& row) { row[csv.column("q1_deg")] = "7"; });
  csv.write(folder / "m.csv");
  const Outcome outcome = identify(folder);
  expect_refused(folder, outcome, 1, "joint 1 at");
}

TEST(Identify, refuses_a_target_on_the_joint_axis_and_says_the_radius) {
  const Folder folder;
  write_file(folder / "arm.yaml", kTwoJointArm);
  ASSERT_EQ(run_tool(folder, "simulate --arm arm.yaml --target-radius-mm 0.5 --out m.csv").status,
            0);
  const Outcome outcome = identify(folder);
  expect_refused(folder, outcome, 1, "on the joint axis: radius 0.");
}

TEST(Identify, refuses_an_arc_too_short_to_tell_the_axis_and_says_limit_and_arc) {
  const Folder folder;
  write_file(folder / "arm.yaml", kTwoJointArm);
  ASSERT_EQ(run_tool(folder, "simulate --arm arm.yaml --arc 1 --out m.csv").status, 0);
  const Outcome outcome = identify(folder);
  expect_refused(folder, outcome, 1, "too short");
  EXPECT_NE(outcome.err.find("1.00°"), std::string::npos) << outcome.err;
}

TEST(Identify, names_the_joint_that_turns_against_the_drawing) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  ASSERT_EQ(run_tool(folder,
                     "simulate --arm arm.yaml --out good.csv "
                     "--configuration 10,-60,70,20,50,30")
                .status,
            0);
  Csv csv = Csv::read(folder / "good.csv");
  for (Fields& row : csv.rows) {
    std::string& q = row[csv.column("q2_deg")];
    q = q.starts_with('-') ? q.substr(1) : "-" + q;
  }
  csv.write(folder / "m.csv");
  const Outcome outcome = identify(folder);
  expect_refused(folder, outcome, 1, "joint 2 turns against the sense");
}

TEST(Identify, recognises_a_left_handed_sensor_frame) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  ASSERT_EQ(run_tool(folder, "simulate --arm arm.yaml --out good.csv").status, 0);
  Csv csv = Csv::read(folder / "good.csv");
  std::swap(csv.header[csv.column("x_mm")], csv.header[csv.column("y_mm")]);
  csv.write(folder / "m.csv");
  const Outcome outcome = identify(folder);
  expect_refused(folder, outcome, 1, "mirror image");
}

TEST(Identify, refuses_a_sensor_with_collinear_receivers) {
  const Folder folder;
  write_file(folder / "r.yaml",
             "armsig: sensor/1\nname: a line\nrange_sigma_mm: 0.2\npath: one-way\nreceivers:\n"
             "  - {x_mm: 0, y_mm: 0, z_mm: 0}\n  - {x_mm: 500, y_mm: 0, z_mm: 0}\n"
             "  - {x_mm: 1000, y_mm: 0, z_mm: 0}\n");
  const Outcome outcome = identify_changed(folder, [](Csv&) {}, "--sensor r.yaml");
  expect_refused(folder, outcome, 2, "r.yaml");
  EXPECT_NE(outcome.err.find("on one line"), std::string::npos) << outcome.err;
}

std::string arm_of(int joints) {
  std::string text = "armsig: arm/1\nname: odd\njoints:";
  if (joints == 0) return text + " []\n";
  text += "\n";
  for (int k = 0; k < joints; ++k) {
    text += "  - {type: revolute, theta_deg: 0, d_mm: 1, a_mm: 2, alpha_deg: 90}\n";
  }
  return text;
}

TEST(Identify, refuses_an_arm_of_no_joint_and_of_nine) {
  for (const int joints : {0, 9}) {
    const Folder folder;
    write_file(folder / "odd.yaml", arm_of(joints));
    write_file(folder / "m.csv", "sweep,target\n");
    const Outcome outcome = identify(folder, "odd.yaml");
    expect_refused(folder, outcome, 2, "odd.yaml:");
  }
}

TEST(Identify, refuses_an_unknown_key_and_suggests_the_known_one) {
  const Folder folder;
  write_file(folder / "arm.yaml",
             "armsig: arm/1\nname: odd\njoints:\n"
             "  - {type: revolute, teta_deg: 0, d_mm: 1, a_mm: 2, alpha_deg: 90}\n");
  write_file(folder / "m.csv", "sweep,target\n");
  const Outcome outcome = identify(folder);
  expect_refused(folder, outcome, 2, "theta_deg");
}

TEST(Identify, says_in_json_what_it_refuses) {
  const Folder folder;
  const Outcome outcome =
      identify_changed(folder, [](Csv& csv) { csv.rows[3][csv.column("x_mm")] = "nan"; }, "--json");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.out.find("\"line\": 5"), std::string::npos) << outcome.out;
}

TEST(Command, says_what_it_can_do_without_arguments) {
  const Folder folder;
  EXPECT_EQ(run_tool(folder, "").status, 0);
  EXPECT_EQ(run_tool(folder, "--help").status, 0);
  EXPECT_EQ(run_tool(folder, "identify --help").status, 0);
  EXPECT_EQ(run_tool(folder, "identfy").status, 2);
}

}  // namespace
}  // namespace armsig::cli
