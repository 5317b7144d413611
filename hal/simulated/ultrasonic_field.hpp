// SPDX-License-Identifier: MIT
// Ultrasonic ranging as a sensor sees it: air, noise, offsets, detours and silence.
#pragma once

#include <cstdint>

#include "core/base/flight_time.hpp"
#include "core/base/pose.hpp"
#include "hal/simulated/random.hpp"

namespace armsig::simulated {

struct UltrasonicConfig {
  FixedVector<Vector3, kMaxReceivers> receivers_S;  // metres, sensor frame
  // Each receiver hears its own ping come back; otherwise all hear one that the target sends.
  bool echo = false;
  double air_celsius = 20;
  double thermometer_error_kelvin = 0;  // the sensor reports air_celsius plus this
  double range_sigma_m = 0;             // 1 sigma of a range
  // Constant offset of each receiver's range; empty: none.
  FixedVector<double, kMaxReceivers> bias_m;
  // Per receiver and ping: nothing is heard.
  double dropout_probability = 0;
  // Per receiver and ping: only a reflection is heard, whose range is too long by a uniform amount
  // between the least and the longest detour.
  double multipath_probability = 0;
  double least_detour_m = 0.02;
  double longest_detour_m = 0.3;
};

// One ping as the sensor tells it, and the truth about it; one entry per receiver.
struct Sounding {
  std::uint16_t sequence = 0;  // advances with every ping and wraps
  double air_celsius = 0;      // by the sensor's thermometer
  // As on the bus; 0 where nothing was heard.
  FixedVector<std::uint32_t, kMaxReceivers> time_ns;
  // The same as ranges, not rounded, as a sensor that trusts its thermometer computes them.
  FixedVector<double, kMaxReceivers> range_m;
  FixedVector<bool, kMaxReceivers> valid;
  FixedVector<bool, kMaxReceivers> multipath;  // heard by a detour
};

// Every ping consumes the same sequence of random numbers whatever the probabilities and sigmas
// are, so that experiments that differ in one of them share the rest of their luck.
class UltrasonicField {
 public:
  UltrasonicField(const UltrasonicConfig& config, Random random);

  // Pings from a target at p_S.
  [[nodiscard]] Sounding measure(const Vector3& p_S);

  // The air warms up, a receiver ages: takes effect with the next ping.
  [[nodiscard]] UltrasonicConfig& config() { return config_; }

 private:
  UltrasonicConfig config_;
  Random random_;
  std::uint16_t sequence_ = 0;
};

}  // namespace armsig::simulated
