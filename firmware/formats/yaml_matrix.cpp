// SPDX-License-Identifier: MIT
#include "firmware/formats/yaml_matrix.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include "core/base/error.hpp"

namespace armsig::tool {

Read<Matrix3> read_rotation(const YamlMap& map, std::string_view z_key) {
  ARMSIG_TRY(x, map.vector3("x_direction"));
  ARMSIG_TRY(y, map.vector3("y_direction"));
  ARMSIG_TRY(z, map.vector3(z_key));
  Matrix3 R;
  R << x, y, z;
  constexpr double kTolerance = 1e-9;
  if (!(R.transpose() * R).isIdentity(kTolerance) || R.determinant() < 0) {
    return problem_at(map.node(),
                      fmt::format("x_direction, y_direction and {} of {} are no right-handed frame",
                                  z_key, map.name()),
                      "perpendicular unit vectors");
  }
  return R;
}

Read<Eigen::MatrixXd> read_covariance(const YamlNode& node, std::string_view what,
                                      std::size_t lowest, std::size_t highest) {
  ARMSIG_TRY(rows, read_list(node, what, lowest, highest));
  const auto size = static_cast<Eigen::Index>(rows->size());
  Eigen::MatrixXd matrix(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const YamlNode& row = (*rows)[static_cast<std::size_t>(i)];
    ARMSIG_TRY(values, read_numbers(row, what, rows->size()));
    for (Eigen::Index j = 0; j < size; ++j) matrix(i, j) = values[static_cast<std::size_t>(j)];
    if (matrix(i, i) < 0)
      return problem_at(row, fmt::format("{}: a negative variance", what), "0 or above");
  }
  return matrix;
}

}  // namespace armsig::tool
