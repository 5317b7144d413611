// SPDX-License-Identifier: MIT
// Methods by features do not use poses of any joint; what such poses show of their error is stated.
#include <cmath>

#include <nlohmann/json.hpp>

#include "host_tests/cli/predictions.hpp"

namespace armsig::cli {
namespace {

constexpr double kTurn_rad = 0.3 * 0.017453292519943295;
constexpr const char* kWarning = "poses that this method does not use are missed";

Csv measured(const Folder& folder) {
  write_file(folder / "arm.yaml", kPuma560);
  const Outcome outcome = run_tool(
      folder,
      "simulate --arm arm.yaml --tolerances 1 --arc 120 --points 20 --free-poses 40 --sigma-mm "
      "0.1 --seed 7 --out m.csv --truth-out truth.yaml");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return Csv::read(folder / "m.csv");
}

// The tracker stood a little turned from the 30th to the 50th hundredth of the file.
Csv with_a_turned_tracker(Csv rows) {
  for (std::size_t k = 3 * rows.rows.size() / 10; k < rows.rows.size() / 2; ++k) {
    const double x = rows.number(k, "x_mm");
    const double y = rows.number(k, "y_mm");
    rows.rows[k][rows.column("x_mm")] =
        std::to_string(x * std::cos(kTurn_rad) - y * std::sin(kTurn_rad));
    rows.rows[k][rows.column("y_mm")] =
        std::to_string(x * std::sin(kTurn_rad) + y * std::cos(kTurn_rad));
  }
  return rows;
}

// Observed over stated tool error, at the poses of the file; and what was said.
struct Judged {
  double ratio = 0;
  std::string err;
};

Judged judge(const Folder& folder, const Csv& rows) {
  rows.write(folder / "m.csv");
  const Outcome outcome = run_tool(
      folder, "identify --arm arm.yaml --measurements m.csv --method encoder --out s.yaml --json");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  if (outcome.status != 0) return {};
  const double stated_m =
      nlohmann::json::parse(outcome.out)["predicted_tool_error_m"].get<double>();
  write_joint_poses(rows, folder / "q.csv");
  const double observed_m =
      rms_distance(predict(folder, "s.yaml", "6"), predict(folder, "truth.yaml", "6"));
  return {observed_m / stated_m, outcome.err};
}

TEST(UnusedPoses, say_nothing_against_a_sound_file) {
  const Folder folder;
  const Judged sound = judge(folder, measured(folder));
  EXPECT_GT(sound.ratio, 0.7);
  EXPECT_LT(sound.ratio, 1.4);
  EXPECT_EQ(sound.err.find(kWarning), std::string::npos) << sound.err;
}

TEST(UnusedPoses, enlarge_what_is_stated_where_the_sweeps_hide_an_error) {
  const Folder folder;
  const Judged turned = judge(folder, with_a_turned_tracker(measured(folder)));
  EXPECT_GT(turned.ratio, 0.7);
  EXPECT_LT(turned.ratio, 1.4);  // 3.3 by the features alone
  EXPECT_NE(turned.err.find(kWarning), std::string::npos) << turned.err;
}

}  // namespace
}  // namespace armsig::cli
