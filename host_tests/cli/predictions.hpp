// SPDX-License-Identifier: MIT
// What signatures predict, through the command.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "host_tests/cli/files.hpp"

namespace armsig::cli {

// Joint poses from the rows with sweep 0, for `predict`.
inline void write_joint_poses(const Csv& measurements, const std::filesystem::path& path) {
  Csv poses;
  Fields columns;
  for (const std::string& name : measurements.header) {
    if (name.starts_with('q')) columns.push_back(name);
  }
  poses.header = columns;
  for (const Fields& row : measurements.rows) {
    if (row[measurements.column("sweep")] != "0") continue;
    Fields pose;
    for (const std::string& name : columns) pose.push_back(row[measurements.column(name)]);
    poses.rows.push_back(pose);
  }
  poses.write(path);
}

inline Csv predict(const Folder& folder, const std::string& signature, const std::string& target) {
  const Outcome outcome = run_tool(folder, "predict --signature " + signature +
                                               " --joints q.csv --out p.csv --target " + target);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return Csv::read(folder / "p.csv");
}

inline double largest_distance(const Csv& a, const Csv& b) {
  EXPECT_EQ(a.rows.size(), b.rows.size());
  double largest = 0;
  for (std::size_t k = 0; k < a.rows.size(); ++k) {
    largest = std::max(largest, std::hypot(a.number(k, "x_m") - b.number(k, "x_m"),
                                           a.number(k, "y_m") - b.number(k, "y_m"),
                                           a.number(k, "z_m") - b.number(k, "z_m")));
  }
  return largest;
}

inline double rms_distance(const Csv& a, const Csv& b) {
  EXPECT_EQ(a.rows.size(), b.rows.size());
  double sum = 0;
  for (std::size_t k = 0; k < a.rows.size(); ++k) {
    for (const char* axis : {"x_m", "y_m", "z_m"}) {
      const double apart = a.number(k, axis) - b.number(k, axis);
      sum += apart * apart;
    }
  }
  return std::sqrt(sum / static_cast<double>(a.rows.size()));
}

struct IdentifiedRows {
  nlohmann::json result;  // null where it was refused
  std::string err;
};

// What `identify` says of `rows` of the arm in arm.yaml; its signature is in s.yaml.
inline IdentifiedRows identified_rows(const Folder& folder, const Csv& rows,
                                      const std::string& method) {
  rows.write(folder / "m.csv");
  const Outcome outcome = run_tool(
      folder,
      "identify --arm arm.yaml --measurements m.csv --out s.yaml --json --method " + method);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  if (outcome.status != 0) return {nullptr, outcome.err};
  return {nlohmann::json::parse(outcome.out), outcome.err};
}

}  // namespace armsig::cli
