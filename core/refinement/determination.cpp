// SPDX-License-Identifier: MIT
#include "core/refinement/determination.hpp"

#include <cmath>

namespace armsig::refinement {

namespace {

// A target that a moving joint moves by less than this (as a radius) is on its axis.
constexpr double kOnAxis_m = 0.02;
// Residual sums above their expectation by so many of its sigma are no accident (1 in 2,000).
constexpr double kExcessSigmas = 3.3;
// Degrees of freedom from which on a sigma found from the residuals says what it is worth.
constexpr double kFewestFreedom = 3;

Open open_kind(const Problem& problem, const Parameter& parameter) {
  // Targets and receivers are counted apart: only an axis is in the tables of the joints.
  const bool of_axis = parameter.kind == ParameterKind::kAxisDirection ||
                       parameter.kind == ParameterKind::kAxisPosition;
  const bool at_rest = of_axis && problem.largest_motion()[parameter.index] == 0;
  const bool on_axis = of_axis && problem.largest_radius()[parameter.index] < kOnAxis_m;
  switch (parameter.kind) {
    case ParameterKind::kAxisDirection:
      if (at_rest) return Open::kJointAtRest;
      return on_axis ? Open::kTargetOnAxis : Open::kAxisDirection;
    case ParameterKind::kAxisPosition:
      if (at_rest) return Open::kJointAtRest;
      return on_axis ? Open::kTargetOnAxis : Open::kAxisPosition;
    case ParameterKind::kReadingGain:
      return Open::kReadingGain;
    case ParameterKind::kReadingFirst:
      return Open::kReadingFirst;
    case ParameterKind::kReadingSecond:
      return Open::kReadingSecond;
    case ParameterKind::kReceiverOffset:
      return Open::kReceiverOffset;
    case ParameterKind::kTarget:
    case ParameterKind::kScale:  // never listed: an unknown scale is an error
      return Open::kTarget;
  }
  return Open::kTarget;
}

}  // namespace

std::string_view describe(Open open) {
  switch (open) {
    case Open::kJointAtRest:
      return "its axis is not determined, because the joint did not move";
    case Open::kTargetOnAxis:
      return "rotation about its own axis is not determined by this target";
    case Open::kAxisDirection:
      return "the direction of its axis is not determined";
    case Open::kAxisPosition:
      return "the position of its axis is not determined";
    case Open::kReadingGain:
      return "the gain of its reading is not determined";
    case Open::kReadingFirst:
      return "the error of its reading once a turn is not determined";
    case Open::kReadingSecond:
      return "the error of its reading twice a turn is not determined";
    case Open::kTarget:
      return "the position of the target is not determined";
    case Open::kReceiverOffset:
      return "the offset of its range is not determined";
  }
  return "is not determined";
}

double parameter_sigma(const SquareRootFactor& information, std::size_t index) {
  StateVector y;
  y.fill(0);
  y[index] = 1;
  information.solve_transposed(y, index);
  double sum = 0;
  for (std::size_t k = index; k < information.unknowns(); ++k) sum += y[k] * y[k];
  return std::sqrt(sum);
}

Matrix3 covariance_of_three(const SquareRootFactor& information, std::size_t first) {
  std::array<StateVector, 3> y;
  for (std::size_t i = 0; i < 3; ++i) {
    y[i].fill(0);
    y[i][first + i] = 1;
    information.solve_transposed(y[i], first + i);
  }
  Matrix3 covariance;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      double sum = 0;
      for (std::size_t k = first; k < information.unknowns(); ++k) {
        sum += y[static_cast<std::size_t>(i)][k] * y[static_cast<std::size_t>(j)][k];
      }
      covariance(i, j) = sum;
    }
  }
  return covariance;
}

std::array<bool, kMaxParameters> find_undetermined(const Problem& problem, const Prior& prior,
                                                   Refined& refined) {
  std::array<bool, kMaxParameters> open{};
  refined.undetermined.clear();
  for (std::size_t i = 0; i < refined.layout.size(); ++i) {
    const Parameter& parameter = refined.layout.parameters[i];
    if (parameter.kind == ParameterKind::kScale) continue;
    const double sigma = parameter_sigma(refined.information, i);
    if (sigma < kOpenShare * prior_sigma(prior, parameter.kind)) continue;
    open[i] = true;
    const Undetermined found{open_kind(problem, parameter), parameter.index};
    bool listed = false;
    for (const Undetermined& earlier : refined.undetermined) {
      listed = listed || (earlier.open == found.open && earlier.index == found.index);
    }
    if (!listed) refined.undetermined.push_back(found);
  }
  return open;
}

void settle_covariance(double weighted_squares, Refined& refined) {
  FitQuality& quality = refined.quality;
  const auto freedom =
      static_cast<double>(quality.scalars) - static_cast<double>(refined.layout.size());
  if (freedom > 0) {
    const double variance_factor = weighted_squares / freedom;
    quality.noise_factor = std::sqrt(variance_factor);
    const bool excess = variance_factor > 1 + kExcessSigmas * std::sqrt(2 / freedom);
    quality.covariance_enlarged = excess && !quality.sigma_is_estimated;
    if ((excess || quality.sigma_is_estimated) && variance_factor > 0) {
      // The errors over a sigma found from few residuals follow Student's law, which is wider.
      const double wider =
          quality.sigma_is_estimated && freedom >= kFewestFreedom ? freedom / (freedom - 2) : 1;
      refined.information.scale(1 / (quality.noise_factor * std::sqrt(wider)));
    }
    if (excess || quality.sigma_is_estimated) quality.noise_freedom = freedom;
    if (quality.covariance_enlarged) {
      quality.unexplained_m = quality.sigma_m * std::sqrt(variance_factor - 1);
    }
    if (quality.sigma_is_estimated) {
      quality.sigma_m *= quality.noise_factor;
      quality.noise_factor = 1;
    }
  }
  refined.information.clear_right_hand_side();
  for (std::size_t t = 0; t < refined.signature.targets.size(); ++t) {
    const std::size_t column = refined.layout.target[t];
    if (column == kNoColumn) continue;
    refined.signature.targets[t].covariance_m2 = covariance_of_three(refined.information, column);
  }
}

}  // namespace armsig::refinement
