// SPDX-License-Identifier: MIT
#include "hal/simulated/cartesian_sensor.hpp"

namespace armsig::simulated {

Sighting CartesianSensor::measure(const Vector3& p_S) {
  const Vector3 noise_S = config_.sigma_m * random_.normal_vector();
  const bool outlier = random_.chance(config_.outlier_probability);
  const Vector3 direction_S = random_.direction();
  const double distance_m = random_.uniform(config_.least_outlier_m, config_.largest_outlier_m);
  const bool silent = random_.chance(config_.dropout_probability);

  Sighting sighting;
  if (silent) return sighting;
  sighting.seen = true;
  sighting.p_S = p_S + noise_S;
  sighting.outlier = outlier;
  if (outlier) sighting.p_S += distance_m * direction_S;
  return sighting;
}

}  // namespace armsig::simulated
