// SPDX-License-Identifier: MIT
#include "firmware/host_tool/simulation/demo_run.hpp"

#include <algorithm>
#include <memory>

#include <fmt/core.h>

#include "firmware/analysis/differences/differences.hpp"
#include "firmware/analysis/evaluation/tool_error.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "hal/simulated/demo_sensor.hpp"
#include "hal/simulated/tolerances.hpp"

namespace armsig::tool {
namespace {

constexpr int kToolTarget = 6;
constexpr int kErrorConfigurations = 1000;

Arm built_robot(std::size_t robot) {
  if (robot < 2) return table2_robot(static_cast<int>(robot) + 1);
  simulated::Random random(robot);
  return simulated::drawn_arm(puma560(), simulated::Tolerances{}, random);
}

// Of the drawing with base and tool fitted to the arm.
double fitted_drawing_error_m(const Arm& drawing, const Signature& truth) {
  const auto arm = std::make_unique<calibration::Refined>();
  arm->signature = truth;
  const auto* tool = std::ranges::find(truth.targets, kToolTarget, &Target::number);
  const auto drawn = differences::fitted_drawing(
      drawing, *arm, static_cast<std::size_t>(tool - truth.targets.begin()));
  ARMSIG_CHECK(drawn.has_value());  // an arm drawn about its drawing
  return evaluation::rms_tool_error(*drawn, truth, kToolTarget, Pose{}, drawing.limits,
                                    kErrorConfigurations);
}

}  // namespace

SensorDescription demo_sensor_description() {
  SensorDescription sensor;
  sensor.name = "eight receivers above the arm";
  for (const Vector3& p_S : simulated::demo_sensor().receivers_S) {
    sensor.receivers_S.push_back(p_S);
  }
  sensor.range_sigma_m = simulated::kDemoRangeSigma;
  sensor.facing_S = simulated::demo_sensor_facing();
  return sensor;
}

DemoRobot measured_demo_robot(std::size_t robot, std::uint64_t noise_seed, const DemoPlan& plan) {
  const Arm drawing = puma560();
  simulated::SimulatedArm built{
      .arm = built_robot(robot), .X_S0 = simulated::demo_base_pose(), .targets = {}};
  const JointVector configuration = middle_of_limits(drawing);
  mount_link_targets(built, configuration, plan.target_radius_m);
  const Simulation simulation{
      .arm = built,
      .plan = plan_sweeps(drawing, configuration, plan.arc_rad, plan.points),
      .sensor = simulated::demo_sensor(),
      .pings = plan.pings,
      .mixed_poses = 0,
      .seed = noise_seed};
  DemoRobot result;
  result.name = robot < 2 ? fmt::format("Robot {} of Table 2", robot + 1)
                          : fmt::format("Drawn about Table 1, no. {}", robot - 1);
  simulate(simulation, [&](const MeasurementRow& row) { result.rows.push_back(row); });
  result.truth = truth_of(built, configuration);
  result.drawing_error_m = fitted_drawing_error_m(drawing, result.truth);
  result.sweep_duration_s = duration_s(drawing, simulation.plan, {.pings = plan.pings});
  return result;
}

Read<DemoScore> score_of(const DemoRobot& robot, const Signature& found) {
  const Arm drawing = puma560();
  const auto grid = evaluation::compare(drawing, found, robot.truth);
  if (!grid) {
    return std::unexpected(Problem{
        "", 0, 0, fmt::format("the grid can't be touched: {}", describe(grid.error())), ""});
  }
  return DemoScore{
      .grid = *grid,
      .tool_error_m = evaluation::rms_tool_error(found, robot.truth, kToolTarget, Pose{},
                                                 drawing.limits, kErrorConfigurations)};
}

}  // namespace armsig::tool
