// SPDX-License-Identifier: MIT
// What a joint's reading is wrong by, as a smooth function of the reading itself (docs/model.md,
// section 7): gears, encoder disc, wave generator.
//
// A periodic cubic spline of kKnots B-splines over one turn of a revolute joint, over the range of
// a slide; at any reading four of them are not zero. Their prior is a Matern process of order 3/2,
// whose precision in this basis is a cyclic band of seven diagonals (Rasmussen and Williams,
// Gaussian Processes for Machine Learning, 2006, section 4.2 and appendix B; the integrals of
// products of cubic B-splines are those of de Boor, A Practical Guide to Splines).
#pragma once

#include <array>
#include <cstddef>

#include "core/base/arm.hpp"

namespace armsig::calibration {

inline constexpr std::size_t kKnots = 120;
inline constexpr std::size_t kSplines = 4;  // that are not zero at a reading

// Coefficients of one joint, in units of map_unit().
using MapCoefficients = std::array<double, kKnots>;

// 0.01 degrees; 0.1 mm for a slide.
[[nodiscard]] double map_unit(JointType type);

// Where the reading of a joint is on its map.
struct MapDomain {
  double origin = 0;      // reading of knot 0
  double per_length = 0;  // knots per radian or metre; 0: the joint has no map
};

// One turn; or a slide's limits and a margin, so that its ends do not meet.
[[nodiscard]] MapDomain map_domain(JointType type, const JointLimits& limits);

// The splines that are not zero at a reading: knots first, first + 1, ... modulo kKnots.
struct SplineSupport {
  std::size_t first = 0;
  std::array<double, kSplines> weight{};

  [[nodiscard]] std::size_t knot(std::size_t k) const { return (first + k) % kKnots; }
};
[[nodiscard]] SplineSupport spline_support(const MapDomain& domain, double reading);

// The map [rad or m] at a reading, without the unit: in units of map_unit().
[[nodiscard]] double map_value(const MapCoefficients& coefficients, const SplineSupport& support);

// Q_i,i ... Q_i,i+3 of the prior's precision, for a point standard deviation of one unit.
[[nodiscard]] std::array<double, kSplines> map_prior();

// x^T Q x.
[[nodiscard]] double map_prior_squares(const MapCoefficients& x);

// (Q x)_i.
[[nodiscard]] double map_prior_times(const MapCoefficients& x, std::size_t i);

}  // namespace armsig::calibration
