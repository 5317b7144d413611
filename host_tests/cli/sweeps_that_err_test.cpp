// SPDX-License-Identifier: MIT
// Sweeps of an arm whose encoders, gears or clamps err: what is stated holds where nothing was
// measured.
#include <cmath>
#include <functional>

#include "host_tests/cli/predictions.hpp"

namespace armsig::cli {
namespace {

constexpr const char* kSimulate =
    "simulate --arm arm.yaml --flange-target-mm 120,50,180 --points 25 --arc 120 ";

// Sweeps in m.csv, poses anywhere in held.csv, the arm in truth.yaml.
Csv sweeps_of_a_puma(const Folder& folder, const std::string& options) {
  write_file(folder / "arm.yaml", kPuma560);
  for (const std::string rest : {"--tolerances 1 --truth-out truth.yaml --out m.csv",
                                 "--truth truth.yaml --free-poses 100 --out held.csv"}) {
    const Outcome outcome = run_tool(folder, kSimulate + options + rest);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }
  return Csv::read(folder / "m.csv");
}

void change(Csv& rows, const std::string& name,
            const std::function<double(double reading, std::size_t row)>& to) {
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    rows.rows[k][rows.column(name)] = std::to_string(to(rows.number(k, name), k));
  }
}

struct JudgedSweeps {
  double observed_m = 0;
  double stated_m = 0;  // over all that the joint limits allow
  std::string err;
};

// `as_read`: what was done to the readings of the sweeps, for the poses to predict.
JudgedSweeps judge(
    const Folder& folder, const Csv& rows, const std::string& method,
    const std::function<void(Csv& poses)>& as_read = [](Csv&) {}) {
  const auto [result, err] = identified_rows(folder, rows, method);
  if (result.is_null()) return {};
  Csv held = Csv::read(folder / "held.csv");
  write_joint_poses(held, folder / "q.csv");
  const Csv truth = predict(folder, "truth.yaml", "1");
  as_read(held);
  write_joint_poses(held, folder / "q.csv");
  return {rms_distance(predict(folder, "s.yaml", "1"), truth),
          result.value("predicted_over_limits_m", result["predicted_tool_error_m"].get<double>()),
          err};
}

TEST(SweepsThatErr, are_no_reason_to_refuse_an_arm_that_a_fine_sensor_sees) {
  const Folder folder;
  const Csv rows = sweeps_of_a_puma(folder, "--maps-deg 0.04 --sigma-mm 0.01 --seed 6 ");
  for (const std::string method : {"paper", "encoder"}) {
    const JudgedSweeps found = judge(folder, rows, method);
    EXPECT_GT(found.observed_m, 0.1e-3) << method;
    EXPECT_LT(found.observed_m, 1.25 * found.stated_m) << method;
    EXPECT_GT(found.observed_m, 0.25 * found.stated_m) << method;
  }
}

// A joint error maps explains the rows as well, and says nothing of readings beyond them.
TEST(SweepsThatErr, by_a_gear_are_told_from_those_that_err_by_waves) {
  const Folder folder;
  Csv rows = sweeps_of_a_puma(folder, "--sigma-mm 0.05 --seed 6 ");
  const JudgedSweeps sound = judge(folder, rows, "refined");
  EXPECT_EQ(sound.err.find("gear"), std::string::npos) << sound.err;
  const auto by_gear = [](Csv& poses) {
    change(poses, "q1_deg", [](double q, std::size_t) { return 1.0015 * q; });
  };
  by_gear(rows);
  const JudgedSweeps geared = judge(folder, rows, "refined", by_gear);
  EXPECT_NE(geared.err.find("joint 1: its reading is 1.001"), std::string::npos) << geared.err;
  EXPECT_LT(geared.observed_m, 1.25 * geared.stated_m);
  EXPECT_LT(geared.stated_m, 2 * sound.stated_m);
}

// The fit of the refinement does not need it, the noise hides it: it may be there all the same.
TEST(SweepsThatErr, by_a_gear_that_no_fit_finds_are_stated) {
  const Folder folder;
  Csv rows = sweeps_of_a_puma(folder, "--sigma-mm 0.02 --seed 2 ");
  const auto by_gear = [](Csv& poses) {
    change(poses, "q4_deg", [](double q, std::size_t) { return 1.001 * q; });
  };
  by_gear(rows);
  const JudgedSweeps geared = judge(folder, rows, "refined", by_gear);
  EXPECT_EQ(geared.err.find("its reading is"), std::string::npos) << geared.err;
  EXPECT_NE(geared.err.find("deflects or a gear ratio is off"), std::string::npos) << geared.err;
  EXPECT_LT(geared.observed_m, 1.25 * geared.stated_m);
}

// Upright, the target goes round the base's axis on a small circle.
TEST(SweepsThatErr, name_the_gear_that_they_tell_worst) {
  const Folder folder;
  const std::string upright =
      "simulate --arm ur5 --configuration 0,-90,0,-90,90,0 --flange-target-mm -70,20,-170 "
      "--sigma-mm "
      "0.05 --out m.csv --truth-out truth.yaml";
  const std::string identify = "identify --arm ur5 --measurements m.csv --out s.yaml --method ";
  for (const std::string mixed : {" --free-poses 0", " --free-poses 40"}) {
    const Outcome made = run_tool(folder, upright + mixed);
    ASSERT_EQ(made.status, 0) << made.err;
    const auto result = nlohmann::json::parse(run_tool(folder, identify + "refined --json").out);
    const bool named = mixed == " --free-poses 0";
    ASSERT_EQ(result.contains("least_seen_gear"), named) << result;
    const std::string text = run_tool(folder, identify + "refined").out;
    EXPECT_EQ(text.find("the gear ratio of joint 1, which is taken as exact") != std::string::npos,
              named)
        << text;
    if (!named) continue;
    const auto& gear = result["least_seen_gear"];
    EXPECT_EQ(gear["joint"], 1);
    EXPECT_GT(gear["moved_m"], 0.5 * result["predicted_tool_error_m"].get<double>());
    // 1.8 rad, RMS over a turn, at 0.41 m from the axis: 0.425 and 0.392 m, each with any cosine.
    EXPECT_NEAR(gear["moved_m"].get<double>() / gear["sigma"].get<double>(), 0.75, 0.1);
  }
}

// Too little to refuse, and more than the rows' own noise states.
TEST(SweepsThatErr, by_a_slip_are_named_and_stated) {
  const Folder folder;
  Csv rows = sweeps_of_a_puma(folder, "--sigma-mm 0.05 --seed 6 ");
  const JudgedSweeps sound = judge(folder, rows, "refined");
  change(rows, "q5_deg", [&](double q, std::size_t k) { return k < 75 ? q : q - 0.06; });
  const JudgedSweeps slipped = judge(folder, rows, "refined", [](Csv& poses) {
    change(poses, "q5_deg", [](double q, std::size_t) { return q - 0.06; });
  });
  EXPECT_NE(slipped.err.find("the reading of joint 5 is off by -0.0"), std::string::npos)
      << slipped.err;
  EXPECT_NE(slipped.err.find("if so the tool is off by"), std::string::npos) << slipped.err;
  EXPECT_GT(slipped.observed_m, 1.5 * sound.stated_m);
  EXPECT_LT(slipped.observed_m, 1.25 * slipped.stated_m);
}

}  // namespace
}  // namespace armsig::cli
