// SPDX-License-Identifier: MIT
#include "core/features/sweep_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

#include "core/features/describe_fit.hpp"
#include "core/features/encoder_circle.hpp"
#include "core/features/encoder_line.hpp"
#include "core/features/paper_fit.hpp"

namespace armsig::features {
namespace {

std::unexpected<Refusal> refuse(Error error, double found, double needed) {
  return std::unexpected(Refusal{error, found, needed});
}
std::unexpected<Refusal> refuse_count(Error error, std::size_t found, std::size_t needed) {
  return refuse(error, static_cast<double>(found), static_cast<double>(needed));
}

// Judges the waiting points and takes them in, in the order of their arrival.
void settle(SweepState& state) {
  const Verdicts verdicts = judge_together(state.accepted, state.sigma_is_known, state.waiting);
  for (std::size_t i = 0; i < state.waiting.size(); ++i) {
    const SweepPoint& point = state.waiting[i];
    if (!verdicts[i]) {
      ++state.rejected;
      continue;
    }
    if (state.accepted.count == 0) state.accepted = SweepStatistics(state.accepted.type, point);
    state.accepted.add(point);
  }
  state.waiting.clear();
}

// What the readings and points show before any fit.
std::optional<Refusal> refusal_before_fit(const SweepConfig& config, const SweepState& state,
                                          std::size_t least_points) {
  const bool revolute = config.type == JointType::kRevolute;
  if (state.count < least_points)
    return Refusal{Error::kTooFewPoints, static_cast<double>(state.count),
                   static_cast<double>(least_points)};
  const double range = state.highest_reading - state.lowest_reading;
  if (range < kSameReading)
    return Refusal{Error::kJointDidNotMove, range,
                   revolute ? config.limits.least_arc_rad : kSameReading};
  const auto distinct = static_cast<double>(state.distinct_readings.size());
  const int unknowns = motion_unknowns(config.type);
  if (distinct < unknowns)
    return Refusal{Error::kTooFewPoints, distinct, static_cast<double>(unknowns)};
  if (state.all_equal) {
    const double sigma =
        state.sigma_is_known ? std::sqrt(state.latest_covariance_m2.trace() / 3) : 0;
    return Refusal{Error::kCoincidentPoints, 0, config.limits.least_radius_sigmas * sigma};
  }
  return std::nullopt;
}

}  // namespace

SweepEstimator::SweepEstimator(const SweepConfig& config) : config_(config) {
  state_.accepted.type = config.type;
}

Result<void> SweepEstimator::add(double reading, const Vector3& p_S, const Matrix3& covariance_m2) {
  if (!std::isfinite(reading) || !p_S.allFinite() || !covariance_m2.allFinite())
    return std::unexpected(Error::kNotFinite);
  const bool known = !covariance_m2.isZero(0);
  if (known && covariance_m2.llt().info() != Eigen::Success)
    return std::unexpected(Error::kSingular);

  SweepState& s = state_;
  if (s.count == 0) {
    s.sigma_is_known = known;
    s.lowest_reading = s.highest_reading = reading;
    s.first_S = p_S;
  }
  if (s.sigma_is_known && known) s.latest_covariance_m2 = covariance_m2;
  ++s.count;
  s.lowest_reading = std::min(s.lowest_reading, reading);
  s.highest_reading = std::max(s.highest_reading, reading);
  s.all_equal = s.all_equal && p_S == s.first_S;
  const auto is_same = [&](double seen) { return std::abs(seen - reading) < kSameReading; };
  if (!s.distinct_readings.full() &&
      std::none_of(s.distinct_readings.begin(), s.distinct_readings.end(), is_same))
    s.distinct_readings.push_back(reading);

  const SweepPoint point{reading, p_S, s.latest_covariance_m2};
  if (!predicts(s.accepted, point)) {
    s.waiting.push_back(point);
    if (s.waiting.full()) settle(s);
  } else if (passes_gate(s.accepted, s.sigma_is_known, point)) {
    s.accepted.add(point);
  } else {
    ++s.rejected;
  }
  return {};
}

Judged<JointFeature> SweepEstimator::estimate(Method method) const {
  const SweepLimits& limits = config_.limits;
  const bool revolute = config_.type == JointType::kRevolute;
  const std::size_t least_points = revolute ? limits.least_points : limits.least_points_prismatic;
  if (const auto refusal = refusal_before_fit(config_, state_, least_points))
    return std::unexpected(*refusal);

  SweepState settled = state_;
  settle(settled);
  const SweepStatistics& statistics = settled.accepted;
  const auto least_accepted = std::max(
      least_points, static_cast<std::size_t>(std::ceil((1 - limits.greatest_rejected) *
                                                       static_cast<double>(settled.count))));
  if (statistics.count < least_accepted)
    return refuse_count(Error::kTooManyOutliers, statistics.count, least_accepted);
  if (revolute && statistics.arc() < limits.least_arc_rad)
    return refuse(Error::kArcTooShort, statistics.arc(), limits.least_arc_rad);
  if (statistics.motion.rank() < motion_unknowns(config_.type))
    return refuse(Error::kArcTooShort, statistics.arc(),
                  std::max(limits.least_arc_rad, 2 * statistics.arc()));

  const NoiseLevel noise = noise_level(statistics, settled.sigma_is_known);
  if (noise.misfit > limits.greatest_misfit)
    return refuse(Error::kNotACircle, noise.misfit * noise.stated_sigma_m,
                  limits.greatest_misfit * noise.stated_sigma_m);
  const double least_radius = limits.least_radius_sigmas * noise.sigma_m;
  const double speed = statistics.motion.solve().row(1).norm();
  if (revolute && speed < least_radius) return refuse(Error::kRadiusTooSmall, speed, least_radius);
  if (!revolute && speed * statistics.arc() < least_radius)
    return refuse(Error::kCoincidentPoints, speed * statistics.arc(), least_radius);

  const Judged<JointFeature> feature = describe_fit(statistics, noise, method);
  if (!feature) return feature;
  if (revolute && feature->radius_m < least_radius)
    return refuse(Error::kRadiusTooSmall, feature->radius_m, least_radius);
  const double axis_sigma = axis_direction_sigma(*feature);
  // The axis of a circle shows in the sagitta, which grows with the square of the arc; that of a
  // line in its length.
  if (axis_sigma > limits.greatest_axis_sigma_rad) {
    const double shortfall = axis_sigma / limits.greatest_axis_sigma_rad;
    return refuse(Error::kArcTooShort, statistics.arc(),
                  statistics.arc() * (revolute ? std::sqrt(shortfall) : shortfall));
  }
  const SweepQuality& quality = feature->quality;
  if (std::abs(quality.encoder_ratio - 1) >
      limits.greatest_encoder_error + 5 * quality.encoder_ratio_sigma)
    return refuse(Error::kNotACircle, quality.encoder_ratio, 1);
  JointFeature result = *feature;
  result.quality.rejected = settled.rejected;
  return result;
}

}  // namespace armsig::features
