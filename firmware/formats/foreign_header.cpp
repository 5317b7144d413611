// SPDX-License-Identifier: MIT
#include "firmware/formats/foreign_header.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <span>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

struct Synonym {
  std::string_view theirs;
  std::string_view ours;
};
constexpr std::array kUnits{
    Synonym{"mm", "mm"},
    Synonym{"millimeter", "mm"},
    Synonym{"millimetre", "mm"},
    Synonym{"millimeters", "mm"},
    Synonym{"millimetres", "mm"},
    Synonym{"m", "m"},
    Synonym{"meter", "m"},
    Synonym{"metre", "m"},
    Synonym{"meters", "m"},
    Synonym{"metres", "m"},
    Synonym{"deg", "deg"},
    Synonym{"degree", "deg"},
    Synonym{"degrees", "deg"},
    Synonym{"\u00B0", "deg"},
    Synonym{"\xB0", "deg"},
    Synonym{"rad", "rad"},
    Synonym{"radian", "rad"},
    Synonym{"radians", "rad"},
    Synonym{"c", "c"},
    Synonym{"\u00B0"
            "c",
            "c"},
    Synonym{"\xB0"
            "c",
            "c"},
    Synonym{"degc", "c"},
    Synonym{"s", "s"},
    Synonym{"sec", "s"},
    Synonym{"second", "s"},
    Synonym{"seconds", "s"},
    Synonym{"ms", "ms"},
    Synonym{"millisecond", "ms"},
    Synonym{"milliseconds", "ms"},
    Synonym{"us", "us"},
    Synonym{"\u00B5s", "us"},
    Synonym{"\u03BCs", "us"},
    Synonym{"microseconds", "us"},
    Synonym{"ns", "ns"},
    Synonym{"nanoseconds", "ns"},
};
struct NamedQuantity {
  std::string_view theirs;
  std::string_view ours;
  Dimension dimension;
  std::size_t rank = 0;
};
constexpr std::array kNames{
    NamedQuantity{"sweep", "sweep", Dimension::kInteger},
    NamedQuantity{"target", "target", Dimension::kInteger},
    NamedQuantity{"x", "x", Dimension::kLength},
    NamedQuantity{"y", "y", Dimension::kLength},
    NamedQuantity{"z", "z", Dimension::kLength},
    // Measured coordinates, as coordinate measuring machines head them.
    NamedQuantity{"mxcoord", "x", Dimension::kLength},
    NamedQuantity{"mycoord", "y", Dimension::kLength},
    NamedQuantity{"mzcoord", "z", Dimension::kLength},
    NamedQuantity{"sigma", "sigma", Dimension::kLength},
    NamedQuantity{"air", "air", Dimension::kTemperature},
    NamedQuantity{"temperature", "air", Dimension::kTemperature},
    NamedQuantity{"airtemperature", "air", Dimension::kTemperature},
    NamedQuantity{"tair", "air", Dimension::kTemperature},
    NamedQuantity{"name", "name", Dimension::kText, 0},
    NamedQuantity{"pointname", "name", Dimension::kText, 1},
    NamedQuantity{"elementname", "name", Dimension::kText, 2},
    NamedQuantity{"point", "name", Dimension::kText, kRankOfPoint},
    NamedQuantity{"punkt", "name", Dimension::kText, kRankOfPoint},
    NamedQuantity{"pose", "name", Dimension::kText, 4},
    NamedQuantity{"label", "name", Dimension::kText, 5},
    NamedQuantity{"pointid", "name", Dimension::kText, 6},
    NamedQuantity{"id", "name", Dimension::kText, 7},
    NamedQuantity{"measurement", "name", Dimension::kText, 8},
    NamedQuantity{"collection", "collection", Dimension::kText},
    NamedQuantity{"frame", "frame", Dimension::kText},
    NamedQuantity{"group", "group", Dimension::kText},
    NamedQuantity{"time", "time", Dimension::kText, 0},
    NamedQuantity{"timestamp", "time", Dimension::kText, 1},
    NamedQuantity{"datetime", "time", Dimension::kText, 2},
    NamedQuantity{"zeit", "time", Dimension::kText, 3},
    NamedQuantity{"date", "date", Dimension::kText},
    NamedQuantity{"datum", "date", Dimension::kText},
};
// What stands before a joint's number, and the unit that goes without saying.
struct JointWord {
  std::string_view word;
  std::string_view unit;
};
constexpr std::array kJointWords{JointWord{"q", ""},         JointWord{"j", ""},
                                 JointWord{"a", ""},         JointWord{"joint", ""},
                                 JointWord{"axis", ""},      JointWord{"achse", ""},
                                 JointWord{"actualq", "rad"}};
constexpr std::array<std::string_view, 4> kTimeUnitNames{"s", "ms", "us", "ns"};

std::string_view unit_called(std::string_view word) {
  const auto* found = std::ranges::find(kUnits, word, &Synonym::theirs);
  return found == kUnits.end() ? std::string_view{} : found->ours;
}

// Lower-case words: runs of anything but blanks, brackets and the signs between words.
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words;
  bool inside = false;
  for (const char c : name) {
    if (std::string_view(" \t[](){},:_.%").find(c) != std::string_view::npos) {
      inside = false;
      continue;
    }
    if (!inside) words.emplace_back();
    inside = true;
    words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return words;
}

std::string joined(std::span<const std::string> words) {
  std::string name;
  for (const std::string& word : words) name += word;
  return name;
}

// The joint with a number after one of the words, whose `unit` may go without saying.
std::optional<ColumnMeaning> numbered_joint(std::string_view name, const NamedJoints& joints,
                                            std::size_t first_joint) {
  for (const JointWord& word : kJointWords) {
    if (!name.starts_with(word.word)) continue;
    const std::string_view digits = name.substr(word.word.size());
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    constexpr std::size_t kMost = 2;  // digits of a joint's number
    if (error != std::errc{} || end != digits.data() + digits.size() || digits.size() > kMost) {
      continue;
    }
    const std::size_t joint = number + 1 - std::min(first_joint, number + 1);  // from 1
    ColumnMeaning meaning{.quantity = fmt::format("q{}", joint),
                          .unit = std::string(word.unit),
                          .dimension = Dimension::kAngle,
                          .joint_number = number};
    if (joint >= 1 && joint <= joints.types.size()) {
      meaning.dimension = dimension_of(joints.types[joint - 1]);
    }
    return meaning;
  }
  return std::nullopt;
}

std::optional<ColumnMeaning> named_joint(std::string_view name, const NamedJoints& joints) {
  for (std::size_t j = 0; j < joints.names.size() && j < joints.types.size(); ++j) {
    if (joined(words_of(joints.names[j])) != name) continue;
    return ColumnMeaning{.quantity = fmt::format("q{}", j + 1),
                         .unit = {},
                         .dimension = dimension_of(joints.types[j])};
  }
  return std::nullopt;
}

std::optional<ColumnMeaning> meaning_without_unit(std::string_view name, const NamedJoints& joints,
                                                  std::size_t first_joint) {
  if (auto joint = named_joint(name, joints)) return joint;
  if (auto joint = numbered_joint(name, joints, first_joint)) return joint;
  const auto* found = std::ranges::find(kNames, name, &NamedQuantity::theirs);
  if (found == kNames.end()) return std::nullopt;
  return ColumnMeaning{.quantity = std::string(found->ours),
                       .unit = {},
                       .dimension = found->dimension,
                       .rank = found->rank};
}

}  // namespace

Read<StatedUnits> stated_units(std::string_view words) {
  StatedUnits units;
  const auto is_of = [](std::string_view word, Dimension dimension) {
    const auto known = units_of(dimension);
    return std::ranges::find(known, word, &Unit::suffix) != known.end();
  };
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(','), words.size());
    const std::string word(trimmed(words.substr(0, end)));
    words.remove_prefix(std::min(end + 1, words.size()));
    const bool angle = is_of(word, Dimension::kAngle);
    std::string& unit = angle ? units.angle : units.length;
    if ((!angle && !is_of(word, Dimension::kLength)) || !unit.empty()) {
      return std::unexpected(Problem{"--units", 0, 0, in_quotes(word),
                                     "deg or rad, mm or m, each once: --units deg,mm"});
    }
    unit = word;
  }
  return units;
}

bool ColumnMeaning::has_good_unit() const {
  if (quantity == "time") {
    return unit.empty() || std::ranges::find(kTimeUnitNames, unit) != kTimeUnitNames.end();
  }
  const auto units = units_of(dimension);
  if (units.empty()) return unit.empty();
  return std::ranges::find(units, unit, &Unit::suffix) != units.end();
}

std::string ColumnMeaning::ours() const {
  return unit.empty() ? quantity : fmt::format("{}_{}", quantity, unit);
}

std::optional<ColumnMeaning> meaning_of(std::string_view theirs, const NamedJoints& joints,
                                        std::size_t first_joint) {
  const std::vector<std::string> words = words_of(theirs);
  if (words.empty()) return std::nullopt;
  if (auto whole = meaning_without_unit(joined(words), joints, first_joint)) {
    if (whole->quantity == "time" && trimmed(theirs).starts_with('%')) whole->unit = "ns";
    return whole;
  }
  const std::string_view unit = unit_called(words.back());
  if (unit.empty() || words.size() < 2) return std::nullopt;
  auto meaning =
      meaning_without_unit(joined(std::span(words).first(words.size() - 1)), joints, first_joint);
  if (meaning) meaning->unit = unit;
  return meaning;
}

bool is_unit(std::string_view cell) {
  const std::vector<std::string> words = words_of(cell);
  return words.size() == 1 && !unit_called(words.front()).empty();
}

std::string_view quantity_of(std::string_view ours) { return ours.substr(0, ours.find('_')); }

}  // namespace armsig::tool
