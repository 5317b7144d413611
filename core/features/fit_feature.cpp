// SPDX-License-Identifier: MIT
#include "core/features/fit_feature.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/features/gate.hpp"
#include "core/features/motion_fits.hpp"
#include "core/features/regressions.hpp"

namespace armsig::features {
namespace {

// rounding_variance() is a bound, with a factor of 16 on sigma.
constexpr double kRoundingMargin = 256;

// Sums of products of what imposing the feature's circle or line adds to the residuals of the
// unconstrained motion.
Matrix3 imposed_products(const SweepStatistics& statistics, const JointFeature& feature) {
  const Vector3 e = feature.radius_m * feature.radial_S;
  MotionRls::Coefficients motion;
  motion.row(0) = feature.point_S + e - statistics.origin_S;
  motion.row(1) =
      feature.type == JointType::kRevolute ? feature.axis_S.cross(e).eval() : feature.axis_S;
  motion.row(2) = -e;
  const Matrix3 rest =
      statistics.motion.factor() * motion - statistics.motion.rotated_right_hand_sides();
  return rest.transpose() * rest;
}

double sum_of_weights(const SweepStatistics& statistics) { return statistics.motion.rows()[0][0]; }

// Mean products of the residuals about the feature; the points' weights are those of the fit.
Matrix3 mean_residual_products(const SweepStatistics& statistics, const JointFeature& feature) {
  const Matrix3 sums =
      imposed_products(statistics, feature) + statistics.motion.residual_products();
  return sums / sum_of_weights(statistics);
}

// How far the points are from the plane (13) and from the circle (14) is the mechanism's and the
// sensor's doing; what remains about the fit itself has the encoder's part in it.
[[gnu::noinline]] Result<void> describe_circle(const SweepStatistics& statistics,
                                               JointFeature& feature) {
  const Geometry geometry = statistics.geometry();
  ARMSIG_TRY(plane, plane_of_rotation(geometry));
  ARMSIG_TRY(best_circle, centre_of_rotation(geometry, plane, squared_distance_near_plane(plane)));
  const double weights = sum_of_weights(statistics);
  const double normal = plane_residual_squares(geometry, plane) / weights;
  const double in_plane = 2 * best_circle.radius_m;
  const double radial = best_circle.residual_squares / (in_plane * in_plane * weights);
  const double all = mean_residual_products(statistics, feature).trace();
  feature.quality.rms_normal_m = std::sqrt(normal);
  feature.quality.rms_radial_m = std::sqrt(radial);
  feature.quality.rms_tangential_m = std::sqrt(std::max(all - normal - radial, 0.0));
  return {};
}

[[gnu::noinline]] void describe_line(const SweepStatistics& statistics, JointFeature& feature) {
  const Matrix3 products = mean_residual_products(statistics, feature);
  const double along = feature.axis_S.dot(products * feature.axis_S);
  feature.quality.rms_tangential_m = std::sqrt(std::max(along, 0.0));
  feature.quality.rms_normal_m = std::sqrt(std::max(products.trace() - along, 0.0));
}

Result<void> fit_motion(const SweepStatistics& statistics, JointFeature& feature) {
  const bool paper = statistics.method == Method::kPaper;
  if (!kHasPaperFit && paper) return std::unexpected(Error::kUnsupported);
  if (statistics.type == JointType::kPrismatic)
    return paper && kHasPaperFit ? paper_line(statistics, feature)
                                 : encoder_line(statistics, feature);
  return paper && kHasPaperFit ? paper_circle(statistics, feature)
                               : encoder_circle(statistics, feature);
}

Refusal refusal_of(Error error, const SweepStatistics& statistics) {
  // A singular fit of a motion that has moved is one of too short an arc.
  if (error == Error::kSingular)
    return {Error::kArcTooShort, statistics.arc(), 2 * statistics.arc()};
  return {error, 0, 0};
}

}  // namespace

NoiseLevel noise_level(const SweepStatistics& statistics, bool sigma_is_known) {
  NoiseLevel noise;
  const double freedom = statistics.motion_freedom();
  const double shown = freedom > 0 ? statistics.motion_chi_square() / freedom : 0;
  const double stated = statistics.mean_variance();
  SweepPoint farthest{
      std::max(std::abs(statistics.lowest_reading), std::abs(statistics.highest_reading)),
      statistics.origin_S, Matrix3::Identity()};
  const double rounding =
      rounding_variance(farthest, statistics.motion.solve().row(1).norm()) / stated;
  if (!sigma_is_known) {
    noise.is_estimated = true;
    noise.variance_factor = std::max(shown, rounding / kRoundingMargin);
  } else {
    noise.stated_sigma_m = std::sqrt(stated);
    if (freedom > 0 && exceeds_noise(freedom * (shown - rounding), freedom)) {
      noise.is_estimated = true;
      noise.variance_factor = shown;
      noise.misfit = std::sqrt(shown);
    }
  }
  noise.sigma_m = std::sqrt(noise.variance_factor * stated);
  return noise;
}

EncoderRatio encoder_ratio(const MotionStatistics& statistics) {
  const MotionRls::Coefficients phi = statistics.motion.solve();
  const Matrix3 R = statistics.motion.factor();
  const Matrix3 shape = statistics.shape();
  const Vector3 B = phi.row(1);
  const Vector3 b = B.normalized();
  // The coefficients have the covariance (R^T R)^-1 (x) shape. The inverse of a triangular factor
  // is triangular: that of its lower right corner belongs to the last coefficients alone.
  if (statistics.type == JointType::kPrismatic)
    return {B.norm(), std::sqrt(b.dot(shape * b)) / std::abs(R(1, 1))};

  const Vector3 A = -phi.row(2);
  const Vector3 a = A.normalized();
  Eigen::Matrix2d root;
  root << 1 / R(1, 1), -R(1, 2) / (R(1, 1) * R(2, 2)), 0, 1 / R(2, 2);
  // d ln(|A| / |B|) = a.dA / |A| - b.dB / |B|, with A the third coefficient negated.
  Eigen::Matrix<double, 2, 3> change;
  change << -b.transpose() / B.norm(), -a.transpose() / A.norm();
  const Eigen::Matrix<double, 2, 3> spread = root.transpose() * change;
  const double ratio = A.norm() / B.norm();
  return {ratio, ratio * std::sqrt((spread * shape * spread.transpose()).trace())};
}

std::optional<Refusal> fit_feature(const SweepStatistics& statistics, const NoiseLevel& noise,
                                   JointFeature& feature) {
  feature.type = statistics.type;
  feature.reference_reading = statistics.origin_reading;
  Result<void> fitted = fit_motion(statistics, feature);
  if (fitted && feature.type == JointType::kRevolute) fitted = describe_circle(statistics, feature);
  if (!fitted) return refusal_of(fitted.error(), statistics);
  if (feature.type == JointType::kPrismatic) describe_line(statistics, feature);
  feature.covariance *= noise.variance_factor;

  SweepQuality& quality = feature.quality;
  const EncoderRatio encoder = encoder_ratio(statistics);
  quality.encoder_ratio = encoder.ratio;
  quality.encoder_ratio_sigma = encoder.sigma * std::sqrt(noise.variance_factor);
  quality.used = statistics.count;
  quality.lowest_reading = statistics.lowest_reading;
  quality.highest_reading = statistics.highest_reading;
  quality.sigma_m = noise.sigma_m;
  quality.sigma_is_estimated = noise.is_estimated;

  const double sum = feature.axis_S.sum() + feature.point_S.sum() + feature.radial_S.sum() +
                     feature.radius_m + feature.covariance.sum() + quality.sigma_m + encoder.ratio +
                     quality.encoder_ratio_sigma + quality.rms_normal_m + quality.rms_radial_m +
                     quality.rms_tangential_m;
  if (!std::isfinite(sum)) return refusal_of(Error::kNotFinite, statistics);
  return std::nullopt;
}

ReadingMisfit reading_misfit(const SweepStatistics& statistics, const NoiseLevel& noise,
                             const JointFeature& feature) {
  const Matrix3 products = imposed_products(statistics, feature);
  return {std::sqrt(products.trace() / sum_of_weights(statistics)) / feature.radius_m,
          (statistics.shape().inverse() * products).trace() / noise.variance_factor};
}

double axis_direction_sigma(const JointFeature& feature) {
  const Vector3 x = any_perpendicular(feature.axis_S);
  const Vector3 y = feature.axis_S.cross(x);
  const Matrix3 rotation = feature.covariance.block<3, 3>(3, 3);
  const double xx = x.dot(rotation * x);
  const double yy = y.dot(rotation * y);
  const double xy = x.dot(rotation * y);
  return std::sqrt((xx + yy) / 2 + std::hypot((xx - yy) / 2, xy));
}

}  // namespace armsig::features
