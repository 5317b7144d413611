// SPDX-License-Identifier: MIT
// Does a joint's reading err once per turn? What an encoder disk mounted off its centre does.
#pragma once

#include <optional>
#include <span>

#include "core/base/pose.hpp"

namespace armsig::tool {

// A point of a sweep about its circle.
struct CircleResidual {
  double reading_rad = 0;
  double radial_m = 0;      // outwards
  double tangential_m = 0;  // in the sense of the reading
};

// The true angle is reading + cosine cos(reading) + sine sin(reading).
struct EncoderWave {
  double cosine_rad = 0;
  double sine_rad = 0;
  double sigma_rad = 0;   // 1 sigma of the amplitude
  double chi_square = 0;  // of there being no wave; 2 degrees of freedom
  // What the wave leaves in the residuals of the circle, which has shifted to take up some of it.
  Vector3 absorbed = Vector3::Zero();  // shift of the centre (m, m), turn of the zero (rad)
  double absorbed_radius_m = 0;

  [[nodiscard]] double amplitude_rad() const { return std::hypot(cosine_rad, sine_rad); }
  // 99.99 % of circles without a wave stay below.
  [[nodiscard]] bool significant() const { return chi_square > 18.42; }
  [[nodiscard]] CircleResidual residual_at(double reading_rad, double radius_m) const;
};

// Least squares of shift, turn, radius and wave over the residuals of a circle of radius
// `radius_m`. Nothing for fewer than 10 points or less than half a turn, where a wave can't be told
// from a shifted circle.
[[nodiscard]] std::optional<EncoderWave> fit_encoder_wave(std::span<const CircleResidual> residuals,
                                                          double radius_m);

}  // namespace armsig::tool
