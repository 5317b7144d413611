// SPDX-License-Identifier: MIT
// Column names of other software, and what they mean.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/arm.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/units.hpp"

namespace armsig::tool {

// The joints whose readings a table has: their types, and what other software calls them (one each,
// or none).
struct NamedJoints {
  JointTypes types;
  std::vector<std::string> names;

  // NOLINTNEXTLINE(google-explicit-constructor): joints without names are their types
  NamedJoints(const JointTypes& joint_types = {}, std::vector<std::string> joint_names = {})
      : types(joint_types), names(std::move(joint_names)) {}
};

// The units that a person states once, for columns whose header does not: "deg", "mm".
struct StatedUnits {
  std::string angle;   // deg, rad or empty
  std::string length;  // mm, m or empty
};

// "deg,mm" or "mm". Refuses any other word, and two of one kind.
[[nodiscard]] Read<StatedUnits> stated_units(std::string_view words);

// Of a name that is "Point": where each row is a measurement, that of its reflector; where it is a
// taught reading, what it teaches.
inline constexpr std::size_t kRankOfPoint = 3;

// What a cell of a header says.
struct ColumnMeaning {
  // What it is of: q1, x, sweep, target, sigma, air; time, date, name or group of a point.
  std::string quantity;
  // In which unit; empty where none is stated, and of what has none. Of a time s, ms, us or ns.
  std::string unit;
  Dimension dimension = Dimension::kText;
  // The number of the joint as the header counts, from 0 or 1; nothing where it is by name.
  std::optional<std::size_t> joint_number = std::nullopt;
  // Among names for one quantity, the lower is the likelier one.
  std::size_t rank = 0;

  [[nodiscard]] bool is_text() const { return dimension == Dimension::kText; }
  [[nodiscard]] bool has_good_unit() const;
  [[nodiscard]] std::string ours() const;  // "q1_deg", "target"
};

// "X [mm]", "A1 (°)", "Joint 2, rad", "actual_q_0" (radians, by the manual of Universal Robots'
// RTDE), "Point", "T air [°C]", "Time [s]", "%time" (nanoseconds, of ROS), the name of a joint.
// Nothing for a name that is not known. `first_joint`: the number of the header's first joint. The
// quantity of a joint beyond the arm is one too many: "q7".
[[nodiscard]] std::optional<ColumnMeaning> meaning_of(std::string_view theirs,
                                                      const NamedJoints& joints,
                                                      std::size_t first_joint = 1);

// Whether a cell states a unit and nothing else: "mm", "[deg]", "(s)".
[[nodiscard]] bool is_unit(std::string_view cell);

// "x_mm" -> "x": what a column of ours is about, whatever its unit.
[[nodiscard]] std::string_view quantity_of(std::string_view ours);

}  // namespace armsig::tool
