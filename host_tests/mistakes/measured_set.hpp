// SPDX-License-Identifier: MIT
// What a person hands to `armsig identify`: an arm description and measurements, as numbers that a
// mistake can be made in.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "firmware/formats/arm_file.hpp"
#include "host_tests/cli/files.hpp"

namespace armsig::mistakes {

struct Row {
  int sweep = 0;
  int target = 0;
  std::vector<double> q;  // degrees, millimetres
  double p[3] = {0, 0, 0};
  double sigma = 0;
};

struct Set {
  tool::ArmDescription description;
  std::vector<Row> rows;

  [[nodiscard]] DhRows& joints() { return description.arm.joints; }
  [[nodiscard]] std::size_t size() const { return description.arm.joints.size(); }
  [[nodiscard]] bool revolute(std::size_t j) const {
    return description.arm.joints[j].type == JointType::kRevolute;
  }
  // The first row of sweep `number`, or the number of rows.
  [[nodiscard]] std::size_t start_of(int number) const {
    return static_cast<std::size_t>(std::ranges::find(rows, number, &Row::sweep) - rows.begin());
  }
};

inline std::string reading_name(const Set& set, std::size_t joint) {
  return fmt::format("q{}_{}", joint + 1, set.revolute(joint) ? "deg" : "mm");
}

inline Set read_set(const std::filesystem::path& arm, const std::filesystem::path& measurements) {
  Set set;
  const auto description = tool::read_arm_file(arm.string());
  EXPECT_TRUE(description) << arm;
  if (!description) return set;
  set.description = *description;
  const cli::Csv csv = cli::Csv::read(measurements);
  for (std::size_t k = 0; k < csv.rows.size(); ++k) {
    Row row{.sweep = static_cast<int>(csv.number(k, "sweep")),
            .target = static_cast<int>(csv.number(k, "target")),
            .q = {}};
    for (std::size_t j = 0; j < set.size(); ++j)
      row.q.push_back(csv.number(k, reading_name(set, j)));
    row.p[0] = csv.number(k, "x_mm");
    row.p[1] = csv.number(k, "y_mm");
    row.p[2] = csv.number(k, "z_mm");
    row.sigma = csv.number(k, "sigma_mm");
    set.rows.push_back(row);
  }
  return set;
}

inline void write_set(const Set& set, const std::filesystem::path& arm,
                      const std::filesystem::path& measurements) {
  cli::write_file(arm, tool::arm_text(set.description));
  std::string text = "sweep,target";
  for (std::size_t j = 0; j < set.size(); ++j) text += "," + reading_name(set, j);
  text += ",x_mm,y_mm,z_mm,sigma_mm\n";
  for (const Row& row : set.rows) {
    text += fmt::format("{},{}", row.sweep, row.target);
    for (const double q : row.q) text += fmt::format(",{:.9f}", q);
    for (const double x : row.p) text += fmt::format(",{:.9f}", x);
    text += fmt::format(",{:.6f}\n", row.sigma);
  }
  cli::write_file(measurements, text);
}

// Joint poses as `armsig predict` takes them, in degrees and millimetres.
inline std::string poses_text(const Set& set) {
  std::string text;
  for (std::size_t j = 0; j < set.size(); ++j) {
    text += (j == 0 ? "" : ",") + reading_name(set, j);
  }
  text += "\n";
  for (const Row& row : set.rows) {
    for (std::size_t j = 0; j < set.size(); ++j) {
      text += fmt::format("{}{:.9f}", j == 0 ? "" : ",", row.q[j]);
    }
    text += "\n";
  }
  return text;
}

}  // namespace armsig::mistakes
