// SPDX-License-Identifier: MIT
#include "firmware/formats/foreign_header.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include <fmt/format.h>

#include "firmware/formats/units.hpp"

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
    Synonym{"m", "m"},
    Synonym{"meter", "m"},
    Synonym{"metre", "m"},
    Synonym{"deg", "deg"},
    Synonym{"degree", "deg"},
    Synonym{"degrees", "deg"},
    Synonym{"\u00B0", "deg"},
    Synonym{"\xB0", "deg"},
    Synonym{"grad", ""},
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
};
constexpr std::array kNames{
    Synonym{"sweep", "sweep"},
    Synonym{"target", "target"},
    Synonym{"point", "target"},
    Synonym{"punkt", "target"},
    Synonym{"x", "x"},
    Synonym{"y", "y"},
    Synonym{"z", "z"},
    Synonym{"sigma", "sigma"},
    Synonym{"air", "air"},
    Synonym{"temperature", "air"},
    Synonym{"airtemperature", "air"},
    Synonym{"tair", "air"},
};
constexpr std::array<std::string_view, 6> kJointWords{"q", "j", "a", "joint", "axis", "achse"};

std::optional<std::string_view> translated(std::string_view word,
                                           std::span<const Synonym> synonyms) {
  const auto found = std::ranges::find(synonyms, word, &Synonym::theirs);
  if (found == synonyms.end() || found->ours.empty()) return std::nullopt;
  return found->ours;
}

// Lower-case words: runs of anything but blanks, brackets, commas, colons and underscores.
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words;
  bool inside = false;
  for (const char c : name) {
    if (std::string_view(" \t[](){},:_").find(c) != std::string_view::npos) {
      inside = false;
      continue;
    }
    if (!inside) words.emplace_back();
    inside = true;
    words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return words;
}

// 1 to n, or nothing.
std::optional<std::size_t> joint_of(std::string_view word, std::size_t joints) {
  for (const std::string_view prefix : kJointWords) {
    if (!word.starts_with(prefix)) continue;
    const std::string_view digits = word.substr(prefix.size());
    if (digits.size() != 1 || digits[0] < '1' || digits[0] > '9') continue;
    const auto joint = static_cast<std::size_t>(digits[0] - '0');
    if (joint <= joints) return joint;
  }
  return std::nullopt;
}

bool has_unit(Dimension dimension, std::string_view unit) {
  return std::ranges::any_of(units_of(dimension),
                             [&](const Unit& known) { return known.suffix == unit; });
}

}  // namespace

std::optional<std::string> our_name_of(std::string_view theirs, const JointTypes& types) {
  const std::vector<std::string> words = words_of(theirs);
  if (words.empty()) return std::nullopt;
  const auto unit = words.size() > 1 ? translated(words.back(), kUnits) : std::nullopt;
  std::string name;
  for (std::size_t k = 0; k < words.size() - (unit ? 1 : 0); ++k) name += words[k];

  if (const auto joint = joint_of(name, types.size())) {
    if (!unit || !has_unit(dimension_of(types[*joint - 1]), *unit)) return std::nullopt;
    return fmt::format("q{}_{}", *joint, *unit);
  }
  const auto ours = translated(name, kNames);
  if (!ours) return std::nullopt;
  const bool counted = *ours == "sweep" || *ours == "target";
  if (counted) return unit ? std::nullopt : std::optional<std::string>(*ours);
  const Dimension dimension = *ours == "air" ? Dimension::kTemperature : Dimension::kLength;
  if (!unit || !has_unit(dimension, *unit)) return std::nullopt;
  return fmt::format("{}_{}", *ours, *unit);
}

std::string_view quantity_of(std::string_view ours) { return ours.substr(0, ours.find('_')); }

}  // namespace armsig::tool
