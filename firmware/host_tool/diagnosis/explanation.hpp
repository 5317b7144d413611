// SPDX-License-Identifier: MIT
// The cause that explains best why measurements and drawing do not agree: tried, and named.
#pragma once

#include <optional>
#include <string>

#include "firmware/host_tool/diagnosis/near_fit.hpp"

namespace armsig::tool {

// The nearest arm to what was given as it is, and the noise to compare with: per axis, 1 sigma.
struct Reference {
  NearFit fit;
  DeviatingChain chain;  // of it
  double stated_m = 0;   // 0 where nothing is stated
  double sweeps_m = 0;   // 0 without sweeps
  double shown_m = 0;    // by the residuals of the nearest arm, its freedom counted

  // The length that noise alone leaves, or 0 where nothing tells the noise.
  [[nodiscard]] double noise_length_m() const;
};
[[nodiscard]] std::optional<Reference> reference_of(const Evidence& evidence,
                                                    const ArmLimits& limits);

// RMS residual length that model errors of a sound arm and the stated noise may leave.
[[nodiscard]] double acceptable_m(const NearFit& fit, double stated_m);

// Residuals far above the noise, or no noise to compare with: worth looking for a cause.
[[nodiscard]] bool is_suspicious(const Reference& reference);

struct Explanation {
  std::string words;  // cause and evidence
  std::string mend;
  bool harmless = false;
};

// The best of all causes tried that leads to a sound arm; where what was given is sound as it is
// (not `refused`), one must explain far more of the residuals.
[[nodiscard]] std::optional<Explanation> explain(const Evidence& evidence,
                                                 const Reference& reference,
                                                 const ArmLimits& limits, bool refused);

// What to do about lengths that are all wrong by one factor.
inline constexpr const char* kMendOfScale =
    "look at the scale of the sensor (unit, air temperature, calibration) and divide x, y, z by "
    "the "
    "factor, or at the lengths of the arm description";

// Of a number that is named, from zero.
inline constexpr double kCertainSigmas = 5;

// "0.123 mm", "4.56 m".
[[nodiscard]] std::string short_length(double metres);

}  // namespace armsig::tool
