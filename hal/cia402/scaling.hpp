// SPDX-License-Identifier: MIT
// Joint readings in radians or metres against the drive's position counts (objects 607Ah, 6064h).
#pragma once

#include <cstdint>

#include "core/base/arm.hpp"
#include "core/base/error.hpp"

namespace armsig::cia402 {

// How a motor's encoder sees a joint.
struct ScalingConfiguration {
  JointType type = JointType::kRevolute;
  double counts_per_revolution = 0;  // of the motor's shaft, after quadrature
  double gear_ratio = 0;             // motor revolutions a revolution of the output
  double lead_m = 0;                 // prismatic only: travel a revolution of the output
  bool reversed = false;             // the reading falls while the counts rise
  std::int32_t zero_counts = 0;      // counts where the joint reading is zero
};

class Scaling {
 public:
  // Errors: kNotFinite, kScaleInvalid (not positive), kResolutionTooCoarse (above
  // kCoarsestRevolute_rad or kCoarsestPrismatic_m a count).
  [[nodiscard]] static Result<Scaling> make(const ScalingConfiguration& configuration);

  // Counts of the reading, rounded to the nearest. Errors: kNotFinite, kPositionOverflow.
  [[nodiscard]] Result<std::int32_t> counts(double reading) const;

  // The reading of `counts`, radians or metres.
  [[nodiscard]] double reading(std::int32_t counts) const;

  // How many counts a motion of `distance` (not negative; radians or metres) makes, at least 1.
  // Errors: kNotFinite, kPositionOverflow.
  [[nodiscard]] Result<std::uint32_t> distance_counts(double distance) const;

  // The worth of one count, radians or metres, positive.
  [[nodiscard]] double resolution() const;

  // A tenth of a degree and a tenth of a millimetre: any joint that is worth calibrating resolves
  // far more, and a ratio given in a wrong unit resolves far less.
  static constexpr double kCoarsestRevolute_rad = 1.8e-3;
  static constexpr double kCoarsestPrismatic_m = 1e-4;

 private:
  Scaling(double counts_per_unit, std::int32_t zero_counts)
      : counts_per_unit_(counts_per_unit), zero_counts_(zero_counts) {}

  double counts_per_unit_;  // signed
  std::int32_t zero_counts_;
};

}  // namespace armsig::cia402
