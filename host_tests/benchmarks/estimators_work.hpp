// SPDX-License-Identifier: MIT
// The work of the estimators' rows: one function of the angle sampled with noise; points on a
// circle of half a metre seen over 90 degrees with 0.1 mm of noise.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "core/features/encoder_circle.hpp"

namespace armsig::benchmarks {

inline constexpr std::size_t kRlsRows = 256;  // a power of two
inline constexpr const char* kRlsPath = "RLS update, three regressors";

struct RlsWork {
  std::array<Vector3, kRlsRows> regressors;
  std::array<double, kRlsRows> measured;
};
const RlsWork& rls_work();

inline constexpr std::array<std::size_t, 2> kCirclePoints = {36, 360};
inline std::string circle_path(std::size_t points) {
  return "encoder-referenced circle, " + std::to_string(points) + " points";
}

struct CircleWork {
  std::vector<features::SweepPoint> points;
};
CircleWork circle_work(std::size_t points);

// From the points on, so that the cost of taking them is in it.
features::CircleFit circle_of(const CircleWork& work);

}  // namespace armsig::benchmarks
