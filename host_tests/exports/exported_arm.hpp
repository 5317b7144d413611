// SPDX-License-Identifier: MIT
// Exact arms whose signature is exported, and the readings at which the exports are compared with
// what `armsig predict` says.
#pragma once

#include <random>

#include "host_tests/cli/files.hpp"

namespace armsig::cli {

inline constexpr double kExportTolerance_m = 1e-9;
inline constexpr int kPoses = 50;

inline constexpr const char* kCoupledArm =
    "armsig: arm/1\nname: \"coupled <arm> & -- \\\"co\\\"\"\njoints:\n"
    "  - {type: revolute, theta_deg: 10, d_mm: 400, a_mm: 25, alpha_deg: -90}\n"
    "  - {type: revolute, theta_deg: -90, d_mm: 0, a_mm: 455, alpha_deg: 0}\n"
    "  - {type: revolute, theta_deg: 20, d_mm: 0, a_mm: 35, alpha_deg: -90}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 420, a_mm: 0, alpha_deg: 90}\n"
    "  - {type: revolute, theta_deg: 30, d_mm: 0, a_mm: 0, alpha_deg: -90}\n"
    "  - {type: revolute, theta_deg: 180, d_mm: 80, a_mm: 0, alpha_deg: 0}\n"
    "coupling:\n  - {joint: 3, from: 2, ratio: -1}\n";

inline constexpr const char* kStanfordArm =
    "armsig: arm/1\nname: Stanford\njoints:\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 412, a_mm: 0, alpha_deg: -90}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 154, a_mm: 0, alpha_deg: 90}\n"
    "  - {type: prismatic, theta_deg: -90, d_mm: 0, a_mm: 20.3, alpha_deg: 0, limits_mm: [300, "
    "965]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: -90}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 90}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 0}\n";

// Writes arm.yaml, an individual of it as truth.yaml, random readings q.csv and their poses p.csv.
inline void make_individual(const Folder& folder, const std::string& arm_text,
                            const std::string& options = "--tolerances 1") {
  write_file(folder / "arm.yaml", arm_text);
  const Outcome simulated =
      run_tool(folder,
               "simulate --arm arm.yaml --sigma-mm 0 --arc 60 --points 10 "
               "--free-poses 50 --seed 3 --out m.csv --truth-out truth.yaml " +
                   options);
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const Csv measured = Csv::read(folder / "m.csv");
  Csv joints;
  for (const std::string& name : measured.header) {
    if (name.starts_with('q')) joints.header.push_back(name);
  }
  for (const Fields& row : measured.rows) {
    if (row[measured.column("sweep")] != "0") continue;
    Fields readings;
    for (const std::string& name : joints.header) readings.push_back(row[measured.column(name)]);
    joints.rows.push_back(readings);
  }
  ASSERT_EQ(joints.rows.size(), kPoses);
  joints.write(folder / "q.csv");
  const Outcome predicted =
      run_tool(folder, "predict --signature truth.yaml --joints q.csv --out p.csv");
  ASSERT_EQ(predicted.status, 0) << predicted.err;
}

inline Outcome export_as(const Folder& folder, const std::string& format) {
  return run_tool(folder, "export --signature truth.yaml --format " + format + " --out export.out");
}

// What an arm of the shared data says, or nothing where the data are absent.
inline std::string shared_arm(const std::string& name) {
  return read_file(std::filesystem::path(ARMSIG_SHARED_DATA) / "arms" / (name + ".yaml"));
}

}  // namespace armsig::cli
