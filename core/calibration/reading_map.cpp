// SPDX-License-Identifier: MIT
#include "core/calibration/reading_map.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/pose.hpp"

namespace armsig::calibration {

namespace {

constexpr double kCorrelationLength = radians(15);
constexpr double kKnotSpacing = 2 * kPi / kKnots;
// A slide's domain beyond its limits: more than a correlation length on either side.
constexpr double kSlideMargin = 0.1;

// Integrals over the products of two splines k knots apart, of their slopes and curvatures.
constexpr std::array<double, kSplines> kValues{2416.0 / 5040, 1191.0 / 5040, 120.0 / 5040,
                                               1.0 / 5040};
constexpr std::array<double, kSplines> kSlopes{2.0 / 3, -1.0 / 8, -1.0 / 5, -1.0 / 120};
constexpr std::array<double, kSplines> kCurvatures{8.0 / 3, -3.0 / 2, 0, 1.0 / 6};

constexpr std::array<double, kSplines> kStencil = [] {
  constexpr double kKappa = std::numbers::sqrt3 / kCorrelationLength;
  constexpr double kH = kKnotSpacing;
  std::array<double, kSplines> stencil{};
  for (std::size_t k = 0; k < kSplines; ++k) {
    stencil[k] = (kKappa * kKappa * kKappa * kKappa * kH * kValues[k] +
                  2 * kKappa * kKappa / kH * kSlopes[k] + kCurvatures[k] / (kH * kH * kH)) /
                 (4 * kKappa * kKappa * kKappa);
  }
  return stencil;
}();

}  // namespace

double map_unit(JointType type) { return type == JointType::kRevolute ? radians(0.01) : 1e-4; }

MapDomain map_domain(JointType type, const JointLimits& limits) {
  if (type == JointType::kRevolute) return {0, kKnots / (2 * kPi)};
  const double range = limits.upper - limits.lower;
  if (!(range > 0) || !std::isfinite(range)) return {};
  return {limits.lower - kSlideMargin * range, kKnots / ((1 + 2 * kSlideMargin) * range)};
}

SplineSupport spline_support(const MapDomain& domain, double reading) {
  const double at = (reading - domain.origin) * domain.per_length;
  const double floor = std::floor(at);
  const double t = at - floor;
  const double s = 1 - t;
  const double turned = std::fmod(floor, static_cast<double>(kKnots));
  SplineSupport support;
  // A reading that is no number has weights that are none, at the first knot.
  support.first = static_cast<std::size_t>(turned >= 0 ? turned : std::max(0.0, turned + kKnots));
  support.weight = {s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6,
                    (4 - 6 * s * s + 3 * s * s * s) / 6, t * t * t / 6};
  return support;
}

double map_value(const MapCoefficients& coefficients, const SplineSupport& support) {
  double value = 0;
  for (std::size_t k = 0; k < kSplines; ++k) {
    value += support.weight[k] * coefficients[support.knot(k)];
  }
  return value;
}

std::array<double, kSplines> map_prior() { return kStencil; }

double map_prior_times(const MapCoefficients& x, std::size_t i) {
  double sum = kStencil[0] * x[i];
  for (std::size_t k = 1; k < kSplines; ++k) {
    sum += kStencil[k] * (x[(i + k) % kKnots] + x[(i + kKnots - k) % kKnots]);
  }
  return sum;
}

double map_prior_squares(const MapCoefficients& x) {
  double sum = 0;
  for (std::size_t i = 0; i < kKnots; ++i) sum += x[i] * map_prior_times(x, i);
  return sum;
}

}  // namespace armsig::calibration
