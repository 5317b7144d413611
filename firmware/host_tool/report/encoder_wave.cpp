// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/encoder_wave.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace armsig::tool {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kLeastPoints = 10;
constexpr double kArcOfAWave_rad = kPi;

struct CircleRows {
  Vector6 radial;
  Vector6 tangential;
};

// Derivatives of both residuals by shift x, y, turn, radius, cosine, sine.
CircleRows rows_at(double reading_rad, double radius_m) {
  const double c = std::cos(reading_rad);
  const double s = std::sin(reading_rad);
  CircleRows rows;
  rows.radial << c, s, 0, 1, 0, 0;
  rows.tangential << -s, c, radius_m, 0, radius_m * c, radius_m * s;
  return rows;
}

}  // namespace

CircleResidual EncoderWave::residual_at(double reading_rad, double radius_m) const {
  const CircleRows rows = rows_at(reading_rad, radius_m);
  Vector6 x;
  x << absorbed, absorbed_radius_m, cosine_rad, sine_rad;
  return {reading_rad, rows.radial.dot(x), rows.tangential.dot(x)};
}

std::optional<EncoderWave> fit_encoder_wave(std::span<const CircleResidual> residuals,
                                            double radius_m) {
  if (residuals.size() < kLeastPoints || radius_m <= 0) return std::nullopt;
  const auto [first, last] =
      std::ranges::minmax_element(residuals, {}, &CircleResidual::reading_rad);
  if (last->reading_rad - first->reading_rad < kArcOfAWave_rad) return std::nullopt;

  Matrix6 normal = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  double sum_m2 = 0;
  for (const CircleResidual& residual : residuals) {
    const CircleRows rows = rows_at(residual.reading_rad, radius_m);
    normal += rows.radial * rows.radial.transpose() + rows.tangential * rows.tangential.transpose();
    right += rows.radial * residual.radial_m + rows.tangential * residual.tangential_m;
    sum_m2 += residual.radial_m * residual.radial_m + residual.tangential_m * residual.tangential_m;
  }
  const Eigen::LDLT<Matrix6> solver(normal);
  if (solver.info() != Eigen::Success) return std::nullopt;
  const Vector6 x = solver.solve(right);
  const auto freedom = static_cast<double>(2 * residuals.size() - 6);
  const double variance_m2 = std::max(sum_m2 - right.dot(x), 0.0) / freedom;
  const Eigen::Matrix2d covariance =
      variance_m2 * Matrix6(solver.solve(Matrix6::Identity())).bottomRightCorner<2, 2>();
  if (!(covariance.determinant() > 0)) return std::nullopt;

  EncoderWave wave;
  wave.absorbed = x.head<3>();
  wave.absorbed_radius_m = x[3];
  wave.cosine_rad = x[4];
  wave.sine_rad = x[5];
  const Eigen::Vector2d amplitude = x.tail<2>();
  wave.chi_square = amplitude.dot(covariance.inverse() * amplitude);
  wave.sigma_rad = std::sqrt(covariance.trace() / 2);
  return wave;
}

}  // namespace armsig::tool
