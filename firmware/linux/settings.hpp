// SPDX-License-Identifier: MIT
// Optional settings of a map of the configuration file, read into the places of their defaults.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/controller/plausibility.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "hal/clock.hpp"

namespace armsig::daemon {

// What is absent keeps the value that it has. The first problem is kept, what comes after it is not
// read.
class Settings {
 public:
  explicit Settings(const tool::YamlMap& map) : map_(map) {}

  // A quantity with its unit in the key; `positive` refuses zero and below.
  Settings& quantity(std::string_view name, tool::Dimension dimension, double& value,
                     bool positive = true);
  // Above zero, at most a day.
  Settings& time(std::string_view name, hal::Duration& value);
  // A number without a unit, above zero.
  Settings& share(std::string_view key, double& value);
  // Refuses what the file tells under `name` (with a unit of `dimension`, where it has one) if it,
  // now `value` in SI units, is out of `bounds`.
  Settings& bound(std::string_view name, std::optional<tool::Dimension> dimension, double value,
                  const controller::Bounds& bounds);
  // "yes" or "no", "true" or "false".
  Settings& flag(std::string_view key, bool& value);
  Settings& text(std::string_view key, std::string& value);

  template <typename T>
  Settings& integer(std::string_view key, int lowest, int highest, T& value) {
    const tool::YamlNode* node = problem_ ? nullptr : map_.find(key);
    if (node == nullptr) return *this;
    if (const auto read = keep(tool::read_integer(*node, key, lowest, highest))) {
      value = static_cast<T>(*read);
    }
    return *this;
  }

  [[nodiscard]] tool::Read<void> done() const;

 private:
  template <typename T>
  std::optional<T> keep(tool::Read<T> read) {
    if (read) return *std::move(read);
    problem_ = std::move(read).error();
    return std::nullopt;
  }

  const tool::YamlMap& map_;
  std::optional<tool::Problem> problem_;
};

}  // namespace armsig::daemon
