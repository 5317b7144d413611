// SPDX-License-Identifier: MIT
#include "core/features/sweep_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/features/fit_feature.hpp"

namespace armsig::features {
namespace {

// 1 in 10^11 of 2 degrees of freedom: beyond any noise.
constexpr double kSignificantChiSquare = 50;

Refusal refusal_of(Error error, std::size_t found, std::size_t needed) {
  return {error, static_cast<double>(found), static_cast<double>(needed)};
}

std::size_t least_points(const SweepConfig& config) {
  return config.type == JointType::kRevolute ? config.limits.least_points
                                             : config.limits.least_points_prismatic;
}

// What the readings and points show before any of them is judged.
std::optional<Refusal> refusal_before_gate(const SweepConfig& config, const SweepState& state) {
  if (state.count < least_points(config))
    return refusal_of(Error::kTooFewPoints, state.count, least_points(config));
  const std::size_t readings = state.distinct_readings.size();
  const bool revolute = config.type == JointType::kRevolute;
  if (readings < 2)
    return Refusal{Error::kJointDidNotMove, 0,
                   revolute ? config.limits.least_arc_rad : kSameReading};
  const auto unknowns = static_cast<std::size_t>(motion_unknowns(config.type));
  if (readings < unknowns) return refusal_of(Error::kTooFewPoints, readings, unknowns);
  return std::nullopt;
}

// What the unconstrained motion of the accepted points shows.
[[gnu::noinline]] std::optional<Refusal> refusal_before_fit(const SweepLimits& limits,
                                                            const SweepStatistics& statistics,
                                                            const NoiseLevel& noise) {
  const bool revolute = statistics.type == JointType::kRevolute;
  const double speed = statistics.motion.solve().row(1).norm();
  if (speed == 0)  // the points are all the same
    return Refusal{Error::kCoincidentPoints, 0, limits.least_radius_sigmas * noise.stated_sigma_m};
  // A little slack, because readings come rounded.
  const double arc = statistics.arc() * (1 + 1e-9);
  if (revolute && arc < limits.least_arc_rad)
    return Refusal{Error::kArcTooShort, arc, limits.least_arc_rad};
  if (statistics.motion.rank() < motion_unknowns(statistics.type))
    return Refusal{Error::kArcTooShort, arc, std::max(limits.least_arc_rad, 2 * arc)};

  const double greatest_m = std::max(limits.greatest_misfit * noise.stated_sigma_m,
                                     revolute ? limits.greatest_reading_error_rad * speed : 0.0);
  if (noise.misfit * noise.stated_sigma_m > greatest_m)
    return Refusal{Error::kNotACircle, noise.misfit * noise.stated_sigma_m, greatest_m};
  const double size = revolute ? speed : speed * arc;
  const double least_size = limits.least_radius_sigmas * noise.sigma_m;
  if (size < least_size)
    return Refusal{revolute ? Error::kRadiusTooSmall : Error::kCoincidentPoints, size, least_size};
  const double greatest_sigma = limits.greatest_unstated_sigma * size;
  if (noise.stated_sigma_m == 0 && noise.sigma_m > greatest_sigma)
    return Refusal{Error::kNotACircle, noise.sigma_m, greatest_sigma};

  const EncoderRatio encoder = encoder_ratio(statistics);
  const double sigma = encoder.sigma * std::sqrt(noise.variance_factor);
  if (std::abs(encoder.ratio - 1) > limits.greatest_encoder_error + 5 * sigma)
    return Refusal{Error::kNotACircle, encoder.ratio, 1};
  return std::nullopt;
}

// What the fit shows.
[[gnu::noinline]] std::optional<Refusal> refusal_of_fit(const SweepLimits& limits,
                                                        const SweepStatistics& statistics,
                                                        const NoiseLevel& noise,
                                                        const JointFeature& feature) {
  const bool revolute = feature.type == JointType::kRevolute;
  const double least_radius = limits.least_radius_sigmas * feature.quality.sigma_m;
  if (revolute && feature.radius_m < least_radius)
    return Refusal{Error::kRadiusTooSmall, feature.radius_m, least_radius};
  if (revolute && statistics.method == Method::kEncoder) {
    const ReadingMisfit misfit = reading_misfit(statistics, noise, feature);
    if (misfit.rms_rad > limits.greatest_reading_misfit_rad &&
        misfit.chi_square > kSignificantChiSquare)
      return Refusal{Error::kNotACircle, misfit.rms_rad, limits.greatest_reading_misfit_rad};
  }
  // The axis of a circle shows in the sagitta, which grows with the square of the arc; that of a
  // line in its length.
  const double shortfall = axis_direction_sigma(feature) / limits.greatest_axis_sigma_rad;
  if (shortfall > 1) {
    const double arc = feature.quality.arc();
    // No arc makes up for a target that is next to the axis.
    if (revolute && (feature.radius_m < kNextToAxis_m || arc * std::sqrt(shortfall) > 2 * kPi))
      return Refusal{Error::kRadiusTooSmall, feature.radius_m, feature.radius_m * shortfall};
    return Refusal{Error::kArcTooShort, arc, arc * (revolute ? std::sqrt(shortfall) : shortfall)};
  }
  return std::nullopt;
}

// So many points, fitted unseen, are asked whether they agree; those after them are judged by them.
constexpr std::size_t kFirstPoints = 8;
// So many are taken in without a second look at those before them: half of what may wait at most.
constexpr std::size_t kLookedAtOnce = 64;
static_assert(kGateCapacity <= kLookedAtOnce || kGateCapacity == 2 * kLookedAtOnce);

}  // namespace

SweepEstimator::SweepEstimator(const SweepConfig& config) : config_(config) {
  state_.accepted = SweepStatistics(config.type, config.method);
}

Result<void> SweepEstimator::add(double reading, const Vector3& p_S, const Matrix3& covariance_m2) {
  SweepState& s = state_;
  if (!std::isfinite(reading) || !p_S.allFinite()) return std::unexpected(Error::kNotFinite);
  // What was looked at with the point before needs no second look.
  bool known = s.sigma_is_known && same_bits(covariance_m2, s.latest_covariance_m2);
  if (!known) {
    if (!covariance_m2.allFinite()) return std::unexpected(Error::kNotFinite);
    known = Information(covariance_m2).is_positive_definite();
    if (!known && !covariance_m2.isZero(0)) return std::unexpected(Error::kSingular);
    if (s.count == 0) s.sigma_is_known = known;
    if (s.sigma_is_known && known) s.latest_covariance_m2 = covariance_m2;
  }

  ++s.count;
  const auto is_same = [&](double seen) { return std::abs(seen - reading) < kSameReading; };
  if (!s.distinct_readings.full() && std::ranges::none_of(s.distinct_readings, is_same))
    s.distinct_readings.push_back(reading);

  const SweepPoint point{reading, p_S, s.latest_covariance_m2};
  if (s.waiting_is_accepted || s.accepted.count == 0) {
    take_while_waiting(point);
    return {};
  }
  const Trial trial = s.accepted.tried(point);
  if (!is_close(trial)) {
    s.waiting.push_back(point);
    if (s.waiting.full()) settle();
  } else if (passes_gate(s.accepted, s.sigma_is_known, point, trial)) {
    s.accepted.add(point, trial);
  } else {
    ++s.rejected;
  }
  return {};
}

// One of the first points, of which none is accepted for good.
void SweepEstimator::take_while_waiting(const SweepPoint& point) {
  SweepState& s = state_;
  if (s.count == 1) s.waiting_is_accepted = s.sigma_is_known;
  s.waiting.push_back(point);
  if (s.waiting_is_accepted && !agrees(point)) {
    s.waiting_is_accepted = false;
    s.accepted = SweepStatistics(config_.type, config_.method);
  }
  if (!s.waiting.full()) return;
  if (!s.waiting_is_accepted) return settle();
  s.waiting.clear();
  s.waiting_is_accepted = false;
}

// With those before it, which it joins if so.
bool SweepEstimator::agrees(const SweepPoint& point) {
  SweepStatistics& accepted = state_.accepted;
  const std::size_t place = state_.waiting.size();
  if (place <= kFirstPoints) {
    accepted.add(point);
    return place < kFirstPoints || is_consistent(accepted);
  }
  const Trial trial = accepted.tried(point);
  if (!std::isfinite(trial.innovation().leverage) || !passes_gate(accepted, true, point, trial))
    return false;
  accepted.add(point, trial);
  return place <= kLookedAtOnce || two_still_agree();
}

// With each point of the second half, two are examined again: when the last one comes, all have
// been, and none has to wait any longer.
bool SweepEstimator::two_still_agree() const {
  const std::size_t first = 2 * (state_.waiting.size() - kLookedAtOnce - 1);
  return is_confirmed(state_.accepted, state_.waiting[first]) &&
         is_confirmed(state_.accepted, state_.waiting[first + 1]);
}

// A function of its own, as are others on the way to a feature: what it keeps on the stack would
// stand there whenever a point is added.
[[gnu::noinline]] void SweepEstimator::settle() {
  Settling settling(state_);
  while (settling.step()) {
  }
  state_.accepted = settling.accepted();
  state_.rejected = settling.rejected();
  state_.waiting.clear();
}

Judged<JointFeature> SweepEstimator::estimate() const {
  SweepEstimation estimation(*this);
  while (estimation.step()) {
  }
  return estimation.result();
}

SweepEstimation::SweepEstimation(const SweepEstimator& estimator)
    : config_(estimator.config_), state_(estimator.state_) {}

bool SweepEstimation::step() {
  if (result_) return false;
  if (!settling_) {
    if (const auto refusal = refusal_before_gate(config_, state_)) {
      result_.emplace(std::unexpected(*refusal));
      return false;
    }
    settling_.emplace(state_);
    return true;
  }
  if (settling_->step()) return true;
  fit();
  return false;
}

void SweepEstimation::fit() {
  result_.emplace();
  if (const auto refusal = fit_accepted(**result_)) *result_ = std::unexpected(*refusal);
}

std::optional<Refusal> SweepEstimation::fit_accepted(JointFeature& feature) const {
  const SweepLimits& limits = config_.limits;
  const SweepStatistics& statistics = settling_->accepted();
  const double kept = (1 - limits.greatest_rejected) * static_cast<double>(state_.count);
  const std::size_t least_accepted =
      std::max(least_points(config_), static_cast<std::size_t>(std::ceil(kept)));
  if (statistics.count < least_accepted)
    return refusal_of(Error::kTooManyOutliers, statistics.count, least_accepted);

  const NoiseLevel noise = noise_level(statistics, state_.sigma_is_known);
  if (const auto refusal = refusal_before_fit(limits, statistics, noise)) return refusal;
  if (const auto refusal = fit_feature(statistics, noise, feature)) return refusal;
  feature.quality.rejected = settling_->rejected();
  return refusal_of_fit(limits, statistics, noise, feature);
}

}  // namespace armsig::features
