// SPDX-License-Identifier: MIT
#include "hal/simulated/placement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "hal/simulated/demo_sensor.hpp"
#include "hal/simulated/random.hpp"

namespace armsig::simulated {
namespace {

constexpr int kDrawnReadings = 20'000;
constexpr std::uint64_t kReadingsSeed = 1;
constexpr double kClear_m = 0.1;           // between receivers and target
constexpr double kDistancesPerMetre = 10;  // placed to a decimetre
constexpr double kMiddlesPerMetre = 2;     // and to half a metre
constexpr double kCeilingCosine = -0.5;    // of an arm that hangs

// Turns the arm so that its sensor hangs above it; below it, where it hangs itself.
Matrix3 upright(const Vector3& up_0) {
  if (up_0.z() < kCeilingCosine) return Matrix3::Identity();
  const Vector3 axis = up_0.cross(Vector3::UnitZ());
  const double sine = axis.norm();
  if (sine == 0) return Matrix3::Identity();
  return rotation_about(axis / sine, std::atan2(sine, up_0.z()));
}

struct Extent {
  Vector3 lower = Vector3::Constant(1e9);
  Vector3 upper = Vector3::Constant(-1e9);
  double nearest = 1e9;  // along the direction in which targets are

  void add(const Vector3& p, const Vector3& facing) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
    nearest = std::min(nearest, p.dot(facing));
  }
  [[nodiscard]] Vector3 middle() const { return (lower + upper) / 2; }
};

// Of the last target, of an arm whose X_S0 has no translation.
Extent reach_of(const SimulatedArm& arm, const Vector3& facing) {
  Random random(kReadingsSeed);
  Extent extent;
  for (int drawn = 0; drawn < kDrawnReadings; ++drawn) {
    JointVector readings;
    for (const JointLimits& limits : arm.arm.limits) {
      readings.push_back(random.uniform(limits.lower, limits.upper));
    }
    const Target& target = arm.targets[arm.targets.size() - 1];
    extent.add(target_position(arm, readings, target), facing);
  }
  return extent;
}

}  // namespace

Pose base_pose(const SimulatedArm& arm, std::span<const Vector3> receivers_S,
               const Vector3& facing_S) {
  if (receivers_S.empty()) return demo_base_pose();
  const Pose demo = demo_base_pose();
  const Vector3 facing = facing_S.norm() > 0 ? Vector3(facing_S.normalized()) : -Vector3::UnitZ();
  SimulatedArm turned = arm;
  turned.X_S0 = {demo.R * upright(arm.arm.up_0), Vector3::Zero()};
  const Extent reach = reach_of(turned, facing);
  Extent array;
  double farthest = -1e9;  // of the receivers, towards the targets
  for (const Vector3& p_S : receivers_S) {
    array.add(p_S, facing);
    farthest = std::max(farthest, p_S.dot(facing));
  }
  const double distance =
      std::ceil(kDistancesPerMetre * (farthest - reach.nearest + kClear_m)) / kDistancesPerMetre;
  const Vector3 off_centre = array.middle() - reach.middle();
  const Vector3 across =
      (kMiddlesPerMetre * (off_centre - off_centre.dot(facing) * facing)).array().round() /
          kMiddlesPerMetre +
      demo.p.array();
  turned.X_S0.p = across - across.dot(facing) * facing + distance * facing;
  return turned.X_S0;
}

}  // namespace armsig::simulated
