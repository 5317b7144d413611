// SPDX-License-Identifier: MIT
// The robots of the demonstration, identified by the features of their sweeps and not judged: for
// statistics over many seeds.
#pragma once

#include "firmware/host_tool/identification/identification_run.hpp"
#include "firmware/host_tool/simulation/demo_run.hpp"
#include "firmware/paper_arms/paper_arms.hpp"

namespace armsig::test {

[[nodiscard]] inline tool::Read<Signature> found_by_features(
    const tool::DemoRobot& robot, features::Method method = features::Method::kEncoder) {
  tool::IdentificationRun run(tool::puma560(), tool::demo_sensor_description(), "", method);
  for (const tool::MeasurementRow& row : robot.rows) {
    if (auto taken = run.take(row); !taken) return std::unexpected(std::move(taken).error());
  }
  ARMSIG_TRY(identified, run.finish());
  return identified.signature;
}

}  // namespace armsig::test
