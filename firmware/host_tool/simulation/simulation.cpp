// SPDX-License-Identifier: MIT
#include "firmware/host_tool/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/joint_range.hpp"
#include "core/identification.hpp"
#include "core/measurement/ping_median.hpp"

namespace armsig::tool {
namespace {

// One stream of random numbers for each source of randomness, so that adding poses leaves the noise
// of the sweeps as it was.
constexpr std::uint64_t kSensorStream = 1;
constexpr std::uint64_t kPoseStream = 2;

class Sensor {
 public:
  Sensor(const SimulatedSensor& config, std::size_t pings, std::uint64_t seed) : pings_(pings) {
    const simulated::Random random(seed, kSensorStream);
    if (const auto* cartesian = std::get_if<simulated::CartesianConfig>(&config)) {
      cartesian_.emplace(*cartesian, random);
      sigma_m_ = cartesian->sigma_m;
    } else {
      field_.emplace(std::get<simulated::UltrasonicConfig>(config), random);
    }
  }

  void measure(const Vector3& p_S, MeasurementRow& row) {
    if (cartesian_) {
      row.p_S = cartesian_->measure(p_S).p_S;
      if (sigma_m_ > 0) row.sigma_m = sigma_m_;
      return;
    }
    measurement::PingMedian dwell(field_->config().receivers_S.size());
    for (std::size_t k = 0; k < pings_; ++k) {
      const simulated::Sounding sounding = field_->measure(p_S);
      measurement::Ranges ping;
      for (std::size_t r = 0; r < sounding.range_m.size(); ++r) {
        ping.push_back({.metres = sounding.range_m[r], .valid = sounding.valid[r]});
      }
      // At most kMaxPings finite pings: nothing to refuse.
      static_cast<void>(dwell.add(ping));
      row.air_c = sounding.air_celsius;
    }
    row.ranges_m.clear();
    double factors = 0;
    double heard = 0;
    for (const measurement::Range& range : dwell.median()) {
      row.ranges_m.push_back(range.valid ? std::optional(range.metres) : std::nullopt);
      if (!range.valid) continue;
      factors += range.sigma_factor * range.sigma_factor;
      ++heard;
    }
    row.sigma_m.reset();
    const double range_sigma_m = field_->config().range_sigma_m;
    if (heard > 0 && range_sigma_m > 0) row.sigma_m = range_sigma_m * std::sqrt(factors / heard);
  }

 private:
  std::optional<simulated::CartesianSensor> cartesian_;
  std::optional<simulated::UltrasonicField> field_;
  double sigma_m_ = 0;
  std::size_t pings_;
};

}  // namespace

void mount_link_targets(simulated::SimulatedArm& arm, const JointVector& configuration,
                        double radius_m) {
  const Signature bare = signature_of(arm.arm, configuration, arm.X_S0, {});
  for (std::size_t link = 1; link <= bare.joint_count(); ++link) {
    const Vector3 p_S = bare.X_SL[link - 1] * Vector3(radius_m, 0, 0);
    const Pose X_SL = simulated::link_pose(arm, configuration, link);
    arm.targets.push_back(
        {.number = static_cast<int>(link), .link = link, .p_L = X_SL.inverse() * p_S});
  }
}

void mount_hand_target(simulated::SimulatedArm& arm, const Vector3& p_L) {
  arm.targets.push_back({.number = 1, .link = arm.arm.joints.size(), .p_L = p_L});
}

Signature truth_of(const simulated::SimulatedArm& arm, const JointVector& configuration,
                   BentJoints joints) {
  std::vector<KnownTarget> targets;
  for (const simulated::Target& target : arm.targets) {
    targets.push_back({.number = target.number, .link = target.link, .p_F = target.p_L});
  }
  const JointVector turned = effective_readings(arm.arm, joints.turned(configuration));
  Signature signature = signature_of(arm.arm, turned, arm.X_S0, targets);
  signature.configuration = effective_readings(arm.arm, configuration);
  derive_parameters(signature, arm.arm);
  return signature;
}

std::size_t row_count(const Simulation& simulation) {
  std::size_t rows = simulation.mixed_poses;
  for (const SweepOfJoint& sweep : simulation.plan.sweeps) rows += sweep.points;
  return rows;
}

void simulate(const Simulation& simulation,
              const std::function<void(const MeasurementRow&)>& sink) {
  const Arm& arm = simulation.arm.arm;
  const auto& targets = simulation.arm.targets;
  Sensor sensor(simulation.sensor, simulation.pings, simulation.seed);
  MeasurementRow row;
  BentJoints joints = simulation.joints;
  const auto measure = [&](const simulated::Target& target) {
    ++row.line;
    row.target = target.number;
    const JointVector turned = joints.turned(row.q);
    sensor.measure(simulated::target_position(simulation.arm, turned, target), row);
    sink(row);
  };
  for (std::size_t j = 0; j < arm.joints.size(); ++j) {
    const SweepOfJoint& sweep = simulation.plan.sweeps[j];
    row.sweep = j + 1;
    for (std::size_t k = 0; k < sweep.points; ++k) {
      row.q = simulation.plan.configuration;
      row.q[j] = sweep.reading(k);
      measure(targets[std::min(j, targets.size() - 1)]);
    }
  }
  simulated::Random random(simulation.seed, kPoseStream);
  row.sweep = 0;
  for (std::size_t k = 0; k < simulation.mixed_poses; ++k) {
    for (std::size_t j = 0; j < arm.joints.size(); ++j) {
      const auto [lower, upper] = finite_range(arm.limits[j]);
      row.q[j] = random.uniform(lower, upper);
    }
    measure(targets.back());
  }
}

}  // namespace armsig::tool
