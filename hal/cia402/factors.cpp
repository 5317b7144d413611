// SPDX-License-Identifier: MIT
#include "hal/cia402/factors.hpp"

#include <cmath>

namespace armsig::cia402 {
namespace {

constexpr std::uint16_t kEncoderResolution = 0x608F;
constexpr std::uint16_t kGearRatio = 0x6091;
constexpr std::uint16_t kFeedConstant = 0x6092;

// A gear ratio is configured with some decimals.
constexpr double kTolerance = 1e-5;

bool differ(double told, double configured) {
  return std::fabs(told - configured) > kTolerance * configured;
}

Factor* factor_of(std::uint16_t index, DriveFactors& factors) {
  switch (index) {
    case kEncoderResolution:
      return &factors.encoder;
    case kGearRatio:
      return &factors.gear;
    case kFeedConstant:
      return &factors.feed;
    default:
      return nullptr;
  }
}

}  // namespace

std::optional<double> Factor::value() const {
  if (!over || !under || *over == 0 || *under == 0) return std::nullopt;
  return static_cast<double>(*over) / *under;
}

void append_factor_requests(Setup& setup) {
  for (const std::uint16_t index : {kEncoderResolution, kGearRatio, kFeedConstant}) {
    for (const std::uint8_t subindex : {std::uint8_t{1}, std::uint8_t{2}}) {
      setup.push_back({{index, subindex, 0, 0}, SetupRule::kIfPresent, 0, 0});
    }
  }
}

void take_factor(const ObjectRequest& request, const ObjectOutcome& outcome,
                 DriveFactors& factors) {
  Factor* factor = factor_of(request.index, factors);
  if (factor == nullptr || !outcome) return;
  (request.subindex == 1 ? factor->over : factor->under) = *outcome;
}

std::optional<std::uint16_t> contradicting_object(const DriveFactors& factors,
                                                  const ScalingConfiguration& scaling) {
  const double gear = factors.gear.value().value_or(1);
  if (differ(gear, 1) && differ(gear, scaling.gear_ratio)) return kGearRatio;
  if (const auto feed = factors.feed.value()) {
    if (differ(*feed / gear, scaling.counts_per_revolution)) return kFeedConstant;
    return std::nullopt;
  }
  const auto encoder = factors.encoder.value();
  if (encoder && differ(*encoder, scaling.counts_per_revolution)) return kEncoderResolution;
  return std::nullopt;
}

}  // namespace armsig::cia402
