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

// Deviation of an axis line from its start, seen in the start's link frame: two components of its
// direction, two of its position.
struct AxisDeviation {
  Eigen::Vector4d value;
  Eigen::Matrix4d by_unknowns;  // by direction x, y, position x, y of the present link frame
};

AxisDeviation axis_deviation(const Pose& X_start, const Pose& X) {
  const Matrix3 R = X_start.R.transpose() * X.R;
  const Vector3 shift = X_start.R.transpose() * (X.p - X_start.p);
  AxisDeviation deviation;
  deviation.value << R(0, 2), R(1, 2), shift.x(), shift.y();
  deviation.by_unknowns.setZero();
  // Turning the axis by w moves its direction by w x z = (w_y, -w_x, 0) in its own frame.
  deviation.by_unknowns.block<2, 1>(0, 0) = -R.block<2, 1>(0, 1);
  deviation.by_unknowns.block<2, 1>(0, 1) = R.block<2, 1>(0, 0);
  deviation.by_unknowns.block<2, 2>(2, 2) = R.block<2, 2>(0, 0);
  return deviation;
}

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

void Problem::add_priors() {
  const Layout& layout = estimate_.layout;
  const std::size_t n = layout.size();
  for (std::size_t i = 0; i < estimate_.signature.joint_count(); ++i) {
    const AxisDeviation deviation = axis_deviation(start_.X_SL[i], estimate_.signature.X_SL[i]);
    const int count = estimate_.signature.types[i] == JointType::kRevolute ? 4 : 2;
    for (int k = 0; k < count; ++k) {
      RowBlock<1> block;
      block.clear(n);
      const double sigma = sigma_of_prior(layout.axis[i] + static_cast<std::size_t>(k));
      for (int c = 0; c < count; ++c) {
        block.rows[0][layout.axis[i] + static_cast<std::size_t>(c)] =
            deviation.by_unknowns(k, c) / sigma;
      }
      block.rows[0][n] = -deviation.value[k] / sigma;
      estimate_.information.absorb(block);
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Parameter& parameter = layout.parameters[i];
    if (parameter.kind == ParameterKind::kAxisDirection ||
        parameter.kind == ParameterKind::kAxisPosition) {
      continue;
    }
    RowBlock<1> block;
    block.clear(n);
    const double sigma = sigma_of_prior(i);
    block.rows[0][i] = 1 / sigma;
    block.rows[0][n] = -simple_deviation(parameter) / sigma;
    estimate_.information.absorb(block);
  }
}

double Problem::simple_deviation(const Parameter& parameter) const {
  switch (parameter.kind) {
    case ParameterKind::kTarget:
      return estimate_.signature.targets[parameter.index].p_S[parameter.component] -
             start_.targets[parameter.index].p_S[parameter.component];
    case ParameterKind::kReceiverOffset:
      return estimate_.receiver_offsets_m[parameter.index];
    case ParameterKind::kScale:
      return estimate_.scale;
    default:
      return correction_deviation(parameter, estimate_, config_);
  }
}

double Problem::prior_squares() const {
  double sum = 0;
  for (std::size_t i = 0; i < estimate_.signature.joint_count(); ++i) {
    const AxisDeviation deviation = axis_deviation(start_.X_SL[i], estimate_.signature.X_SL[i]);
    const int count = estimate_.signature.types[i] == JointType::kRevolute ? 4 : 2;
    for (int k = 0; k < count; ++k) {
      const std::size_t unknown = estimate_.layout.axis[i] + static_cast<std::size_t>(k);
      const double ratio = deviation.value[k] / sigma_of_prior(unknown);
      sum += ratio * ratio;
    }
  }
  for (std::size_t i = 0; i < estimate_.layout.size(); ++i) {
    const Parameter& parameter = estimate_.layout.parameters[i];
    if (parameter.kind == ParameterKind::kAxisDirection ||
        parameter.kind == ParameterKind::kAxisPosition) {
      continue;
    }
    const double ratio = simple_deviation(parameter) / sigma_of_prior(i);
    sum += ratio * ratio;
  }
  return sum;
}

}  // namespace armsig::refinement
