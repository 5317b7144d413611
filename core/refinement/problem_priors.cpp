// SPDX-License-Identifier: MIT
// The priors of the problem: how far the estimate has moved from its start, in sigma of the prior.
#include "core/refinement/problem.hpp"

namespace armsig::refinement {

namespace {

// 1 sigma of a scale about which nothing is known: that of an air temperature wrong by 30 K.
constexpr double kUnknownScale = 0.05;
// An unknown that the data leave open is held to a milliradian or millimetre by the default priors:
// what arms are made to, and far wider than what any determined combination of unknowns asks for.
constexpr double kHeldShare = 0.01;

double correction_deviation(const Parameter& parameter, const Refined& estimate,
                            const RefinementConfig& config) {
  const auto of = [&](const ReadingCorrection& c) {
    switch (parameter.kind) {
      case ParameterKind::kReadingGain:
        return c.gain;
      case ParameterKind::kReadingFirst:
        return parameter.component == 0 ? c.cos_1 : c.sin_1;
      default:
        return parameter.component == 0 ? c.cos_2 : c.sin_2;
    }
  };
  const double start =
      config.readings.corrections.empty() ? 0 : of(config.readings.corrections[parameter.index]);
  return of(estimate.readings.corrections[parameter.index]) - start;
}

}  // namespace

double prior_sigma(const Prior& prior, ParameterKind kind) {
  switch (kind) {
    case ParameterKind::kAxisDirection:
      return prior.direction_rad;
    case ParameterKind::kAxisPosition:
      return prior.position_m;
    case ParameterKind::kReadingGain:
      return prior.gain;
    case ParameterKind::kReadingFirst:
    case ParameterKind::kReadingSecond:
      return prior.periodic_rad;
    case ParameterKind::kTarget:
      return prior.target_m;
    case ParameterKind::kReceiverOffset:
      return prior.receiver_offset_m;
    case ParameterKind::kScale:
      return prior.scale > 0 ? prior.scale : kUnknownScale;
  }
  return 1;
}

double Problem::sigma_of_prior(std::size_t unknown) const {
  const double sigma = prior_sigma(config_.prior, estimate_.layout.parameters[unknown].kind);
  return held_[unknown] ? kHeldShare * sigma : sigma;
}

void Problem::hold(const std::array<bool, kMaxParameters>& open) {
  held_ = open;
  evaluate_priors();
}

void Problem::evaluate_priors() {
  for (std::size_t i = 0; i < estimate_.layout.size(); ++i) {
    prior_residuals_[i] = deviation(estimate_.layout.parameters[i]) / sigma_of_prior(i);
  }
}

// The filter is still empty, so that rows of one unknown each are its diagonal. They take the
// present link frames for those of the start, between which a prior as wide as these makes no
// difference.
void Problem::add_priors() {
  const std::size_t n = estimate_.layout.size();
  for (std::size_t i = 0; i < n; ++i) {
    estimate_.information.set_entry(i, i, 1 / sigma_of_prior(i));
    estimate_.information.set_entry(i, n, -prior_residuals_[i]);
  }
}

double Problem::deviation(const Parameter& parameter) const {
  const auto component = static_cast<Eigen::Index>(parameter.component);
  switch (parameter.kind) {
    case ParameterKind::kAxisDirection: {
      // Turning z by w adds w x z = (w_y, -w_x, 0).
      const Matrix3& R_start = start_.X_SL[parameter.index].R;
      const Vector3 z = estimate_.signature.X_SL[parameter.index].R.col(2);
      return component == 0 ? -R_start.col(1).dot(z) : R_start.col(0).dot(z);
    }
    case ParameterKind::kAxisPosition:
      return start_.X_SL[parameter.index].R.col(component).dot(
          estimate_.signature.X_SL[parameter.index].p - start_.X_SL[parameter.index].p);
    case ParameterKind::kTarget:
      return estimate_.signature.targets[parameter.index].p_S[component] -
             start_.targets[parameter.index].p_S[component];
    case ParameterKind::kReceiverOffset:
      return estimate_.receiver_offsets_m[parameter.index];
    case ParameterKind::kScale:
      return estimate_.scale;
    default:
      return correction_deviation(parameter, estimate_, config_);
  }
}

}  // namespace armsig::refinement
