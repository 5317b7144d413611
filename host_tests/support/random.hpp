// SPDX-License-Identifier: MIT
// Random numbers with a seed, for arms, sweeps and poses.
#pragma once

#include <cstdint>
#include <random>

#include <Eigen/Geometry>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double normal(double sigma = 1) { return sigma * normal_(engine_); }
  double uniform(double low, double high) { return low + (high - low) * uniform_(engine_); }
  Vector3 normal_vector(double sigma = 1) {
    const double x = normal(sigma);
    const double y = normal(sigma);
    return {x, y, normal(sigma)};
  }
  Vector3 direction() { return normal_vector().normalized(); }
  Matrix3 rotation() {
    const double w = normal();
    const Vector3 v = normal_vector();
    return Eigen::Quaterniond(w, v.x(), v.y(), v.z()).normalized().toRotationMatrix();
  }
  JointVector configuration(const Arm& arm) {
    JointVector q;
    for (const JointLimits& limit : arm.limits) q.push_back(uniform(limit.lower, limit.upper));
    return q;
  }
  // Uniform among `count`.
  std::size_t index(std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(engine_);
  }
  // Each coordinate uniform in +-`extent`.
  Vector3 vector(double extent) {
    const double x = uniform(-extent, extent);
    const double y = uniform(-extent, extent);
    return {x, y, uniform(-extent, extent)};
  }
  Pose pose(double extent) {
    const Matrix3 R = rotation();
    return {R, vector(extent)};
  }
  // Readings of `arm`: revolute in +-`turn`, prismatic in +-`travel`.
  JointVector readings(const Arm& arm, double turn, double travel) {
    JointVector q;
    for (const DhJoint& row : arm.joints) {
      const double extent = row.type == JointType::kRevolute ? turn : travel;
      q.push_back(uniform(-extent, extent));
    }
    return q;
  }
  std::mt19937_64& engine() { return engine_; }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
};

}  // namespace armsig::test
