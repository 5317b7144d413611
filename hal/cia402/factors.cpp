// SPDX-License-Identifier: MIT
#include "hal/cia402/factors.hpp"

#include <cmath>
#include <cstdlib>

#include "core/base/pose.hpp"

namespace armsig::cia402 {
namespace {

constexpr std::uint16_t kEncoderResolution = 0x608F;
constexpr std::uint16_t kGearRatio = 0x6091;
constexpr std::uint16_t kFeedConstant = 0x6092;
constexpr std::uint16_t kPositionFactor = 0x6093;
constexpr std::uint16_t kPositionUnit = 0x60A8;
constexpr std::uint16_t kAccelerationUnit = 0x60AA;

// Units of CiA 303-2: a power of ten, a unit, and what it is divided by, from the highest byte
// down.
constexpr std::uint32_t kRadian = 0x10;
constexpr std::uint32_t kDegree = 0x41;
constexpr std::uint32_t kRevolution = 0xB4;
constexpr std::uint32_t kIncrement = 0xB5;
constexpr std::uint32_t kPerSquareSecond = 0x57;
// Revolutions a minute and second, which the standard has no code for, as drives write them.
constexpr std::uint32_t kRevolutionsPerMinuteAndSecond = 0x00C00300;

constexpr std::uint32_t unit_of(std::uint32_t notation) { return notation >> 16 & 0xFF; }
constexpr std::uint32_t divisor_of(std::uint32_t notation) { return notation >> 8 & 0xFF; }
double power_of(std::uint32_t notation) {
  constexpr int kSign = 0x80;
  const int byte = static_cast<int>(notation >> 24);
  const int exponent = (byte ^ kSign) - kSign;  // of two's complement
  double power = 1;
  for (int i = 0; i < std::abs(exponent); ++i) power *= 10;
  return exponent < 0 ? 1 / power : power;
}

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
    case kPositionFactor:
      return &factors.position;
    default:
      return nullptr;
  }
}

hal::DeviceObject object(std::uint16_t index, double found, double wanted) {
  const auto whole = [](double value) { return static_cast<std::uint32_t>(std::llround(value)); };
  return {.index = index, .subindex = 1, .found = whole(found), .wanted = whole(wanted)};
}

// Units of position in a revolution, by 60A8h; 0: it is no angle.
double units_per_turn(std::uint32_t notation) {
  if (divisor_of(notation) != 0) return 0;
  switch (unit_of(notation)) {
    case kRevolution:
      return 1 / power_of(notation);
    case kDegree:
      return 360 / power_of(notation);
    case kRadian:
      return 2 * kPi / power_of(notation);
    default:
      return 0;
  }
}

}  // namespace

std::optional<double> Factor::value() const {
  if (!over || !under || *over == 0 || *under == 0) return std::nullopt;
  return static_cast<double>(*over) / *under;
}

void append_factor_requests(Setup& setup) {
  for (const std::uint16_t index :
       {kEncoderResolution, kGearRatio, kFeedConstant, kPositionFactor}) {
    for (const std::uint8_t subindex : {std::uint8_t{1}, std::uint8_t{2}}) {
      setup.push_back({{index, subindex, 0, 0}, SetupRule::kIfPresent, 0, 0});
    }
  }
  for (const std::uint16_t index : {kPositionUnit, kAccelerationUnit}) {
    setup.push_back({{index, 0, 0, 0}, SetupRule::kIfPresent, 0, 0});
  }
}

void take_factor(const ObjectRequest& request, const ObjectOutcome& outcome,
                 DriveFactors& factors) {
  if (!outcome) return;
  const std::uint16_t index = object_of_first_axis(request.index);
  if (index == kPositionUnit) factors.position_unit = *outcome;
  if (index == kAccelerationUnit) factors.acceleration_unit = *outcome;
  Factor* factor = factor_of(index, factors);
  if (factor == nullptr) return;
  (request.subindex == 1 ? factor->over : factor->under) = *outcome;
}

std::optional<hal::DeviceObject> contradicting_object(const DriveFactors& factors,
                                                      const ScalingConfiguration& scaling) {
  const double gear = factors.gear.value().value_or(1);
  if (differ(gear, 1) && differ(gear, scaling.gear_ratio)) {
    return object(kGearRatio, gear, scaling.gear_ratio);
  }
  const double wanted = scaling.counts_per_revolution;
  if (unit_of(factors.position_unit) != kIncrement) {
    if (const auto feed = factors.feed.value()) {
      if (!differ(*feed / gear, wanted)) return std::nullopt;
      return object(kFeedConstant, *feed, wanted * gear);
    }
    if (const double turn = units_per_turn(factors.position_unit); turn > 0) {
      if (!differ(turn / gear, wanted)) return std::nullopt;
      return hal::DeviceObject{.index = kPositionUnit,
                               .subindex = 0,
                               .found = factors.position_unit,
                               .wanted = kIncrement << 16};
    }
  }
  const auto encoder = factors.encoder.value();
  const double increments = factors.position.value().value_or(1);
  if (differ(increments, 1) && (!encoder || differ(*encoder / increments, wanted))) {
    return object(kPositionFactor, increments, 1);
  }
  if (!encoder || !differ(*encoder / increments, wanted)) return std::nullopt;
  return object(kEncoderResolution, *encoder, wanted);
}

Result<std::uint32_t> stop_ramp(const DriveFactors& factors, double deceleration,
                                const ScalingConfiguration& scaling) {
  const std::uint32_t notation = factors.acceleration_unit;
  const double travel = scaling.type == JointType::kPrismatic ? scaling.lead_m : 2 * kPi;
  const double turns =
      deceleration * scaling.gear_ratio / travel;  // of the motor, a second squared
  double ramp = 0;
  if (notation == 0) {
    ramp = turns * scaling.counts_per_revolution;
  } else if (notation == kRevolutionsPerMinuteAndSecond) {
    ramp = 60 * turns;
  } else if (divisor_of(notation) == kPerSquareSecond && unit_of(notation) == kRevolution) {
    ramp = turns / power_of(notation);
  } else if (divisor_of(notation) == kPerSquareSecond && unit_of(notation) == kIncrement) {
    ramp = turns * scaling.counts_per_revolution / power_of(notation);
  } else {
    return std::unexpected(Error::kScaleInvalid);
  }
  constexpr double kMost = 4294967295.0;
  if (!(ramp <= kMost)) return std::unexpected(Error::kPositionOverflow);
  return static_cast<std::uint32_t>(std::fmax(1.0, std::round(ramp)));
}

}  // namespace armsig::cia402
