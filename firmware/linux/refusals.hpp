// SPDX-License-Identifier: MIT
// What the portable checks refuse, told at its place in the configuration file.
#pragma once

#include <span>
#include <string>

#include "firmware/formats/yaml_tree.hpp"
#include "firmware/linux/daemon_configuration.hpp"

namespace armsig::daemon {

// In what the file tells the box of `workspace`: metres where its sides are, else mm.
[[nodiscard]] tool::LengthWords lengths_of(const tool::YamlNode& root);

[[nodiscard]] tool::Problem problem_of(const controller::ConfigurationRefusal& refusal,
                                       const tool::YamlNode& root);
// Of `drives`, on `interfaces`.
[[nodiscard]] tool::Problem problem_of(const canopen::ConfigurationRefusal& refusal,
                                       const tool::YamlNode& root,
                                       const canopen::Configuration& drives,
                                       std::span<const std::string> interfaces);

}  // namespace armsig::daemon
