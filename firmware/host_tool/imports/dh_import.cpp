// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/csv_lines.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/units.hpp"
#include "firmware/host_tool/imports/import.hpp"

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
  kCount
};

struct ColumnKind {
  const char* name;
  Dimension dimension;
};
// Limits are in the unit of the joint's reading, radians or metres.
constexpr std::array<ColumnKind, kCount> kKinds{{{"theta", Dimension::kAngle},
                                                 {"d", Dimension::kLength},
                                                 {"a", Dimension::kLength},
                                                 {"alpha", Dimension::kAngle},
                                                 {"a_prev", Dimension::kLength},
                                                 {"alpha_prev", Dimension::kAngle},
                                                 {"lower_rad_or_m", Dimension::kNone},
                                                 {"upper_rad_or_m", Dimension::kNone}}};

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t start = 0; start <= line.size();) {
    const std::size_t stop = std::min(line.find(',', start), line.size());
    fields.push_back(trimmed(line.substr(start, stop - start)));
    start = stop + 1;
  }
  return fields;
}

struct Column {
  std::optional<std::size_t> position;
  Unit unit;
};

class DhReader {
 public:
  explicit DhReader(LineReader lines) : lines_(std::move(lines)) {}

  Read<ImportedArm> read() {
    if (auto header = read_header(); !header) return std::unexpected(std::move(header).error());
    for (;;) {
      ARMSIG_TRY(more, lines_.next());
      if (!more) break;
      if (auto row = read_row(); !row) return std::unexpected(std::move(row).error());
    }
    if (arm_.joints.empty()) return bad("the file ends after its header", "a row a joint");
    ImportedArm imported{{"imported arm", arm_}, {}};
    if (modified_) move_to_standard(imported);
    if (!has_limits_) {
      imported.notes.emplace_back("the file has no limits: -180 to 180 degrees for every joint");
    }
    return imported;
  }

 private:
  [[nodiscard]] std::unexpected<Problem> bad(std::string what, std::string expected) const {
    return problem_at(static_cast<int>(lines_.number()), 0, std::move(what), std::move(expected));
  }

  Read<void> read_header() {
    ARMSIG_TRY(more, lines_.next());
    if (!more) {
      return problem_at(0, 0, std::string(lines_.what_it_is()),
                        "a header line, then a row a joint");
    }
    const auto fields = fields_of(lines_.line());
    for (std::size_t position = 0; position < fields.size(); ++position) {
      if (auto taken = take_column(fields[position], position); !taken) return taken;
    }
    fields_ = fields.size();
    modified_ = columns_[kAPrev].position.has_value() || columns_[kAlphaPrev].position.has_value();
    has_limits_ = columns_[kLower].position.has_value() && columns_[kUpper].position.has_value();
    const std::array needed = modified_ ? std::array<std::size_t, 4>{kAlphaPrev, kAPrev, kTheta, kD}
                                        : std::array<std::size_t, 4>{kTheta, kD, kA, kAlpha};
    for (const std::size_t column : needed) {
      if (columns_[column].position) continue;
      return bad(fmt::format("there is no column for {}", kKinds[column].name),
                 any_of(names_of(kKinds[column].name, kKinds[column].dimension)));
    }
    return {};
  }

  Read<void> take_column(std::string_view name, std::size_t position) {
    if (name == "joint") return {};
    if (name == "type") {
      type_position_ = position;
      return {};
    }
    for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
      const auto units = units_of(kKinds[kind].dimension);
      if (units.empty() && name == kKinds[kind].name) {
        columns_[kind] = {position, {}};
        return {};
      }
      for (const Unit& unit : units) {
        if (name != fmt::format("{}_{}", kKinds[kind].name, unit.suffix)) continue;
        if (columns_[kind].position) {
          return bad(
              fmt::format("column {} gives {} a second time", in_quotes(name), kKinds[kind].name),
              "each column once");
        }
        columns_[kind] = {position, unit};
        return {};
      }
    }
    return bad(fmt::format("unknown column {}", in_quotes(name)),
               "joint, type, theta_rad, d_m, a_m, alpha_rad; or alpha_prev_rad, a_prev_m, "
               "theta_rad, d_m (or _deg, _mm)");
  }

  [[nodiscard]] Read<double> value(const std::vector<std::string_view>& fields,
                                   std::size_t kind) const {
    const Column& column = columns_[kind];
    if (!column.position) return 0.0;
    const auto number = parse_number(fields[*column.position]);
    if (!number) {
      return bad(
          fmt::format("{}: {}", kKinds[kind].name, why_not_a_number(fields[*column.position])),
          "a number");
    }
    return kKinds[kind].dimension == Dimension::kNone ? *number : column.unit.to_si(*number);
  }

  Read<void> read_row() {
    const auto fields = fields_of(lines_.line());
    if (fields.size() != fields_) {
      return bad(fmt::format("the row has {} fields", fields.size()),
                 fmt::format("{}, as the header", fields_));
    }
    if (arm_.joints.size() == kMaxJoints) {
      return bad(fmt::format("more than {} joints", kMaxJoints),
                 fmt::format("at most {}", kMaxJoints));
    }
    DhJoint joint;
    if (type_position_) {
      const std::string_view type = fields[*type_position_];
      if (type != "revolute" && type != "prismatic") {
        return bad("type: " + in_quotes(type), "revolute or prismatic");
      }
      if (type == "prismatic") joint.type = JointType::kPrismatic;
    }
    ARMSIG_TRY(theta, value(fields, kTheta));
    ARMSIG_TRY(d, value(fields, kD));
    ARMSIG_TRY(a, value(fields, modified_ ? kAPrev : kA));
    ARMSIG_TRY(alpha, value(fields, modified_ ? kAlphaPrev : kAlpha));
    joint.theta_rad = theta;
    joint.d_m = d;
    joint.a_m = a;
    joint.alpha_rad = alpha;
    ARMSIG_TRY(lower, value(fields, kLower));
    ARMSIG_TRY(upper, value(fields, kUpper));
    if (!has_limits_ && joint.type == JointType::kPrismatic) {
      return bad(fmt::format("joint {} is prismatic and has no limits", arm_.joints.size() + 1),
                 "columns lower_rad_or_m and upper_rad_or_m");
    }
    if (has_limits_ && !(lower < upper)) {
      return bad(fmt::format("the lower limit {} is not below the upper {}", lower, upper),
                 "the lower limit first");
    }
    arm_.joints.push_back(joint);
    arm_.limits.push_back(has_limits_ ? JointLimits{lower, upper} : JointLimits{-kPi, kPi});
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

  LineReader lines_;
  std::array<Column, kCount> columns_{};
  std::optional<std::size_t> type_position_;
  std::size_t fields_ = 0;
  bool modified_ = false;
  bool has_limits_ = false;
  Arm arm_;
};

}  // namespace

Read<ImportedArm> import_dh(const std::string& path) {
  ARMSIG_TRY(lines, LineReader::open(path));
  return in_file(path, DhReader(std::move(lines)).read());
}

}  // namespace armsig::tool
