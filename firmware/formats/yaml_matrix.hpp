// SPDX-License-Identifier: MIT
// Matrices in a YAML tree: lists of rows, or named columns.
#pragma once

#include <cstddef>
#include <string_view>

#include <Eigen/Core>

#include "core/base/pose.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/yaml_map.hpp"

namespace armsig::tool {

// The rotation whose columns stand under x_direction, y_direction and `z_key`; as written, and
// refused unless it is a rotation within 1e-9.
[[nodiscard]] Read<Matrix3> read_rotation(const YamlMap& map, std::string_view z_key);

// A square matrix, a list of rows, of `lowest` to `highest` rows, with no negative variance on its
// diagonal.
[[nodiscard]] Read<Eigen::MatrixXd> read_covariance(const YamlNode& node, std::string_view what,
                                                    std::size_t lowest, std::size_t highest);

}  // namespace armsig::tool
