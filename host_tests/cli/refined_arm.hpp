// SPDX-License-Identifier: MIT
// A simulated Puma, measured in sweeps and mixed poses, and `identify --method refined` of it.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>

#include "host_tests/cli/predictions.hpp"

namespace armsig::cli {

inline const std::filesystem::path kShared = ARMSIG_SHARED_DATA;

// Sweeps and mixed poses of a Puma made to the usual tolerances, with one target on its hand.
inline Csv simulated(const Folder& folder, const std::string& options = "",
                     const std::string& arm = kPuma560) {
  write_file(folder / "arm.yaml", arm);
  const Outcome outcome =
      run_tool(folder,
               "simulate --arm arm.yaml --tolerances 1 --flange-target-mm 80,30,120 --arc 90 "
               "--points 20 --free-poses 40 --seed 11 --out good.csv --truth-out truth.yaml " +
                   options);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return Csv::read(folder / "good.csv");
}

inline Outcome refine(const Folder& folder, const Csv& rows, const std::string& options = "") {
  rows.write(folder / "m.csv");
  return run_tool(folder,
                  "identify --arm arm.yaml --measurements m.csv --method refined --out "
                  "s.yaml " +
                      options);
}

inline void keep_mixed(Csv& csv) {
  std::erase_if(csv.rows, [&](const Fields& row) { return row[csv.column("sweep")] != "0"; });
}

// Readings as an encoder gives them that errs by 0.05 degrees five times a turn.
inline Csv with_wavy_readings(Csv rows) {
  for (Fields& row : rows.rows) {
    for (const char* joint : {"q1_deg", "q2_deg", "q3_deg"}) {
      std::string& text = row[rows.column(joint)];
      const double q = std::stod(text);
      char wavy[40];
      std::snprintf(wavy, sizeof wavy, "%.17g", q - 0.05 * std::sin(5 * q * 0.017453292519943295));
      text = wavy;
    }
  }
  return rows;
}

// Largest error of the target's position over the mixed poses of good.csv.
inline double error_m(const Folder& folder) {
  write_joint_poses(Csv::read(folder / "good.csv"), folder / "q.csv");
  return largest_distance(predict(folder, "s.yaml", "1"), predict(folder, "truth.yaml", "1"));
}

inline void expect_refused(const Folder& folder, const Outcome& outcome, int status,
                           const std::string& words) {
  EXPECT_EQ(outcome.status, status) << outcome.out;
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "s.yaml"));
}

inline void expect_said(const Outcome& outcome, const std::string& words) {
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE((outcome.out + outcome.err).find(words), std::string::npos)
      << outcome.out << outcome.err;
}

}  // namespace armsig::cli
