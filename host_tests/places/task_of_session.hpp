// SPDX-License-Identifier: MIT
// What a simulated session wrote down, as a fit wants it; and what the fit then misses the arm by.
#pragma once

#include <gtest/gtest.h>

#include "firmware/formats/arm_file.hpp"
#include "firmware/host_tool/places/place_run.hpp"
#include "host_tests/support/touching_arm.hpp"

namespace armsig::tool {

inline PlaceTask task_of(const touching::Session& session) {
  const auto arm = parse_arm(session.arm_yaml(), "arm.yaml");
  const auto instrument = parse_instrument(session.instrument_yaml(), "instrument.yaml");
  EXPECT_TRUE(arm && instrument);
  const auto touches =
      parse_touches(session.csv(), "touches.csv", types_of(arm->arm.joints), *instrument);
  EXPECT_TRUE(touches) << render(touches.error());
  return place_task(arm->arm, *instrument, *touches);
}

inline Read<PlaceCalibration> calibrated(const touching::Session& session) {
  return calibrate_by_places(task_of(session), "touches.csv");
}

inline double error_m(touching::Session& session, const PlaceState& state) {
  return session.tool_error_m([&](const touching::VectorXd& q) {
    JointVector readings(static_cast<std::size_t>(q.size()));
    for (std::size_t i = 0; i < readings.size(); ++i) {
      readings[i] = q[static_cast<Eigen::Index>(i)];
    }
    return touching::Vector3d(state.tool_at(readings));
  });
}

}  // namespace armsig::tool
