// SPDX-License-Identifier: MIT
#include "core/evaluation/indices.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace armsig::evaluation {
namespace {

// A line of vertices: the first one and the step between indices.
struct GridLine {
  std::size_t first = 0;
  std::size_t step = 0;
  std::size_t count = 0;
};

GridLine grid_line(const Grid& grid, std::size_t axis, std::array<std::size_t, 3> through) {
  through[axis] = 0;
  const std::array<std::size_t, 3> steps{1, grid.count[0], grid.count[0] * grid.count[1]};
  return {grid.index(through[0], through[1], through[2]), steps[axis], grid.count[axis]};
}

struct FittedLine {
  Vector3 centroid;
  Vector3 direction;  // unit, from the first vertex towards the last
};

// The line of least squared normal distances.
FittedLine fit(const GridLine& line, const FixedVector<Vector3, kMaxVertices>& p_W) {
  Vector3 centroid = Vector3::Zero();
  for (std::size_t n = 0; n < line.count; ++n) centroid += p_W[line.first + n * line.step];
  centroid /= static_cast<double>(line.count);
  Matrix3 scatter = Matrix3::Zero();
  for (std::size_t n = 0; n < line.count; ++n) {
    const Vector3 from_centroid = p_W[line.first + n * line.step] - centroid;
    scatter += from_centroid * from_centroid.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(scatter);
  Vector3 direction = eigen.eigenvectors().col(2);
  const Vector3 along = p_W[line.first + (line.count - 1) * line.step] - p_W[line.first];
  if (direction.dot(along) < 0) direction = -direction;
  return {centroid, direction};
}

double largest_normal_distance(const GridLine& line, const FittedLine& fitted,
                               const FixedVector<Vector3, kMaxVertices>& p_W) {
  double largest = 0;
  for (std::size_t n = 0; n < line.count; ++n) {
    const Vector3 from_centroid = p_W[line.first + n * line.step] - fitted.centroid;
    largest = std::max(largest, from_centroid.cross(fitted.direction).norm());
  }
  return largest;
}

double deviation_from_perpendicular(const Vector3& a, const Vector3& b) {
  return std::abs(std::atan2(a.dot(b), a.cross(b).norm()));
}

}  // namespace

void quantise(GridReadings& readings, const Resolution& resolution) {
  const auto round_to = [](Vector3& v, double step) {
    for (double& x : v) x = std::round(x / step) * step;
  };
  for (Vector3& p : readings.p_W) round_to(p, resolution.position_m);
  for (Vector3& turn : readings.turn_rad) round_to(turn, resolution.angle_rad);
}

Indices indices(const Grid& grid, const GridReadings& readings) {
  ARMSIG_CHECK(readings.p_W.size() == grid.vertex_count());
  ARMSIG_CHECK(readings.turn_rad.size() == grid.vertex_count());
  Indices result;
  for (std::size_t k = 0; k < grid.count[2]; ++k) {
    for (std::size_t j = 0; j < grid.count[1]; ++j) {
      for (std::size_t i = 0; i < grid.count[0]; ++i) {
        const std::size_t at = grid.index(i, j, k);
        result.radial_deviation_m =
            std::max(result.radial_deviation_m, (readings.p_W[at] - grid.vertex(i, j, k)).norm());
        result.orientation_deviation_rad =
            std::max(result.orientation_deviation_rad, readings.turn_rad[at].norm());

        // The three grid lines that cross here.
        std::array<FittedLine, 3> lines;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const GridLine line = grid_line(grid, axis, {i, j, k});
          lines[axis] = fit(line, readings.p_W);
          result.normal_deviation_m = std::max(
              result.normal_deviation_m, largest_normal_distance(line, lines[axis], readings.p_W));
        }
        for (std::size_t a = 0; a < 3; ++a) {
          result.perpendicular_deviation_rad = std::max(
              result.perpendicular_deviation_rad,
              deviation_from_perpendicular(lines[a].direction, lines[(a + 1) % 3].direction));
        }
      }
    }
  }
  return result;
}

}  // namespace armsig::evaluation
