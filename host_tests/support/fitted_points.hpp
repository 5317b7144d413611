// SPDX-License-Identifier: MIT
// Points of a sweep that no gate has touched, as what is kept of them.
#pragma once

#include "core/features/motion_fits.hpp"
#include "core/features/sweep_statistics.hpp"
#include "host_tests/support/simulated_sweep.hpp"

namespace armsig::test {

struct CirclePoint {
  double reading;
  double p_S[3];
};

// A noisy circle (sigma 0.2 mm) about (0.3, -0.2, 2.5), radius 0.4, over 99 degrees.
inline constexpr CirclePoint kNoisyCircle[] = {
    {12.00000, {0.12111, -0.55771, 2.49995}}, {12.15708, {0.13535, -0.55956, 2.43874}},
    {12.31416, {0.15401, -0.55206, 2.37927}}, {12.47124, {0.17593, -0.53640, 2.32285}},
    {12.62832, {0.20119, -0.51257, 2.27055}}, {12.78540, {0.22885, -0.48085, 2.22388}},
    {12.94248, {0.25764, -0.44213, 2.18382}}, {13.09956, {0.28830, -0.39746, 2.15224}},
    {13.25664, {0.31900, -0.34772, 2.12824}}, {13.41372, {0.34902, -0.29453, 2.11447}},
    {13.57080, {0.37777, -0.23913, 2.10944}}, {13.72788, {0.40493, -0.18238, 2.11428}},
};

inline features::SweepStatistics noisy_circle(
    features::Method method = features::Method::kEncoder) {
  features::SweepStatistics statistics(JointType::kRevolute, method);
  for (const CirclePoint& row : kNoisyCircle)
    statistics.add({row.reading, Vector3(row.p_S), isotropic(2e-4)});
  return statistics;
}

inline features::SweepStatistics exact_points(const TrueMotion& motion, double range,
                                              std::size_t count,
                                              features::Method method = features::Method::kPaper) {
  features::SweepStatistics statistics(motion.type, method);
  for (std::size_t i = 0; i < count; ++i) {
    const double reading = even_reading(motion, range, i, count);
    const features::SweepPoint point{reading, motion.at(reading), Matrix3::Identity()};
    statistics.add(point);
  }
  return statistics;
}

// What one of the fits of motion_fits.hpp says.
template <typename Fit, typename Statistics>
Result<features::JointFeature> fitted_by(Fit& fit, const Statistics& statistics) {
  features::JointFeature feature;
  if (const Result<void> done = fit(statistics, feature); !done)
    return std::unexpected(done.error());
  return feature;
}

inline TrueMotion circle_about(const Vector3& axis) {
  TrueMotion motion;
  motion.point_S = Vector3(0.1, -0.2, 2.5);
  motion.radius_m = 0.5;
  motion.R_SC.col(0) = any_perpendicular(axis);
  motion.R_SC.col(1) = axis.cross(motion.R_SC.col(0));
  motion.R_SC.col(2) = axis;
  return motion;
}

}  // namespace armsig::test
