// SPDX-License-Identifier: MIT
#include "firmware/linux/settings.hpp"

#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "firmware/formats/text.hpp"

namespace armsig::daemon {

using tool::Dimension;
using tool::in_quotes;
using tool::YamlNode;

Settings& Settings::quantity(std::string_view name, Dimension dimension, double& value,
                             bool positive) {
  if (problem_) return *this;
  const auto found = keep(map_.find_quantity(name, dimension));
  if (!found || !*found) return *this;
  const tool::YamlQuantity& told = **found;
  const auto number = keep(tool::read_number(*told.value, told.key->text));
  if (!number) return *this;
  if (positive && !(*number > 0)) {
    problem_ = tool::problem_at(*told.value, fmt::format("{}: {}", told.key->text, *number),
                                "a number above 0")
                   .error();
    return *this;
  }
  value = told.unit.to_si(*number);
  return *this;
}

Settings& Settings::time(std::string_view name, hal::Duration& value) {
  constexpr double kDay_s = 86'400;
  double seconds = hal::seconds(value);
  quantity(name, Dimension::kTime, seconds);
  if (problem_) return *this;
  if (seconds > kDay_s) {
    const auto told = *map_.require_quantity(name, Dimension::kTime);
    problem_ =
        tool::problem_at(*told.value, fmt::format("{}: {}", told.key->text, told.value->text),
                         "at most a day")
            .error();
    return *this;
  }
  value = hal::Duration(std::llround(1e9 * seconds));
  return *this;
}

Settings& Settings::share(std::string_view key, double& value) {
  const YamlNode* node = problem_ ? nullptr : map_.find(key);
  if (node == nullptr) return *this;
  const auto number = keep(tool::read_number(*node, key));
  if (!number) return *this;
  if (!(*number > 0)) {
    problem_ =
        tool::problem_at(*node, fmt::format("{}: {}", key, *number), "a number above 0").error();
    return *this;
  }
  value = *number;
  return *this;
}

Settings& Settings::bound(std::string_view name, std::optional<Dimension> dimension, double value,
                          const controller::Bounds& bounds) {
  if (problem_ || (value >= bounds.lowest && value <= bounds.highest)) return *this;
  const YamlNode* node = map_.find(name);
  if (dimension) {
    const auto found = map_.find_quantity(name, *dimension);
    node = found && *found ? (*found)->value : nullptr;
  }
  if (node == nullptr) return *this;
  problem_ = tool::problem_at(*node, fmt::format("{}: {:.6g}", name, value),
                              fmt::format("from {:.6g} to {:.6g} (radians, metres, seconds): {}",
                                          bounds.lowest, bounds.highest, bounds.reason))
                 .error();
  return *this;
}

Settings& Settings::flag(std::string_view key, bool& value) {
  const YamlNode* node = problem_ ? nullptr : map_.find(key);
  if (node == nullptr) return *this;
  const std::string& text = node->text;
  if (text == "yes" || text == "true") {
    value = true;
  } else if (text == "no" || text == "false") {
    value = false;
  } else {
    problem_ =
        tool::problem_at(*node, fmt::format("{}: {}", key, in_quotes(text)), "yes or no").error();
  }
  return *this;
}

Settings& Settings::text(std::string_view key, std::string& value) {
  const YamlNode* node = problem_ ? nullptr : map_.find(key);
  if (node == nullptr) return *this;
  if (auto told = keep(tool::read_text(*node, key))) value = *std::move(told);
  return *this;
}

tool::Read<void> Settings::done() const {
  if (problem_) return std::unexpected(*problem_);
  return {};
}

}  // namespace armsig::daemon
