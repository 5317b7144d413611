// SPDX-License-Identifier: MIT
#include "hal/cia402/scaling.hpp"

#include <cmath>
#include <limits>

#include "core/base/check.hpp"
#include "core/base/pose.hpp"

namespace armsig::cia402 {
namespace {

constexpr double kSmallestCounts = std::numeric_limits<std::int32_t>::min();
constexpr double kLargestCounts = std::numeric_limits<std::int32_t>::max();

}  // namespace

Result<Scaling> Scaling::make(const ScalingConfiguration& configuration) {
  const bool prismatic = configuration.type == JointType::kPrismatic;
  const double travel = prismatic ? configuration.lead_m : 2 * kPi;
  for (const double factor :
       {configuration.counts_per_revolution, configuration.gear_ratio, travel}) {
    if (!std::isfinite(factor)) return std::unexpected(Error::kNotFinite);
    if (factor <= 0) return std::unexpected(Error::kScaleInvalid);
  }
  const double counts_per_unit =
      configuration.counts_per_revolution * configuration.gear_ratio / travel;
  if (!std::isfinite(counts_per_unit)) return std::unexpected(Error::kScaleInvalid);
  const double coarsest = prismatic ? kCoarsestPrismatic_m : kCoarsestRevolute_rad;
  if (counts_per_unit * coarsest < 1) return std::unexpected(Error::kResolutionTooCoarse);
  return Scaling(configuration.reversed ? -counts_per_unit : counts_per_unit,
                 configuration.zero_counts);
}

Result<std::int32_t> Scaling::counts(double reading) const {
  if (!std::isfinite(reading)) return std::unexpected(Error::kNotFinite);
  const double counts = std::round(reading * counts_per_unit_) + zero_counts_;
  if (counts < kSmallestCounts || counts > kLargestCounts) {
    return std::unexpected(Error::kPositionOverflow);
  }
  return static_cast<std::int32_t>(counts);
}

double Scaling::reading(std::int32_t counts) const {
  return (static_cast<double>(counts) - zero_counts_) / counts_per_unit_;
}

Result<std::uint32_t> Scaling::distance_counts(double distance) const {
  ARMSIG_CHECK(!(distance < 0));
  if (!std::isfinite(distance)) return std::unexpected(Error::kNotFinite);
  const double counts = std::fmax(1.0, std::round(distance * std::fabs(counts_per_unit_)));
  if (counts > kLargestCounts) return std::unexpected(Error::kPositionOverflow);
  return static_cast<std::uint32_t>(counts);
}

double Scaling::resolution() const { return 1 / std::fabs(counts_per_unit_); }

}  // namespace armsig::cia402
