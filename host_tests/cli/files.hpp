// SPDX-License-Identifier: MIT
// Files that the tests of the command start from.
#pragma once

#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include "host_tests/cli/run_tool.hpp"

namespace armsig::cli {

// A planar arm of two joints: small enough to read its measurements in a test.
inline constexpr const char* kTwoJointArm =
    "armsig: arm/1\n"
    "name: two joints\n"
    "joints:\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 100, a_mm: 300, alpha_deg: 90, limits_deg: [-170, "
    "170]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 250, alpha_deg: 0, limits_deg: [-170, "
    "170]}\n";

inline constexpr const char* kPuma560 =
    "armsig: arm/1\n"
    "name: Puma 560\n"
    "joints:\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: -90, limits_deg: [-160, "
    "160]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 149.09, a_mm: 431.8, alpha_deg: 0, limits_deg: "
    "[-225, 45]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: -20.32, alpha_deg: 90, limits_deg: [-45, "
    "225]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 430.7, a_mm: 0, alpha_deg: -90, limits_deg: [-110, "
    "170]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 90, limits_deg: [-100, 100]}\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 0, limits_deg: [-266, 266]}\n"
    "floor_mm: 672\n";

// Leaves arm.yaml, m.csv (24 points a sweep) and the truth t.yaml of that arm in the folder.
inline Outcome measure_two_joints(const Folder& folder) {
  write_file(folder / "arm.yaml", kTwoJointArm);
  return run_tool(folder, "simulate --arm arm.yaml --points 24 --out m.csv --truth-out t.yaml");
}

using Fields = std::vector<std::string>;

inline Fields split(const std::string& text, char separator) {
  Fields fields;
  std::istringstream stream(text);
  for (std::string field; std::getline(stream, field, separator);) fields.push_back(field);
  if (!text.empty() && text.back() == separator && separator == ',') fields.emplace_back();
  return fields;
}

inline std::string join(const Fields& fields, char separator) {
  std::string text;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    if (k > 0) text += separator;
    text += fields[k];
  }
  return text;
}

// A CSV file in memory: comments, header, rows.
struct Csv {
  Fields header;
  std::vector<Fields> rows;

  static Csv read(const std::filesystem::path& path) {
    Csv csv;
    for (const std::string& line : split(read_file(path), '\n')) {
      if (line.empty() || line.front() == '#') continue;
      if (csv.header.empty()) {
        csv.header = split(line, ',');
      } else {
        csv.rows.push_back(split(line, ','));
      }
    }
    return csv;
  }
  void write(const std::filesystem::path& path) const {
    std::string text = join(header, ',') + "\n";
    for (const Fields& row : rows) text += join(row, ',') + "\n";
    write_file(path, text);
  }
  [[nodiscard]] std::size_t column(const std::string& name) const {
    for (std::size_t k = 0; k < header.size(); ++k) {
      if (header[k] == name) return k;
    }
    ADD_FAILURE() << "no column " << name;
    return 0;
  }
  [[nodiscard]] double number(std::size_t row, const std::string& name) const {
    return std::stod(rows[row][column(name)]);
  }
};

// The rows as another measurement of the same poses: 2 nm elsewhere, so that no row is one that a
// signature was fitted to, and every figure is the same.
inline Csv measured_again(Csv rows) {
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", rows.number(k, "x_mm") + 2e-6);
    rows.rows[k][rows.column("x_mm")] = text;
  }
  return rows;
}

}  // namespace armsig::cli
