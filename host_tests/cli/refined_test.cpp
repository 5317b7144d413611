// SPDX-License-Identifier: MIT
// `identify --method refined` as a user meets it: everything measured is used, blunders are named,
// and what the rows cannot tell is said.
#include <nlohmann/json.hpp>

#include "host_tests/cli/predictions.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

// Sweeps and mixed poses of a Puma made to the usual tolerances, with one target on its hand.
Csv simulated(const Folder& folder, const std::string& options = "",
              const std::string& arm = kPuma560) {
  write_file(folder / "arm.yaml", arm);
  const Outcome outcome =
      run_tool(folder,
               "simulate --arm arm.yaml --tolerances 1 --hand-target-mm 80,30,120 --arc 90 "
               "--points 20 --mixed-poses 40 --seed 11 --out good.csv --truth-out truth.yaml " +
                   options);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return Csv::read(folder / "good.csv");
}

Outcome refine(const Folder& folder, const Csv& rows, const std::string& options = "") {
  rows.write(folder / "m.csv");
  return run_tool(folder,
                  "identify --arm arm.yaml --measurements m.csv --method refined --out "
                  "s.yaml " +
                      options);
}

void keep_mixed(Csv& csv) {
  std::erase_if(csv.rows, [&](const Fields& row) { return row[csv.column("sweep")] != "0"; });
}

// Largest error of the target's position over the mixed poses of good.csv.
double error_m(const Folder& folder) {
  write_joint_poses(Csv::read(folder / "good.csv"), folder / "q.csv");
  return largest_distance(predict(folder, "s.yaml", "1"), predict(folder, "truth.yaml", "1"));
}

void expect_refused(const Folder& folder, const Outcome& outcome, int status,
                    const std::string& words) {
  EXPECT_EQ(outcome.status, status) << outcome.out;
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "s.yaml"));
}

void expect_said(const Outcome& outcome, const std::string& words) {
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE((outcome.out + outcome.err).find(words), std::string::npos)
      << outcome.out << outcome.err;
}

std::string with_coupled_elbow(double ratio) {
  return std::string(kPuma560) +
         "coupling:\n  - {joint: 3, from: 2, ratio: " + std::to_string(ratio) + "}\n";
}

TEST(Refined, is_exact_on_exact_sweeps_and_poses) {
  const Folder folder;
  const Csv rows = simulated(folder, "--sigma-mm 0");
  ASSERT_EQ(refine(folder, rows).status, 0);
  EXPECT_LT(error_m(folder), 1e-8);
}

TEST(Refined, uses_the_mixed_poses_that_features_do_not) {
  const Folder folder;
  const Csv rows = simulated(folder, "--sigma-mm 0.2");
  ASSERT_EQ(refine(folder, rows).status, 0);
  const double refined = error_m(folder);
  ASSERT_EQ(run_tool(folder, "identify --arm arm.yaml --measurements m.csv --out s.yaml").status,
            0);
  EXPECT_LT(refined, 0.5 * error_m(folder));
}

TEST(Refined, finds_base_and_tool_where_a_file_has_no_sweeps) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.1");
  keep_mixed(rows);
  const Outcome outcome = refine(folder, rows);
  expect_said(outcome, "drawing, base and tool fitted");
  expect_said(outcome, "40 rows: 0 rejected");
  expect_said(outcome, "rows left out of the fit");
  EXPECT_LT(error_m(folder), 5e-4);
}

TEST(Refined, does_without_a_stated_sigma_and_without_some_rows) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.1 --dropouts 0.1");
  keep_mixed(rows);
  for (Fields& row : rows.rows) row[rows.column("sigma_mm")] = "";
  ASSERT_EQ(refine(folder, rows).status, 0);
  EXPECT_LT(error_m(folder), 1e-3);
}

TEST(Refined, takes_radians_and_metres) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0");
  keep_mixed(rows);
  const auto convert = [&](const std::string& from, const std::string& to, double factor) {
    const std::size_t column = rows.column(from);
    rows.header[column] = to;
    for (Fields& row : rows.rows) {
      char text[40];
      std::snprintf(text, sizeof text, "%.17g", factor * std::stod(row[column]));
      row[column] = text;
    }
  };
  for (const char* joint : {"q1", "q2", "q3", "q4", "q5", "q6"}) {
    convert(std::string(joint) + "_deg", std::string(joint) + "_rad", 0.017453292519943295);
  }
  for (const char* axis : {"x", "y", "z"}) {
    convert(std::string(axis) + "_mm", std::string(axis) + "_m", 1e-3);
  }
  ASSERT_EQ(refine(folder, rows).status, 0);
  EXPECT_LT(error_m(folder), 1e-8);
}

TEST(Refined, lists_gross_blunders_by_line_and_does_not_follow_them) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.1");
  keep_mixed(rows);
  for (const std::size_t k : {3U, 4U, 10U, 20U, 21U, 22U, 35U, 38U}) {
    std::string& x = rows.rows[k][rows.column("x_mm")];
    x = std::to_string(std::stod(x) + 40);
  }
  const Outcome outcome = refine(folder, rows);
  // The header is line 1.
  expect_said(outcome, "outliers, by line               5, 6, 12, 22 to 24, 37, 40\n");
  expect_said(outcome, "40 rows: 8 rejected as outliers");
  EXPECT_LT(error_m(folder), 5e-4);
}

TEST(Refined, tells_every_line_to_programs) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.1");
  keep_mixed(rows);
  rows.rows[7][rows.column("z_mm")] = "5000";
  const Outcome outcome = refine(folder, rows, "--json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["refinement"]["rejected_lines"], json::array({9}));
  EXPECT_EQ(result["refinement"]["rows_used"], 39);
  EXPECT_GT(result["cross_validation"]["rms_m"], 0);
}

TEST(Refined, follows_a_coupled_elbow_and_says_which_sweep_is_no_circle) {
  const Folder folder;
  const Csv rows = simulated(folder, "--sigma-mm 0", with_coupled_elbow(-1));
  const Outcome outcome = refine(folder, rows);
  expect_said(outcome, "sweep 2 carries joint 3 along");
  EXPECT_LT(error_m(folder), 1e-7);
}

TEST(Refined, solves_for_the_readings_of_a_coupled_elbow) {
  const Folder folder;
  const Csv rows = simulated(folder, "--sigma-mm 0", with_coupled_elbow(-1));
  ASSERT_EQ(refine(folder, rows).status, 0);
  write_joint_poses(rows, folder / "q.csv");
  const Csv asked = predict(folder, "s.yaml", "1");
  // From nearby readings to the same ones; without them to others inside the limits.
  for (const char* seed : {"--seed q.csv", ""}) {
    const Outcome solved =
        run_tool(folder, std::string("solve --signature s.yaml --poses p.csv --target 1 --out "
                                     "q.csv ") +
                             seed);
    ASSERT_EQ(solved.status, 0) << solved.err;
    EXPECT_LT(largest_distance(predict(folder, "s.yaml", "1"), asked), 1e-8) << seed;
    const Csv found = Csv::read(folder / "q.csv");
    for (std::size_t k = 0; k < found.rows.size(); ++k) {
      EXPECT_LE(found.number(k, "q3_deg"), 225 + 1e-6);
      EXPECT_GE(found.number(k, "q3_deg"), -45 - 1e-6);
    }
  }
}

TEST(Refined, sweeps_of_a_coupled_elbow_are_refused_by_the_features) {
  const Folder folder;
  simulated(folder, "--sigma-mm 0", with_coupled_elbow(-1)).write(folder / "m.csv");
  const Outcome outcome =
      run_tool(folder, "identify --arm arm.yaml --measurements m.csv --out s.yaml");
  expect_refused(folder, outcome, 1, "sweep 2 carries joint 3 along");
  EXPECT_NE(outcome.err.find("--method refined"), std::string::npos) << outcome.err;
}

TEST(Refined, names_a_coupling_that_the_arm_description_lacks) {
  for (const bool with_sweeps : {false, true}) {
    const Folder folder;
    Csv rows = simulated(folder, "--sigma-mm 0.1", with_coupled_elbow(-1));
    write_file(folder / "arm.yaml", kPuma560);
    if (!with_sweeps) keep_mixed(rows);
    const Outcome outcome = refine(folder, rows);
    expect_refused(folder, outcome, 1, "joint 3 seems to follow joint 2");
    EXPECT_NE(outcome.err.find("coupling: [{joint: 3, from: 2"), std::string::npos) << outcome.err;
  }
}

TEST(Refined, names_a_joint_whose_reading_has_the_wrong_sign) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.1");
  keep_mixed(rows);
  for (Fields& row : rows.rows) {
    std::string& q = row[rows.column("q4_deg")];
    q = q.starts_with('-') ? q.substr(1) : "-" + q;
  }
  expect_refused(folder, refine(folder, rows), 1, "joint 4 seems to turn against");
}

// The readings of joint 2 as an encoder gives them that counts 0.3 % too little.
void shrink_reading(Csv& rows) {
  for (Fields& row : rows.rows) {
    char text[40];
    std::string& q = row[rows.column("q2_deg")];
    std::snprintf(text, sizeof text, "%.17g", std::stod(q) / 1.003);
    q = text;
  }
}

TEST(Refined, finds_stores_and_applies_corrections_of_the_readings) {
  const Folder folder;
  const Csv good = simulated(folder, "--sigma-mm 0");
  write_joint_poses(good, folder / "q.csv");
  const Csv truth = predict(folder, "truth.yaml", "1");
  Csv rows = good;
  keep_mixed(rows);
  shrink_reading(rows);
  const Outcome outcome = refine(folder, rows, "--correct gain,second-order --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json corrections = json::parse(outcome.out)["refinement"]["reading_corrections"];
  EXPECT_NEAR(corrections[1]["gain"], 0.003, 1e-6);
  EXPECT_NE(read_file(folder / "s.yaml").find("reading_correction: {gain: "), std::string::npos);
  // Predictions are asked for in the encoder's readings, and come out true; so do solutions.
  write_joint_poses(rows, folder / "q.csv");
  EXPECT_LT(largest_distance(predict(folder, "s.yaml", "1"), truth), 1e-6);
  EXPECT_EQ(run_tool(folder, "check --signature s.yaml --measurements m.csv").status, 0);
  EXPECT_EQ(
      run_tool(folder, "suggest --signature s.yaml --count 2 --sigma-mm 0.2 --out n.csv").status,
      0);
  const Outcome exported =
      run_tool(folder, "export --signature s.yaml --format urdf --out arm.urdf");
  EXPECT_EQ(exported.status, 1);
  EXPECT_NE(exported.err.find("its joint readings are corrected"), std::string::npos);
  Csv first = Csv::read(folder / "q.csv");
  first.rows.resize(1);
  first.write(folder / "q.csv");
  predict(folder, "s.yaml", "1");
  const Outcome solved = run_tool(
      folder, "solve --signature s.yaml --poses p.csv --seed q.csv --target 1 --out back.csv");
  ASSERT_EQ(solved.status, 0) << solved.err;
  EXPECT_NEAR(Csv::read(folder / "back.csv").number(0, "q2_deg"), first.number(0, "q2_deg"), 1e-6);
}

TEST(Refined, chooses_the_corrections_that_help) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.05");
  keep_mixed(rows);
  const Outcome plain = refine(folder, rows, "--correct readings-that-help --json");
  ASSERT_EQ(plain.status, 0) << plain.err;
  EXPECT_FALSE(json::parse(plain.out)["refinement"].contains("reading_corrections"));
  EXPECT_FALSE(json::parse(plain.out)["refinement"].contains("corrections_offered"));
  shrink_reading(rows);
  expect_said(refine(folder, rows), "with corrections of the joint readings");
  const Outcome corrected = refine(folder, rows, "--correct readings-that-help --json");
  ASSERT_EQ(corrected.status, 0) << corrected.err;
  EXPECT_TRUE(json::parse(corrected.out)["refinement"].contains("reading_corrections"));
}

TEST(Refined, refuses_a_scale_from_angles_alone) {
  const Folder folder;
  const Csv rows = simulated(folder, "--sigma-mm 0.1");
  expect_refused(folder, refine(folder, rows, "--correct scale"), 1, "angles alone");
}

TEST(Refined, refuses_a_correction_that_the_rows_do_not_tell_and_names_the_joint) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.1");
  keep_mixed(rows);
  for (Fields& row : rows.rows) row[rows.column("q6_deg")] = "10";
  // The target is where a resting last joint had it.
  Csv joints = rows;
  write_joint_poses(joints, folder / "q.csv");
  const Csv truth = predict(folder, "truth.yaml", "1");
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    for (const char* axis : {"x", "y", "z"}) {
      rows.rows[k][rows.column(std::string(axis) + "_mm")] =
          std::to_string(1e3 * truth.number(k, std::string(axis) + "_m"));
    }
  }
  expect_refused(folder, refine(folder, rows, "--correct gain"), 1,
                 "joint 6: the gain of its reading is not determined");
}

TEST(Refined, refuses_corrections_by_another_method_or_of_what_is_not_there) {
  const Folder folder;
  simulated(folder).write(folder / "m.csv");
  const std::string identify = "identify --arm arm.yaml --measurements m.csv --out s.yaml ";
  expect_refused(folder, run_tool(folder, identify + "--correct gain"), 2, "--method refined");
  expect_refused(folder, run_tool(folder, identify + "--method refined --correct range-offsets"), 2,
                 "receivers");
  EXPECT_NE(run_tool(folder, identify + "--method refined --correct gian").status, 0);
}

TEST(Refined, names_what_is_missing) {
  const Folder folder;
  const Csv good = simulated(folder, "--sigma-mm 0.1");
  Csv few = good;
  keep_mixed(few);
  few.rows.resize(8);
  expect_refused(folder, refine(folder, few), 1, "24 measured numbers, and the unknowns need 27");

  // As many numbers as unknowns, and nothing left to tell the noise by.
  Csv bare = good;
  keep_mixed(bare);
  bare.rows.resize(9);
  for (Fields& row : bare.rows) row[bare.column("sigma_mm")] = "";
  expect_refused(folder, refine(folder, bare), 1, "27 measured numbers, and the unknowns need 30");

  Csv equal = good;
  keep_mixed(equal);
  for (Fields& row : equal.rows) row = equal.rows.front();
  expect_refused(folder, refine(folder, equal), 1, "all poses are equal");

  Csv stuck = good;
  keep_mixed(stuck);
  for (Fields& row : stuck.rows) {
    for (const char* axis : {"x_mm", "y_mm", "z_mm"}) row[stuck.column(axis)] = "100";
  }
  expect_refused(folder, refine(folder, stuck), 1, "at the same place");
}

TEST(Refined, refuses_rows_that_contradict_each_other) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.1");
  keep_mixed(rows);
  // Positions of other poses: every second row is another's.
  for (std::size_t k = 0; k + 3 < rows.rows.size(); k += 2) {
    for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
      rows.rows[k][rows.column(axis)] = rows.rows[k + 3][rows.column(axis)];
    }
  }
  const Outcome outcome = refine(folder, rows);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "s.yaml"));
}

TEST(Refined, refuses_mixed_poses_that_contradict_the_sweeps) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.1");
  for (Fields& row : rows.rows) {
    if (row[rows.column("sweep")] != "0") continue;
    std::string& x = row[rows.column("x_mm")];
    x = std::to_string(std::stod(x) + 500);
  }
  expect_refused(folder, refine(folder, rows), 1, "contradict the sweeps");
}

TEST(Refined, says_which_axis_its_target_does_not_tell) {
  const Folder folder;
  write_file(folder / "arm.yaml", kPuma560);
  const Outcome simulated_on_axis =
      run_tool(folder,
               "simulate --arm arm.yaml --tolerances 0.1 --hand-target-mm 0,0,150 --sigma-mm 0.1 "
               "--mixed-poses 60 --out good.csv --truth-out truth.yaml");
  ASSERT_EQ(simulated_on_axis.status, 0) << simulated_on_axis.err;
  Csv rows = Csv::read(folder / "good.csv");
  keep_mixed(rows);
  expect_said(refine(folder, rows),
              "joint 6: rotation about its own axis is not determined by this target");
}

TEST(Identify, reports_a_cross_validated_figure_by_every_method) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.2");
  rows.write(folder / "m.csv");
  const auto figures = [&](const std::string& method) {
    const Outcome outcome =
        run_tool(folder,
                 "identify --arm arm.yaml --measurements m.csv --json --out s.yaml "
                 "--method " +
                     method);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const json result = json::parse(outcome.out);
    EXPECT_GT(result["predicted_tool_error_m"], 0);
    EXPECT_EQ(result["cross_validation"]["rows"], 40) << method;
    return result["cross_validation"]["rms_m"].get<double>();
  };
  const double refined = figures("refined");
  const double encoder = figures("encoder");
  EXPECT_LT(refined, encoder);
  EXPECT_LT(encoder, figures("paper"));

  // Without mixed poses, rows of the sweeps are left out: what noise of 0.2 mm leaves.
  std::erase_if(rows.rows, [&](const Fields& row) { return row[rows.column("sweep")] == "0"; });
  rows.write(folder / "m.csv");
  for (const char* method : {"encoder", "paper", "refined"}) {
    const Outcome outcome = run_tool(
        folder, std::string("identify --arm arm.yaml --measurements m.csv --json --out s.yaml "
                            "--method ") +
                    method);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json score = json::parse(outcome.out)["cross_validation"];
    EXPECT_GE(score["rows"], 110) << method;
    EXPECT_GT(score["rms_m"], 2.5e-4) << method;
    EXPECT_LT(score["rms_m"], 2e-3) << method;
  }
}

}  // namespace
}  // namespace armsig::cli
