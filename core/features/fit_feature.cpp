// SPDX-License-Identifier: MIT
#include "core/features/fit_feature.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/features/centre_of_rotation.hpp"
#include "core/features/encoder_circle.hpp"
#include "core/features/encoder_line.hpp"
#include "core/features/encoder_ratio.hpp"
#include "core/features/paper_fit.hpp"
#include "core/features/plane_of_rotation.hpp"
#include "core/numerics/quantiles.hpp"

namespace armsig::features {
namespace {

// rounding_variance() is a bound, with a factor of 16 on sigma.
constexpr double kRoundingMargin = 256;

// Mean products of the residuals about a motion; the weights of the points are those of the fit.
Matrix3 mean_residual_products(const SweepStatistics& statistics,
                               const MotionRls::Coefficients& motion) {
  const Matrix3 R = statistics.motion.factor();
  const Matrix3 rest = R * motion - statistics.motion.rotated_right_hand_sides();
  const Matrix3 sums = rest.transpose() * rest + statistics.motion.residual_products();
  return sums / (R(0, 0) * R(0, 0));  // R(0, 0)^2 is the sum of the weights
}

// How far the points are from the plane (13) and from the circle (14) is the mechanism's and the
// sensor's doing; what remains about the fit itself has the encoder's part in it.
[[gnu::noinline]] Result<void> describe_circle(const SweepStatistics& statistics,
                                               const CircleFit& circle, JointFeature& feature) {
  feature.axis_S = circle.R_SC.col(2);
  feature.radial_S = circle.R_SC.col(0);
  feature.point_S = circle.centre_S;
  feature.radius_m = circle.radius_m;
  feature.covariance = circle.covariance;

  const Geometry geometry = statistics.geometry();
  ARMSIG_TRY(plane, plane_of_rotation(geometry));
  ARMSIG_TRY(best_circle, centre_of_rotation(geometry, plane, squared_distance_near_plane(plane)));
  const double weights = geometry.rows()[0][0];
  const double normal = plane_residual_squares(geometry, plane) / weights;
  const double in_plane = 2 * best_circle.radius_m;
  const double radial = best_circle.residual_squares / (in_plane * in_plane * weights);
  const double all = mean_residual_products(statistics, circle.motion(statistics.origin_S)).trace();
  feature.quality.rms_normal_m = std::sqrt(normal);
  feature.quality.rms_radial_m = std::sqrt(radial);
  feature.quality.rms_tangential_m = std::sqrt(std::max(all - normal - radial, 0.0));
  return {};
}

[[gnu::noinline]] void describe_line(const SweepStatistics& statistics, const LineFit& line,
                                     JointFeature& feature) {
  feature.axis_S = line.direction_S;
  feature.radial_S = any_perpendicular(line.direction_S);
  feature.point_S = line.point_S;
  feature.radius_m = 0;
  feature.covariance = line.covariance;

  const Matrix3 products = mean_residual_products(statistics, line.motion(statistics.origin_S));
  const double along = feature.axis_S.dot(products * feature.axis_S);
  feature.quality.rms_tangential_m = std::sqrt(std::max(along, 0.0));
  feature.quality.rms_normal_m = std::sqrt(std::max(products.trace() - along, 0.0));
}

// Functions of their own: a fit stands on the stack where it is computed and described only.
[[gnu::noinline]] Result<void> fit_circle(const SweepStatistics& statistics,
                                          JointFeature& feature) {
  ARMSIG_TRY(circle, statistics.method == Method::kPaper ? paper_circle(statistics)
                                                         : encoder_circle(statistics));
  return describe_circle(statistics, circle, feature);
}

[[gnu::noinline]] Result<void> fit_line(const SweepStatistics& statistics, JointFeature& feature) {
  ARMSIG_TRY(line, statistics.method == Method::kPaper ? paper_line(statistics)
                                                       : encoder_line(statistics));
  describe_line(statistics, line, feature);
  return {};
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
    const double significant =
        freedom > 0 ? numerics::chi_square_quantile(freedom, numerics::kNormal9999) / freedom : 0;
    if (freedom > 0 && shown - rounding > significant) {
      noise.is_estimated = true;
      noise.variance_factor = shown;
      noise.misfit = std::sqrt(shown);
    }
  }
  noise.sigma_m = std::sqrt(noise.variance_factor * stated);
  return noise;
}

std::optional<Refusal> fit_feature(const SweepStatistics& statistics, const NoiseLevel& noise,
                                   JointFeature& feature) {
  feature.type = statistics.type;
  feature.reference_reading = statistics.origin_reading;
  const Result<void> fitted = statistics.type == JointType::kRevolute
                                  ? fit_circle(statistics, feature)
                                  : fit_line(statistics, feature);
  if (!fitted) return refusal_of(fitted.error(), statistics);
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

  const bool finite = feature.axis_S.allFinite() && feature.point_S.allFinite() &&
                      feature.radial_S.allFinite() && std::isfinite(feature.radius_m) &&
                      feature.covariance.allFinite() && std::isfinite(quality.sigma_m) &&
                      std::isfinite(encoder.ratio) && std::isfinite(quality.encoder_ratio_sigma) &&
                      std::isfinite(quality.rms_normal_m) && std::isfinite(quality.rms_radial_m) &&
                      std::isfinite(quality.rms_tangential_m);
  if (!finite) return refusal_of(Error::kNotFinite, statistics);
  return std::nullopt;
}

ReadingMisfit reading_misfit(const SweepStatistics& statistics, const NoiseLevel& noise,
                             const JointFeature& feature) {
  const Vector3 along = feature.axis_S.cross(feature.radial_S);
  CircleFit circle;
  circle.R_SC << feature.radial_S, along, feature.axis_S;
  circle.centre_S = feature.point_S;
  circle.radius_m = feature.radius_m;
  const Matrix3 R = statistics.motion.factor();
  const Matrix3 rest =
      R * circle.motion(statistics.origin_S) - statistics.motion.rotated_right_hand_sides();
  const Matrix3 products = rest.transpose() * rest;
  return {std::sqrt(products.trace()) / (R(0, 0) * feature.radius_m),
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
