// SPDX-License-Identifier: MIT
// The parts of check(const Configuration&): values by what is plausible, and the places that the
// arm is to be at. Each returns the first refusal.
#pragma once

#include "firmware/controller/configuration.hpp"
#include "firmware/controller/plausibility.hpp"

namespace armsig::controller {

using Checked = std::expected<void, ConfigurationRefusal>;

std::unexpected<ConfigurationRefusal> refused(std::string_view setting, Error error,
                                              std::optional<std::size_t> joint = {},
                                              double found = 0, double needed = 0);

Checked check_plausible(std::string_view setting, double value, const Bounds& bounds,
                        Error error = Error::kOutOfRange, std::optional<std::size_t> joint = {});

Checked check_each(std::string_view setting, const JointVector& values, const Arm& arm,
                   const JointBounds& bounds);

Checked check_count(std::string_view setting, std::size_t count, std::size_t least,
                    std::size_t most);

Checked check_readings(std::string_view setting, const JointVector& q, const Arm& arm);

// The signature configuration, from which all poses are come to, and the sweeps as planned: clear
// of what is around the arm.
Checked check_workspace(const Configuration& c);

// The grid-touching task, if one is set up.
Checked check_grid(const Configuration& c);

}  // namespace armsig::controller
