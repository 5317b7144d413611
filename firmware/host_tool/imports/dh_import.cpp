// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "core/base/joint_range.hpp"
#include "firmware/formats/csv_lines.hpp"
#include "firmware/formats/csv_table.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/units.hpp"
#include "firmware/host_tool/imports/import.hpp"
#include "firmware/host_tool/imports/plausible.hpp"

namespace armsig::tool {
namespace {

enum ColumnName : std::uint8_t {
  kTheta,
  kD,
  kA,
  kAlpha,
  kAPrev,
  kAlphaPrev,
  kLower,
  kUpper,
  kJoint,
  kType,
  kCount
};

// In the order of ColumnName. Limits are in the unit of the joint's reading, radians or metres.
std::vector<Quantity> quantities() {
  std::vector<Quantity> all{{"theta", Dimension::kAngle},
                            {"d", Dimension::kLength},
                            {"a", Dimension::kLength},
                            {"alpha", Dimension::kAngle},
                            {"a_prev", Dimension::kLength},
                            {"alpha_prev", Dimension::kAngle},
                            {"lower_rad_or_m", Dimension::kNone},
                            {"upper_rad_or_m", Dimension::kNone},
                            {"joint", Dimension::kText},
                            {"type", Dimension::kText}};
  for (std::size_t column = kA; column < kCount; ++column) all[column].required = false;
  all[kLower].may_be_empty = all[kUpper].may_be_empty = true;
  return all;
}

class DhReader {
 public:
  explicit DhReader(CsvTable table)
      : table_(std::move(table)),
        modified_(table_.has(kAPrev) || table_.has(kAlphaPrev)),
        has_limits_(table_.has(kLower) && table_.has(kUpper)) {}

  Read<ImportedArm> read() {
    if (auto columns = check_columns(); !columns)
      return std::unexpected(std::move(columns).error());
    for (;;) {
      ARMSIG_TRY(more, table_.next());
      if (!more) break;
      if (auto row = read_row(); !row) return std::unexpected(std::move(row).error());
    }
    if (arm_.joints.empty()) {
      return table_.problem("the file ends after its header", "a row a joint");
    }
    if (auto units = check_units(); !units) return std::unexpected(std::move(units).error());
    ImportedArm imported{{"imported arm", arm_}, {}};
    if (modified_) move_to_standard(imported);
    if (!has_limits_) {
      imported.notes.emplace_back("the file has no limits: -180 to 180 degrees for every joint");
    }
    return imported;
  }

 private:
  // Standard rows have a and alpha, modified ones a_prev and alpha_prev.
  [[nodiscard]] Read<void> check_columns() const {
    const std::array needed = modified_ ? std::array{kAPrev, kAlphaPrev} : std::array{kA, kAlpha};
    if (modified_ && (table_.has(kA) || table_.has(kAlpha))) {
      return table_.problem("there are columns of standard rows (a, alpha) and of modified ones",
                            "one of the two");
    }
    for (const ColumnName column : needed) {
      if (!table_.has(column)) return missing(column);
    }
    if (table_.has(kLower) && !has_limits_) return missing(kUpper);
    if (table_.has(kUpper) && !has_limits_) return missing(kLower);
    return {};
  }

  [[nodiscard]] std::unexpected<Problem> missing(ColumnName column) const {
    const std::vector<Quantity> all = quantities();
    return table_.problem(fmt::format("there is no column for {}", all[column].name),
                          any_of(names_of(all[column].name, all[column].dimension)));
  }

  [[nodiscard]] Read<JointType> type() const {
    if (!table_.has(kType)) return JointType::kRevolute;
    const std::string_view word = table_.field(kType);
    for (const JointType type : {JointType::kRevolute, JointType::kPrismatic}) {
      if (word == word_of(type)) return type;
    }
    return table_.problem(kType, "type: " + in_quotes(word), "revolute or prismatic");
  }

  // Of a row; 0 where the column is absent.
  [[nodiscard]] double value(ColumnName column) const {
    return table_.has(column) ? table_.value(column) : 0;
  }

  [[nodiscard]] std::array<ColumnName, 2> angles() const {
    return {kTheta, modified_ ? kAlphaPrev : kAlpha};
  }
  [[nodiscard]] std::array<ColumnName, 2> lengths() const { return {kD, modified_ ? kAPrev : kA}; }

  // Of a row: angles of some turns and lengths of many metres are in another unit. The rest is
  // seen once all rows are there.
  Read<void> check_row() {
    for (const ColumnName column : angles()) {
      const Unit& unit = table_.unit(column);
      const bool in_degrees = unit.suffix == kDegree.suffix;
      if (!(std::abs(value(column)) <= kMostAngle_rad)) {
        return unlikely(column, in_degrees ? "degrees" : "radians, or a column in _deg");
      }
      if (in_degrees) angles_deg_.push_back(degrees(value(column)));
    }
    for (const ColumnName column : lengths()) {
      const bool in_mm = table_.unit(column).suffix == kMillimetre.suffix;
      if (!(std::abs(value(column)) <= kMostLength_m)) {
        return unlikely(column, in_mm ? "millimetres" : "metres, or a column in _mm");
      }
      all_lengths_m_ += std::abs(value(column));
      only_mm_ = only_mm_ && in_mm;
    }
    return {};
  }

  [[nodiscard]] Read<void> unlikely(ColumnName column, std::string expected) const {
    return table_.problem(
        column, fmt::format("{}: {}", table_.header(column), in_quotes(table_.field(column))),
        std::move(expected));
  }

  [[nodiscard]] Read<void> check_units() const {
    if (are_radians(angles_deg_)) {
      return table_.problem("all angles in degrees are parts of pi", "degrees, or columns in _rad");
    }
    if (only_mm_ && all_lengths_m_ > 0 && all_lengths_m_ < kLeastArm_m) {
      return table_.problem(fmt::format("all lengths together are {:.3g} mm", 1e3 * all_lengths_m_),
                            "millimetres, or columns in _m");
    }
    return {};
  }

  // Rows are base to tip. A column that counts them, from 1 or from 0, must agree.
  Read<void> check_number() {
    if (!table_.has(kJoint)) return {};
    const auto number = parse_integer(table_.field(kJoint));
    const auto row = static_cast<int>(arm_.joints.size());
    if (row == 0) first_number_ = number && *number == 0 ? 0 : 1;
    if (!number || *number == first_number_ + row) return {};
    return table_.problem(
        kJoint, fmt::format("joint: {} in the row of joint {}", *number, first_number_ + row),
        "the joints in order, base to tip");
  }

  // Those of a row; nothing where lower and upper are empty: it turns without end.
  [[nodiscard]] Read<JointLimits> limits(JointType type) const {
    if (!has_limits_ && type == JointType::kRevolute) return JointLimits{-kPi, kPi};
    const std::string joint = fmt::format("joint {}", arm_.joints.size() + 1);
    const bool none = !has_limits_ || (std::isnan(value(kLower)) && std::isnan(value(kUpper)));
    if (none && type == JointType::kPrismatic) {
      return table_.problem(joint + " is prismatic and has no limits",
                            "columns lower_rad_or_m and upper_rad_or_m");
    }
    if (none) return kNoLimits;
    const JointLimits stated{value(kLower), value(kUpper)};
    if (!(stated.lower < stated.upper)) {
      return table_.problem(
          fmt::format("the lower limit {} is not below the upper {}", stated.lower, stated.upper),
          "the lower limit first");
    }
    const double most = std::max(-stated.lower, stated.upper);
    const bool turns = type == JointType::kRevolute;
    if (turns && -stated.lower >= kNoLimit_rad && stated.upper >= kNoLimit_rad) return kNoLimits;
    if (most > (turns ? kMostTurns_rad : kMostStroke_m)) {
      return table_.problem(
          fmt::format("limits of {}: {} to {}", joint, stated.lower, stated.upper),
          turns ? "radians; nothing in both where it turns without end" : "metres");
    }
    return stated;
  }

  Read<void> read_row() {
    if (arm_.joints.size() == kMaxJoints) {
      return table_.problem(fmt::format("more than {} joints", kMaxJoints),
                            fmt::format("at most {}", kMaxJoints));
    }
    ARMSIG_TRY(joint_type, type());
    if (auto row = check_number(); !row) return row;
    if (auto row = check_row(); !row) return row;
    ARMSIG_TRY(joint_limits, limits(joint_type));
    arm_.joints.push_back({.type = joint_type,
                           .theta_rad = value(kTheta),
                           .d_m = value(kD),
                           .a_m = value(modified_ ? kAPrev : kA),
                           .alpha_rad = value(modified_ ? kAlphaPrev : kAlpha)});
    arm_.limits.push_back(joint_limits);
    return {};
  }

  // alpha and a of a modified row belong to the standard row before it.
  static void move_to_standard(ImportedArm& imported) {
    auto& joints = imported.description.arm.joints;
    const DhJoint first = joints[0];
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const bool last = i + 1 == joints.size();
      joints[i].alpha_rad = last ? 0 : joints[i + 1].alpha_rad;
      joints[i].a_m = last ? 0 : joints[i + 1].a_m;
    }
    if (first.alpha_rad != 0 || first.a_m != 0) {
      imported.notes.push_back(fmt::format(
          "alpha_prev {:.9g} rad and a_prev {:.9g} m of the first row stand before joint 1 and are "
          "no part of the arm description",
          first.alpha_rad, first.a_m));
    }
  }

  CsvTable table_;
  bool modified_;
  bool has_limits_;
  int first_number_ = 1;            // of the column that counts the joints
  std::vector<double> angles_deg_;  // of columns in degrees
  double all_lengths_m_ = 0;
  bool only_mm_ = true;
  Arm arm_;
};

}  // namespace

Read<ImportedArm> import_dh(const std::string& path) {
  ARMSIG_TRY(lines, LineReader::open(path));
  ARMSIG_TRY(table, CsvTable::open(std::move(lines), quantities(), CsvTable::Style::kForeign));
  return DhReader(std::move(table)).read();
}

}  // namespace armsig::tool
