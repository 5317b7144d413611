// SPDX-License-Identifier: MIT
// Rows of a file that are not like the others are named by their lines, with what is wrong in them;
// so is a cause that no row tells from another one.
#include <string>

#include "host_tests/cli/refined_arm.hpp"

namespace armsig::cli {
namespace {

constexpr std::size_t kRowsOfFile = 120;
constexpr std::size_t kFirstBroken = 60;  // at line 62

// Poses of an arm, always the same ones.
Csv measured_poses(const Folder& folder, const std::string& arm = kPuma560,
                   std::size_t count = kRowsOfFile) {
  write_file(folder / "arm.yaml", arm);
  const Outcome outcome = run_tool(
      folder,
      "simulate --arm arm.yaml --tolerances 1 --sigma-mm 0.05 --points 2 --arc 30 --seed 5 "
      "--out poses.csv --flange-target-mm 80,30,120 --free-poses " +
          std::to_string(count));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  Csv rows = Csv::read(folder / "poses.csv");
  keep_mixed(rows);
  EXPECT_EQ(rows.rows.size(), count);
  return rows;
}

void set(Csv& rows, std::size_t row, const std::string& column, double value) {
  rows.rows[row][rows.column(column)] = std::to_string(value);
}

void expect_refused_for(const Folder& folder, const Csv& rows, const std::string& words) {
  const Outcome outcome = refine(folder, rows);
  EXPECT_EQ(outcome.status, 1) << outcome.out;
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("not of one scale"), std::string::npos) << outcome.err;
}

TEST(BrokenRows, in_which_the_sensor_repeats_a_position_are_named) {
  const Folder folder;
  Csv rows = measured_poses(folder);
  for (std::size_t k = kFirstBroken + 1; k < kFirstBroken + 18; ++k) {
    for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
      rows.rows[k][rows.column(axis)] = rows.rows[kFirstBroken][rows.column(axis)];
    }
  }
  expect_refused_for(folder, rows,
                     "lines 62 to 79 have one position to the last digit while the joints move");
}

TEST(BrokenRows, in_which_a_reading_stands_still_are_named_by_joint) {
  const Folder folder;
  Csv rows = measured_poses(folder);
  for (std::size_t k = kFirstBroken + 1; k < kFirstBroken + 24; ++k) {
    rows.rows[k][rows.column("q2_deg")] = rows.rows[kFirstBroken][rows.column("q2_deg")];
  }
  expect_refused_for(folder, rows,
                     "lines 62 to 85 have one reading of joint 2 to the last digit while other "
                     "joints move");
}

TEST(BrokenRows, behind_a_lost_count_are_named_by_joint_and_angle) {
  const Folder folder;
  Csv rows = measured_poses(folder);
  for (std::size_t k = kFirstBroken; k < kRowsOfFile; ++k) {
    set(rows, k, "q3_deg", rows.number(k, "q3_deg") - 37.5);
  }
  expect_refused_for(folder, rows, "in lines 62 to 121 the reading of joint 3 is off by -37.5");
}

// The positions from row `from` on are those of the row before.
void lose_a_row(Csv& rows, std::size_t from) {
  for (std::size_t k = rows.rows.size() - 1; k >= from; --k) {
    for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
      rows.rows[k][rows.column(axis)] = rows.rows[k - 1][rows.column(axis)];
    }
  }
}

TEST(BrokenRows, behind_a_row_that_got_lost_are_named) {
  const Folder folder;
  Csv rows = measured_poses(folder);
  lose_a_row(rows, kFirstBroken);
  expect_refused_for(folder, rows, "positions and joint readings are out of step");
}

// Of so many rows not all are judged: neighbours are known all the same.
TEST(BrokenRows, of_a_long_file_that_are_out_of_step_are_named) {
  const Folder folder;
  const Csv sound = measured_poses(folder, kPuma560, 900);
  for (const std::size_t from : {std::size_t{1}, std::size_t{400}}) {
    Csv rows = sound;
    lose_a_row(rows, from);
    expect_refused_for(folder, rows,
                       "out of step: with the positions 1 row earlier they fit within 0.");
  }
}

TEST(BrokenRows, before_the_sound_ones_are_named_as_well) {
  const Folder folder;
  Csv rows = measured_poses(folder);
  for (std::size_t k = 0; k < kFirstBroken; ++k) set(rows, k, "q1_deg", -rows.number(k, "q1_deg"));
  expect_refused_for(folder, rows, "in lines 2 to 61 the reading of joint 1 is counted the other");
}

// An arm whose offsets lie in one plane is its own mirror image with all readings reversed.
TEST(OneFitOfTwoCauses, has_both_of_them_named) {
  const Folder folder;
  std::string arm = "armsig: arm/1\nname: all in one plane\njoints:\n";
  for (const char* row :
       {"340, a_mm: 0, alpha_deg: -90", "0, a_mm: 0, alpha_deg: 90", "400, a_mm: 0, alpha_deg: 90",
        "0, a_mm: 0, alpha_deg: -90", "400, a_mm: 0, alpha_deg: -90", "0, a_mm: 0, alpha_deg: 90",
        "126, a_mm: 0, alpha_deg: 0"}) {
    arm += "  - {type: revolute, theta_deg: 0, d_mm: " + std::string(row) +
           ", limits_deg: [-120, 120]}\n";
  }
  Csv rows = measured_poses(folder, arm);
  for (std::size_t k = 0; k < rows.rows.size(); ++k) set(rows, k, "x_mm", -rows.number(k, "x_mm"));
  const Outcome outcome = refine(folder, rows);
  EXPECT_EQ(outcome.status, 1) << outcome.out;
  for (const char* cause :
       {"the positions are a mirror image", "are counted the other way", "; or "}) {
    EXPECT_NE(outcome.err.find(cause), std::string::npos) << outcome.err;
  }
}

// Measured with joints 5 and 6 at rest, and read as if they had turned.
TEST(TargetOnAnEarlierLink, is_named) {
  const Folder folder;
  std::string at_rest = kPuma560;
  for (const std::string limits : {"[-100, 100]", "[-266, 266]"}) {
    at_rest.replace(at_rest.find(limits), limits.size(), "[-0.01, 0.01]");
  }
  Csv rows = measured_poses(folder, at_rest);
  write_file(folder / "arm.yaml", kPuma560);
  for (std::size_t k = 0; k < kRowsOfFile; ++k) {
    set(rows, k, "q5_deg", static_cast<double>(k * 37 % 190) - 95);
    set(rows, k, "q6_deg", static_cast<double>(k * 83 % 300) - 150);
  }
  expect_refused_for(folder, rows, "the target follows no joint beyond joint 4");
}

// Forty pairs are more than so few rows tell apart.
TEST(UnstatedCoupling, of_two_percent_is_named_from_few_poses) {
  const Folder folder;
  Csv rows = measured_poses(folder, kPuma560, 56);
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    set(rows, k, "q6_deg", rows.number(k, "q6_deg") - 0.02 * rows.number(k, "q5_deg"));
  }
  expect_refused_for(folder, rows, "joint 6 follows joint 5 by +0.0");
}

TEST(UnstatedCoupling, of_some_percent_is_named_where_the_arm_is_refused_for_a_tilt) {
  const Folder folder;
  Csv rows = measured_poses(folder);
  for (std::size_t k = 0; k < kRowsOfFile; ++k) {
    set(rows, k, "q5_deg", rows.number(k, "q5_deg") - 0.06 * rows.number(k, "q4_deg"));
  }
  expect_refused_for(folder, rows, "joint 5 follows joint 4 by +0.0");
}

}  // namespace
}  // namespace armsig::cli
