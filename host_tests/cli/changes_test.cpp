// SPDX-License-Identifier: MIT
// What changes while an arm is measured is named, with the row from which on: of poses in the order
// in which they were measured.
#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <optional>

#include "host_tests/cli/refined_arm.hpp"

namespace armsig::cli {
namespace {

constexpr std::size_t kMeasured = 80;

// Poses of a Puma whose target is at `target`, always the same ones with the same noise.
Csv poses(const Folder& folder, const std::string& target = "80,30,120",
          const std::string& options = "") {
  write_file(folder / "arm.yaml", kPuma560);
  const Outcome outcome = run_tool(
      folder,
      "simulate --arm arm.yaml --tolerances 1 --sigma-mm 0.05 --points 2 --arc 30 --seed 5 "
      "--free-poses 80 --out poses.csv --flange-target-mm " +
          target + " " + options);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  Csv rows = Csv::read(folder / "poses.csv");
  keep_mixed(rows);
  EXPECT_EQ(rows.rows.size(), kMeasured);
  return rows;
}

// Every row's number in `column`, changed by how far along the file it is, from 0 to 1.
void change(Csv& rows, const std::string& column,
            const std::function<double(double value, double share)>& to) {
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    std::string& text = rows.rows[k][rows.column(column)];
    const double share = static_cast<double>(k) / static_cast<double>(rows.rows.size() - 1);
    char changed[40];
    std::snprintf(changed, sizeof changed, "%.17g", to(std::stod(text), share));
    text = changed;
  }
}

void expect_said(const Outcome& outcome, int status, const std::string& words) {
  EXPECT_EQ(outcome.status, status) << outcome.out;
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
}

TEST(Changes, are_not_seen_where_nothing_changed) {
  const Folder folder;
  const Outcome outcome = refine(folder, poses(folder));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("changed"), std::string::npos) << outcome.err;
}

TEST(Changes, of_the_place_of_the_sensor_are_told_as_a_drift) {
  const Folder folder;
  Csv rows = poses(folder);
  change(rows, "x_mm", [](double x, double share) { return x + 0.35 * share; });
  const Outcome small = refine(folder, rows);
  expect_said(small, 0, "the positions drift by 0.3");
  EXPECT_NE(small.err.find("part of the predicted tool error"), std::string::npos) << small.err;
  change(rows, "x_mm", [](double x, double share) { return x + 0.7 * share; });
  expect_said(refine(folder, rows), 1, "the positions drift by 1");
}

TEST(Changes, of_an_encoder_are_told_by_joint_row_and_size) {
  const Folder folder;
  Csv rows = poses(folder);
  change(rows, "q2_deg", [](double q, double share) { return share < 0.5 ? q : q + 0.1; });
  expect_said(refine(folder, rows), 1, "from line 42 on the reading of joint 2 is off by +0.1");
}

TEST(Changes, of_a_gear_are_told_by_joint_row_and_ratio) {
  const Folder folder;
  Csv rows = poses(folder);
  change(rows, "q3_deg", [](double q, double share) { return share < 0.5 ? q : q / 1.004; });
  expect_said(refine(folder, rows), 1,
              "from line 42 on joint 3 turns 1.0040 times as far for the same reading");
}

TEST(Changes, of_the_load_are_told_by_row_and_size) {
  const Folder folder;
  const Csv before = poses(folder, "80,30,120", "--deflection-mm 1");
  Csv after = poses(folder, "80,30,120", "--deflection-mm 4");
  std::copy_n(before.rows.begin(), kMeasured / 2, after.rows.begin());
  const Outcome outcome = refine(folder, after);
  EXPECT_NE(outcome.err.find("the arm bends otherwise, by "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("carries the same load"), std::string::npos) << outcome.err;
}

TEST(Changes, of_a_target_that_slips_are_told_by_row_and_size) {
  const Folder folder;
  const Csv before = poses(folder);
  Csv after = poses(folder, "80.4,30,120");
  std::copy_n(before.rows.begin(), kMeasured / 2, after.rows.begin());
  expect_said(refine(folder, after), 1, "from line 42 on target 1 is another point, 0.4");
  after = poses(folder, "81,30,120");
  std::copy_n(before.rows.begin(), kMeasured / 2, after.rows.begin());
  expect_said(refine(folder, after), 1, "line 42 on the target is another point");
}

TEST(Changes, of_place_and_target_at_once_are_both_told) {
  const Folder folder;
  const Csv before = poses(folder);
  Csv after = poses(folder, "81,30,120");
  std::copy_n(before.rows.begin(), kMeasured / 2, after.rows.begin());
  change(after, "y_mm", [](double y, double share) { return share < 0.5 ? y : y + 0.9; });
  const Outcome outcome = refine(folder, after);
  expect_said(outcome, 1, "from line 42 on the positions are shifted by 0.");
  expect_said(outcome, 1, ", and target 1 is another point, 1");
}

// As after a collision.
TEST(Changes, of_several_zeros_are_told_by_joint_and_size) {
  const Folder folder;
  Csv rows = poses(folder);
  const std::map<std::string, double> off_deg{{"q2_deg", 0.1}, {"q3_deg", -0.15}, {"q5_deg", 0.2}};
  for (const auto& [reading, off] : off_deg) {
    change(rows, reading, [&](double q, double share) { return share < 0.5 ? q : q + off; });
  }
  const Outcome outcome = refine(folder, rows);
  expect_said(outcome, 1, "from line 42 on several readings are off: joint 2 by +0.");
  expect_said(outcome, 1, ", joint 3 by -0.1");
  expect_said(outcome, 1, ", joint 5 by +0.");
  EXPECT_EQ(outcome.err.find("joint 1 by"), std::string::npos) << outcome.err;
}

// A pedestal that is turned by the weight that it carries is no fault of the sensor's axes.
TEST(Changes, are_not_told_where_the_base_leans_under_the_arm) {
  const Folder folder;
  Csv rows = poses(folder);
  const std::array<const char*, 3> axes{"x_mm", "y_mm", "z_mm"};
  constexpr double kLean_rad_per_mm = 4e-7;
  constexpr double kFoot_mm = 672;  // below the base, which is at the shoulder
  for (Fields& row : rows.rows) {
    std::array<double, 3> r{-50, 30, 1200 + kFoot_mm};  // from the foot to the point
    for (std::size_t i = 0; i < 3; ++i) r[i] += std::stod(row[rows.column(axes[i])]);
    const std::array<double, 3> leant{r[0] * r[2], r[1] * r[2], -r[0] * r[0] - r[1] * r[1]};
    for (std::size_t i = 0; i < 3; ++i) {
      std::string& text = row[rows.column(axes[i])];
      text = std::to_string(std::stod(text) + kLean_rad_per_mm * leant[i]);
    }
  }
  const Outcome outcome = refine(folder, rows);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("scale"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("changed"), std::string::npos) << outcome.err;
}

TEST(Changes, of_all_lengths_are_told_as_growth) {
  const Folder folder;
  Csv rows = poses(folder);
  const std::map<std::string, double> base_mm{{"x_mm", 50}, {"y_mm", -30}, {"z_mm", -1200}};
  for (const auto& [axis, at] : base_mm) {
    change(rows, axis,
           [&](double x, double share) { return at + (x - at) * (1 + 600e-6 * share); });
  }
  expect_said(refine(folder, rows), 0, "all lengths grow by 6");
}

TEST(Changes, of_all_that_the_sensor_sees_are_told_from_an_arm_that_grows) {
  const Folder folder;
  Csv rows = poses(folder);
  for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
    change(rows, axis, [](double x, double share) { return x * (1 + 600e-6 * share); });
  }
  const Outcome outcome = refine(folder, rows);
  EXPECT_NE(outcome.err.find("all lengths that the sensor sees grow by "), std::string::npos)
      << outcome.err;
}

// Each joint read otherwise than it was: `read` of where it is, where it was in the row before and
// what was read of it there.
void read_late(Csv& rows,
               const std::function<double(double there, double before, double read)>& read) {
  for (const char* reading : {"q1_deg", "q2_deg", "q3_deg", "q4_deg", "q5_deg", "q6_deg"}) {
    std::optional<double> before;
    double as_read = 0;
    change(rows, reading, [&](double there, double) {
      as_read = before ? read(there, *before, as_read) : there;
      before = there;
      return as_read;
    });
  }
}

// No change either: each position was taken when 0.4 % of the way from the row before were left.
TEST(Changes, are_told_from_positions_that_lag_the_readings) {
  const Folder folder;
  Csv rows = poses(folder);
  constexpr double kLeft = 0.004;
  read_late(rows, [](double there, double /*before*/, double read) {
    return (there - kLeft * read) / (1 - kLeft);
  });
  const Outcome outcome = refine(folder, rows);
  EXPECT_NE(outcome.err.find("the positions lag the joint readings: by 0."), std::string::npos)
      << outcome.err;
}

TEST(Changes, are_told_from_positions_that_are_late_by_one_time) {
  const Folder folder;
  Csv rows = poses(folder);
  read_late(rows, [](double there, double before, double /*read*/) {
    return there + std::copysign(0.1, there - before);
  });
  const Outcome outcome = refine(folder, rows);
  EXPECT_NE(outcome.err.find("of backlash, by the order of the rows"), std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("positions that are late behind the joint readings look the same"),
            std::string::npos)
      << outcome.err;
}

// No change: the sensor sees one direction too long from the first row to the last.
TEST(Changes, are_told_from_axes_of_the_sensor_that_are_not_of_one_scale) {
  const Folder folder;
  Csv rows = poses(folder);
  change(rows, "x_mm", [](double x, double) { return 1.0002 * x; });
  const Outcome small = refine(folder, rows);
  EXPECT_EQ(small.status, 0) << small.err;
  change(rows, "x_mm", [](double x, double) { return 1.002 * x; });
  expect_said(refine(folder, rows), 1, "the sensor's axes are not of one scale: lengths along (");
  expect_said(refine(folder, rows), 1, " ppm longer than along (");
}

// The hand's weight is on the other side of joint 2's play where joint 5 is turned the other way.
TEST(Changes, are_not_told_from_rows_in_the_order_of_a_joint) {
  const Folder folder;
  Csv rows = poses(folder);
  const std::size_t hand = rows.column("q5_deg");
  std::ranges::sort(rows.rows, {}, [&](const Fields& row) { return std::stod(row[hand]); });
  const auto turned =
      std::ranges::find_if(rows.rows, [&](const Fields& row) { return std::stod(row[hand]) >= 0; });
  const double from = static_cast<double>(turned - rows.rows.begin()) - 0.5;
  change(rows, "q2_deg", [&](double q, double share) {
    return share * static_cast<double>(kMeasured - 1) < from ? q : q + 0.05;
  });
  const Outcome outcome = refine(folder, rows);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("something changed"), std::string::npos) << outcome.err;
}

TEST(Changes, are_passed_over_where_the_arm_is_taken_as_it_is) {
  const Folder folder;
  Csv rows = poses(folder);
  change(rows, "q2_deg", [](double q, double share) { return share < 0.5 ? q : q + 0.1; });
  const Outcome outcome = refine(folder, rows, "--accept-different-arm");
  expect_said(outcome, 0, "the reading of joint 2 is off by");
}

}  // namespace
}  // namespace armsig::cli
