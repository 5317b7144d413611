// SPDX-License-Identifier: MIT
#include "firmware/cabinet_r5f/configuration.hpp"

#include <array>

#include "firmware/paper_arms/paper_arms.hpp"

namespace armsig::cabinet {
namespace {

constexpr std::size_t kJoints = 6;
constexpr double kRangeSigma_m = 0.2e-3;
constexpr double kCountsPerRevolution = 4000;
constexpr double kGearRatio = 100;

JointVector readings_deg(const std::array<double, kJoints>& degrees) {
  JointVector readings;
  for (const double angle : degrees) readings.push_back(radians(angle));
  return readings;
}

}  // namespace

FixedVector<Vector3, kReceivers> receivers_S() {
  return {{-1.0, -1.0, 0.0}, {1.0, -1.0, 0.0},  {1.0, 1.0, 0.0},
          {-1.0, 1.0, 0.0},  {-0.5, -0.5, 0.8}, {0.5, 0.5, 0.8}};
}

controller::Configuration controller_configuration() {
  controller::Configuration c;
  c.drawing = tool::puma560();
  c.period = kPeriod;
  c.feedback_age = canopen::Configuration{}.missed_feedback_limit * kPeriod;
  for (std::size_t i = 0; i < kJoints; ++i) {
    c.limits.speed.push_back(1.5);
    c.limits.acceleration.push_back(6.0);
    c.supervision.following_error.push_back(0.08);
    c.resolution.push_back(2 * kPi / (kCountsPerRevolution * kGearRatio));
  }
  for (const Vector3& p_S : receivers_S()) c.sensor.receivers.p_S.push_back(p_S);
  c.sensor.receivers.range_sigma_m = kRangeSigma_m;
  c.sensor.receivers.facing_S = -Vector3::UnitZ();
  c.dwell.tolerance = 1e-4;
  c.sweeps.configuration = {0, radians(-90), radians(90), radians(30), 0, 0};
  c.sweeps.arc_rad = radians(120);
  c.sweeps.points = 12;
  c.sweeps.most_points = 16;
  c.sweeps.validation_poses = 6;
  c.grid.grid.count = {3, 3, 3};
  c.grid.taught = {readings_deg({72.58, -166.78, 23.61, 81.31, 53.15, 92.79}),
                   readings_deg({95.77, -161.15, 6.57, 94.89, 65.51, 105.31}),
                   readings_deg({62.85, -156.95, -12.59, 54.57, 59.56, 123.93})};
  return c;
}

canopen::Configuration drive_configuration() {
  canopen::Configuration c;
  const Arm drawing = tool::puma560();
  for (std::size_t i = 0; i < kJoints; ++i) {
    c.axes.push_back(
        {{.scaling = {.counts_per_revolution = kCountsPerRevolution, .gear_ratio = kGearRatio},
          .limits = drawing.limits[i],
          .largest_speed = 2.0},
         static_cast<canopen::NodeId>(i + 1)});
  }
  c.period = kPeriod;
  c.bits_per_second = kBitsPerSecond;
  const canopen::RangeNodeConfiguration sensor = sensor_configuration();
  c.others[0].nodes.push_back(sensor.node);
  for (const auto& frame : canopen::traffic(sensor, std::chrono::milliseconds(20))) {
    c.others[0].traffic.push_back(frame);
  }
  return c;
}

canopen::RangeNodeConfiguration sensor_configuration() {
  return {.node = 32, .receivers = kReceivers};
}

}  // namespace armsig::cabinet
