// SPDX-License-Identifier: MIT
// `check` as a user meets it: whether an arm is still the one that its signature says.
#include <cmath>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "host_tests/cli/identified_arm.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

Outcome check(const Folder& folder, const Csv& rows, const std::string& options = "") {
  rows.write(folder / "held.csv");
  return run_tool(folder, "check --signature s.yaml --measurements held.csv " + options);
}

void add_to(Csv& rows, const std::string& column, double value) {
  for (Fields& row : rows.rows) {
    std::string& field = row[rows.column(column)];
    field = std::to_string(std::stod(field) + value);
  }
}

TEST(Check, finds_a_healthy_arm_consistent_and_far_better_than_its_drawing) {
  const Folder folder;
  const Csv held = identified(folder);
  const Outcome outcome = check(folder, held, "--json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["verdict"], "consistent");
  EXPECT_EQ(result["rows"], 30);
  EXPECT_LT(result["rms_m"], 6e-4);
  EXPECT_GT(result["nominal"]["rms_m"], 3 * result["rms_m"].get<double>());
  const Outcome words = check(folder, held);
  EXPECT_NE(words.out.find("before: nominal, base and tool fitted"), std::string::npos);
  EXPECT_NE(words.out.find("after: the signature as it is"), std::string::npos);
}

TEST(Check, compares_with_another_drawing_where_it_is_given_one) {
  const Folder folder;
  const Csv held = identified(folder);
  std::string other = kPuma560;
  other.replace(other.find("a_mm: 431.8"), 11, "a_mm: 531.8");
  write_file(folder / "other.yaml", other);
  const auto nominal_rms_m = [&](const std::string& options) {
    const Outcome outcome = check(folder, held, "--json " + options);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out)["nominal"]["rms_m"].get<double>();
  };
  EXPECT_GT(nominal_rms_m("--arm other.yaml"), 2 * nominal_rms_m(""));
  other.replace(other.find("a_mm: 531.8"), 11, "a_mm: 2531.8");
  write_file(folder / "other.yaml", other);
  ASSERT_GT(nominal_rms_m("--arm other.yaml"), 0.1);
  EXPECT_NE(check(folder, held, "--arm other.yaml").out.find("base and tool fitted "),
            std::string::npos);
  write_file(folder / "other.yaml", kTwoJointArm);
  EXPECT_EQ(check(folder, held, "--arm other.yaml").status, 2);
}

TEST(Check, answers_for_signatures_of_every_method) {
  for (const char* method : {"encoder", "paper"}) {
    const Folder folder;
    const Csv held = identified(folder, method);
    const Outcome outcome = check(folder, held, "--json");
    EXPECT_EQ(json::parse(outcome.out)["verdict"], "consistent") << method << outcome.out;
  }
}

// A set pasted twenty times says no more than once.
TEST(Check, counts_copied_rows_once) {
  const Folder folder;
  Csv held = identified(folder);
  const std::vector<Fields> rows = held.rows;
  const json once = json::parse(check(folder, held, "--json").out);
  for (int copy = 1; copy < 20; ++copy) {
    held.rows.insert(held.rows.end(), rows.begin(), rows.end());
  }
  const json copied = json::parse(check(folder, held, "--json").out);
  for (const char* figure : {"verdict", "rows", "degrees_of_freedom", "chi_square", "rms_m"}) {
    EXPECT_EQ(copied[figure], once[figure]) << figure;
  }
  EXPECT_EQ(copied["rows_copied"], 19 * rows.size());
  EXPECT_NE(check(folder, held).out.find("570 rows are copies of others, and count once"),
            std::string::npos);
}

TEST(Check, finds_the_zero_of_a_joint_that_has_moved) {
  const Folder folder;
  Csv held = identified(folder);
  add_to(held, "q3_deg", 0.2);
  const Outcome outcome = check(folder, held);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.out.find("held.csv: drifted"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("zero of joint 3"), std::string::npos) << outcome.out;
}

// 250 mm and 3 degrees from where it stood: the arm is the same, and the noise is not thousands of
// times the stated one.
TEST(Check, finds_the_place_that_the_arm_was_measured_from) {
  const Folder folder;
  Csv held = identified(folder);
  for (std::size_t k = 0; k < held.rows.size(); ++k) {
    const double c = std::cos(3 / 57.29577951308232);
    const double s = std::sin(3 / 57.29577951308232);
    const double x = held.number(k, "x_mm");
    const double y = held.number(k, "y_mm");
    held.rows[k][held.column("x_mm")] = std::to_string(c * x - s * y + 200);
    held.rows[k][held.column("y_mm")] = std::to_string(s * x + c * y - 150);
  }
  const Outcome outcome = check(folder, held);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.out.find("measured from another place: 2"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find(", 3.0"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("from there consistent"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("times the one stated"), std::string::npos) << outcome.out;
  const json result = json::parse(check(folder, held, "--json").out);
  EXPECT_EQ(result["verdict"], "another-place");
  EXPECT_NEAR(result["place"]["turn_rad"], 3 / 57.2957795, 1e-3);
  EXPECT_LT(result["rms_m"], 6e-4);
}

TEST(Check, finds_a_sensor_worse_than_stated) {
  const Folder folder;
  identified(folder);
  ASSERT_EQ(run_tool(folder,
                     "simulate --arm arm.yaml --flange-target-mm 80,30,120 --sigma-mm 1 --truth "
                     "truth.yaml --points 4 --free-poses 40 --seed 9 --out noisy.csv")
                .status,
            0);
  Csv noisy = Csv::read(folder / "noisy.csv");
  for (Fields& row : noisy.rows) row[noisy.column("sigma_mm")] = "0.2";
  const Outcome outcome = check(folder, noisy);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.out.find("sensor worse than stated"), std::string::npos) << outcome.out;
}

// Gears err by more than the tracker: no fit of axes explains that, and no arm is ill for it.
TEST(Check, does_not_blame_arm_or_sensor_for_what_the_identification_left_unexplained) {
  const Folder folder;
  Csv held = identified(folder);
  const auto bend = [](Csv& rows) {
    for (Fields& row : rows.rows) {
      row[rows.column("sigma_mm")] = "0.01";
      std::string& q = row[rows.column("q3_deg")];
      q = std::to_string(std::stod(q) + 0.05 * std::sin(7 * std::stod(q) / 57.3));
    }
  };
  Csv measured = Csv::read(folder / "m.csv");
  std::erase_if(measured.rows,
                [&](const Fields& row) { return row[measured.column("sweep")] != "0"; });
  measured.rows.insert(measured.rows.end(), held.rows.begin() + 15, held.rows.end());
  held.rows.resize(15);
  bend(held);
  bend(measured);
  measured.write(folder / "m.csv");
  const Outcome found = run_tool(
      folder, "identify --arm arm.yaml --measurements m.csv --method refined --out s.yaml");
  ASSERT_EQ(found.status, 0) << found.err;
  EXPECT_NE(found.out.find("times the stated noise"), std::string::npos) << found.out;
  EXPECT_NE(read_file(folder / "s.yaml").find("unexplained_m: "), std::string::npos);
  const Outcome healthy = check(folder, held);
  EXPECT_EQ(healthy.status, 0) << healthy.out;
}

TEST(Check, sets_a_blunder_apart_and_names_its_line) {
  const Folder folder;
  Csv held = identified(folder);
  held.rows[4][held.column("y_mm")] = "4000";
  const Outcome outcome = check(folder, held);
  EXPECT_EQ(outcome.status, 0) << outcome.out;
  EXPECT_NE(outcome.out.find("outliers, by line: 6\n"), std::string::npos) << outcome.out;
}

TEST(Check, refuses_what_it_cannot_judge) {
  const Folder folder;
  Csv held = identified(folder);
  const std::string measured = " --measurements held.csv";
  const Outcome exact = run_tool(folder, "check --signature truth.yaml" + measured);
  EXPECT_EQ(exact.status, 2);
  EXPECT_NE(exact.err.find("no covariance"), std::string::npos) << exact.err;
  EXPECT_EQ(run_tool(folder, "check --signature none.yaml" + measured).status, 2);
  EXPECT_EQ(run_tool(folder, "check --signature s.yaml --measurements none.csv").status, 2);
  for (Fields& row : held.rows) row[held.column("target")] = "7";
  const Outcome unknown = check(folder, held);
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("target 7 is not in the signature"), std::string::npos);
  for (Fields& row : held.rows) row[held.column("target")] = "1";
  add_to(held, "x_mm", 300);
  for (std::size_t k = 0; k < held.rows.size(); k += 2) held.rows[k][held.column("z_mm")] = "9000";
  EXPECT_EQ(check(folder, held).status, 1);
}

TEST(Check, takes_ranges_in_the_air_that_they_were_measured_in) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  const std::string sensor =
      "armsig: sensor/1\nname: frame\nrange_sigma_mm: 0.2\npath: one-way\n"
      "receivers:\n"
      "  - {x_mm: 0, y_mm: 0, z_mm: 0}\n  - {x_mm: 1500, y_mm: 0, z_mm: 0}\n"
      "  - {x_mm: 0, y_mm: 1500, z_mm: 0}\n  - {x_mm: 1500, y_mm: 1500, z_mm: 300}\n";
  write_file(folder / "r.yaml", sensor);
  const std::string simulate =
      "simulate --arm arm.yaml --sensor r.yaml --flange-target-mm 80,30,120 --air-c 20 ";
  ASSERT_EQ(run_tool(folder, simulate + "--tolerances 1 --free-poses 20 --seed 3 --out m.csv "
                                        "--truth-out truth.yaml")
                .status,
            0);
  const Outcome found = run_tool(folder,
                                 "identify --arm arm.yaml --sensor r.yaml --measurements m.csv "
                                 "--method refined --out s.yaml");
  ASSERT_EQ(found.status, 0) << found.err;
  ASSERT_EQ(run_tool(folder, simulate + "--truth truth.yaml --points 4 --free-poses 30 --seed 4 "
                                        "--out held.csv")
                .status,
            0);
  const std::string check = "check --signature s.yaml --measurements held.csv ";
  const Outcome healthy = run_tool(folder, check + "--sensor r.yaml");
  EXPECT_EQ(healthy.status, 0) << healthy.out << healthy.err;
  // Ranges computed for air of 10 degrees, measured in air of 20: 1.7 % too short.
  write_file(folder / "cold.yaml", sensor + "calibrated_at_c: 10\n");
  EXPECT_EQ(run_tool(folder, check + "--sensor cold.yaml").status, 1);
  const Outcome without = run_tool(folder, check);
  EXPECT_EQ(without.status, 2);
  EXPECT_NE(without.err.find("--sensor"), std::string::npos) << without.err;
}

// Joints that stood still at the identification turn in these poses, by a program that shares no
// code with armsig.
TEST(Check, blames_no_sensor_for_poses_beyond_what_was_measured) {
  const std::string data = std::string(ARMSIG_SHARED_DATA) + "/";
  if (!std::filesystem::exists(data + "cases/sag")) GTEST_SKIP() << "no measured data: shared data";
  const Folder folder;
  const Outcome found =
      run_tool(folder, "identify --arm " + data + "cases/check/iiwa7.yaml " + "--measurements " +
                           data + "cases/sag/sag.csv " + "--out s.yaml");
  ASSERT_EQ(found.status, 0) << found.err;
  const std::string check =
      "check --signature s.yaml --measurements " + data + "cases/sag/sag_test.csv ";
  const Outcome words = run_tool(folder, check);
  EXPECT_EQ(words.status, 1);
  EXPECT_NE(words.out.find("beyond what was measured"), std::string::npos) << words.out;
  EXPECT_NE(words.out.find("joint 3 reads"), std::string::npos) << words.out;
  EXPECT_EQ(words.out.find("noise"), std::string::npos) << words.out;
  const json result = json::parse(run_tool(folder, check + "--json").out);
  EXPECT_EQ(result["verdict"], "unmeasured-readings");
}

}  // namespace
}  // namespace armsig::cli
