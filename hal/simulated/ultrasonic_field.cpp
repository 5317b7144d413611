// SPDX-License-Identifier: MIT
#include "hal/simulated/ultrasonic_field.hpp"

#include <cmath>

namespace armsig::simulated {

namespace {

// An ideal gas carries sound at a speed proportional to the root of its absolute temperature; dry
// air at 0 degrees Celsius at 331.3 m/s.
double sound_in_air(double celsius) {
  constexpr double kIcePoint = 273.15;
  return 331.3 * std::sqrt((celsius + kIcePoint) / kIcePoint);
}

}  // namespace

UltrasonicField::UltrasonicField(const UltrasonicConfig& config, Random random)
    : config_(config), random_(random) {
  if (!config.bias_m.empty()) ARMSIG_CHECK(config.bias_m.size() == config.receivers_S.size());
}

Sounding UltrasonicField::measure(const Vector3& p_S) {
  const double speed = sound_in_air(config_.air_celsius);
  const double reported_celsius = config_.air_celsius + config_.thermometer_error_kelvin;
  const double trips = config_.echo ? 2 : 1;

  Sounding sounding;
  sounding.sequence = ++sequence_;
  sounding.air_celsius = reported_celsius;
  for (std::size_t j = 0; j < config_.receivers_S.size(); ++j) {
    const double noise_m = config_.range_sigma_m * random_.normal();
    const bool detour = random_.chance(config_.multipath_probability);
    const double detour_m = random_.uniform(config_.least_detour_m, config_.longest_detour_m);
    const bool silent = random_.chance(config_.dropout_probability);

    double range_m = (p_S - config_.receivers_S[j]).norm() + noise_m;
    if (!config_.bias_m.empty()) range_m += config_.bias_m[j];
    if (detour) range_m += detour_m;
    const double time_s = trips * range_m / speed;
    const bool heard = !silent && time_s > 0;

    sounding.time_ns.push_back(heard ? static_cast<std::uint32_t>(std::llround(1e9 * time_s)) : 0);
    sounding.range_m.push_back(heard ? time_s * sound_in_air(reported_celsius) / trips : 0);
    sounding.valid.push_back(heard);
    sounding.multipath.push_back(heard && detour);
  }
  return sounding;
}

}  // namespace armsig::simulated
