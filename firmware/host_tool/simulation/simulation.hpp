// SPDX-License-Identifier: MIT
// A simulated measurement of a simulated arm: targets on its links, sweeps, further poses, the
// sensor.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <variant>

#include "core/measurement/receivers.hpp"
#include "core/signature.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/host_tool/simulation/bent_joints.hpp"
#include "firmware/host_tool/simulation/sweep_plan.hpp"
#include "hal/simulated/arm.hpp"
#include "hal/simulated/cartesian_sensor.hpp"
#include "hal/simulated/ultrasonic_field.hpp"

namespace armsig::tool {

// Positions right away, or ranges to receivers.
using SimulatedSensor = std::variant<simulated::CartesianConfig, simulated::UltrasonicConfig>;

struct Simulation {
  simulated::SimulatedArm arm;  // with a target for each link, or one on the last
  SweepPlan plan;
  SimulatedSensor sensor;
  std::size_t pings = 1;        // of an ultrasonic sensor, a point; the median counts
  std::size_t mixed_poses = 0;  // rows with sweep 0 after the sweeps
  std::uint64_t seed = 1;
  BentJoints joints{};  // how far they turn at their readings
};

// Mounts target i on link i, `radius_m` from the axis of joint i (beside the slide of a prismatic
// joint), where the arm is in `configuration`. Each sweep then follows its own target.
void mount_link_targets(simulated::SimulatedArm& arm, const JointVector& configuration,
                        double radius_m);

// Mounts one target on the last link, at p_L in its Denavit-Hartenberg frame: all sweeps follow it,
// as the joints beyond the swept one are held.
void mount_hand_target(simulated::SimulatedArm& arm, const Vector3& p_L);

// The exact signature of the simulated arm; with `joints`, its axes are where those have turned to.
[[nodiscard]] Signature truth_of(const simulated::SimulatedArm& arm,
                                 const JointVector& configuration, BentJoints joints = {});

// How many rows `simulate` gives.
[[nodiscard]] std::size_t row_count(const Simulation& simulation);

// Gives every row, in the order that an arm would be swept in, to `sink`.
void simulate(const Simulation& simulation, const std::function<void(const MeasurementRow&)>& sink);

}  // namespace armsig::tool
