// SPDX-License-Identifier: MIT
// `identify --method refined` as a user meets it: everything measured is used, blunders are named,
// and what the rows cannot tell is said.
#include <nlohmann/json.hpp>

#include "host_tests/cli/predictions.hpp"
#include "host_tests/cli/refined_arm.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

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
  ASSERT_EQ(
      run_tool(folder, "identify --arm arm.yaml --measurements m.csv --method encoder --out s.yaml")
          .status,
      0);
  EXPECT_LT(refined, 0.5 * error_m(folder));
}

TEST(Refined, finds_base_and_tool_where_a_file_has_no_sweeps) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.1");
  keep_mixed(rows);
  const Outcome outcome = refine(folder, rows);
  expect_said(outcome, "nominal, base and tool fitted");
  expect_said(outcome, "40 rows: 0 rejected");
  expect_said(outcome, "validation rows");
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

void shift_along_x(Csv& rows, std::size_t row) {
  std::string& x = rows.rows[row][rows.column("x_mm")];
  x = std::to_string(std::stod(x) + 40);
}

TEST(Refined, lists_gross_blunders_by_line_and_does_not_follow_them) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.1");
  keep_mixed(rows);
  for (const std::size_t k : {3U, 10U, 35U}) shift_along_x(rows, k);
  const Outcome outcome = refine(folder, rows);
  // The header is line 1.
  expect_said(outcome, "outliers, by line               5, 12, 37\n");
  expect_said(outcome, "40 rows: 3 rejected as outliers (3 of the 40 free poses)");
  EXPECT_LT(error_m(folder), 5e-4);
}

TEST(Refined, takes_many_blunders_for_what_the_model_does_not_know) {
  const Folder folder;
  Csv rows = simulated(folder, "--sigma-mm 0.1");
  keep_mixed(rows);
  for (const std::size_t k : {3U, 4U, 10U, 20U, 21U, 22U, 35U, 38U}) shift_along_x(rows, k);
  expect_refused(folder, refine(folder, rows), 1,
                 "8 of the 40 free poses (20 %) would be thrown out as outliers");
  const Outcome outcome = refine(folder, rows, "--accept-different-arm");
  expect_said(outcome, "outliers, by line               5, 6, 12, 22 to 24, 37, 40\n");
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
  const double x_mm = equal.number(0, "x_mm");
  for (std::size_t k = 0; k < equal.rows.size(); ++k) {
    equal.rows[k] = equal.rows.front();
    equal.rows[k][equal.column("x_mm")] = std::to_string(x_mm + 0.001 * static_cast<double>(k));
  }
  expect_refused(folder, refine(folder, equal), 1, "all poses are equal");

  Csv copied = good;
  keep_mixed(copied);
  for (Fields& row : copied.rows) row = copied.rows.front();
  const std::string copies = std::to_string(copied.rows.size() - 1);
  expect_refused(folder, refine(folder, copied), 1,
                 "; " + copies + " rows are copies of others, and count once");

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
               "simulate --arm arm.yaml --tolerances 0.1 --flange-target-mm 0,0,150 --sigma-mm 0.1 "
               "--free-poses 60 --out good.csv --truth-out truth.yaml");
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

// Joints held to 0.04 degrees either way, farther apart than a held joint is for features: the fit
// goes by what was read.
TEST(Refined, takes_sweeps_whose_held_joints_wander) {
  const Folder folder;
  ASSERT_EQ(run_tool(folder,
                     "simulate --arm puma560 --tolerances 1 --flange-target-mm 80,30,120 "
                     "--sigma-mm 0.05 --seed 3 --out m.csv --truth-out truth.yaml")
                .status,
            0);
  Csv rows = Csv::read(folder / "m.csv");
  const auto name = [](std::size_t joint) { return "q" + std::to_string(joint) + "_deg"; };
  std::string poses = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg";
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    for (std::size_t j = 1; j <= 6; ++j) {
      std::string& reading = rows.rows[k][rows.column(name(j))];
      const bool swept = rows.rows[k][rows.column("sweep")] == std::to_string(j);
      const auto phase = static_cast<double>(7 * k + 3 * j);
      reading = std::to_string(std::stod(reading) + (swept ? 0 : 0.04) * std::sin(phase));
      poses += (j == 1 ? "\n" : ",") + reading;
    }
  }
  write_file(folder / "q.csv", poses + "\n");
  const Csv true_points = predict(folder, "truth.yaml", "1");
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    for (const char* axis : {"x", "y", "z"}) {
      const double noise_mm = 0.07 * std::sin(11 * static_cast<double>(k) + axis[0]);
      rows.rows[k][rows.column(std::string(axis) + "_mm")] =
          std::to_string(1e3 * true_points.number(k, std::string(axis) + "_m") + noise_mm);
    }
  }
  rows.write(folder / "m.csv");
  const Outcome outcome = run_tool(
      folder, "identify --arm puma560 --measurements m.csv --method refined --out s.yaml --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const double stated_m =
      nlohmann::json::parse(outcome.out)["predicted_tool_error_m"].get<double>();
  EXPECT_LT(stated_m, 1e-3);
  EXPECT_LT(rms_distance(predict(folder, "s.yaml", "1"), true_points), 1.5 * stated_m);
}

}  // namespace
}  // namespace armsig::cli
