// SPDX-License-Identifier: MIT
// A sensor that gives positions right away (laser tracker, camera), with the same noise in every
// direction.
#pragma once

#include "core/base/pose.hpp"
#include "hal/simulated/random.hpp"

namespace armsig::simulated {

struct CartesianConfig {
  double sigma_m = 0;  // 1 sigma per axis
  double dropout_probability = 0;
  double outlier_probability = 0;
  double least_outlier_m = 0.02;  // an outlier is off in a uniform direction by a uniform distance
  double largest_outlier_m = 0.3;
};

struct Sighting {
  bool seen = false;
  Vector3 p_S = Vector3::Zero();  // if seen
  bool outlier = false;
};

// As with UltrasonicField, the numbers consumed don't depend on the configuration.
class CartesianSensor {
 public:
  CartesianSensor(const CartesianConfig& config, Random random)
      : config_(config), random_(random) {}

  // Measures a target at p_S.
  [[nodiscard]] Sighting measure(const Vector3& p_S);

  // Takes effect with the next measurement.
  [[nodiscard]] CartesianConfig& config() { return config_; }

 private:
  CartesianConfig config_;
  Random random_;
};

}  // namespace armsig::simulated
