// SPDX-License-Identifier: MIT
// One sweep for the eye: its circle or line, and how far each point is from it.
#pragma once

#include <optional>
#include <vector>

#include "core/features/feature.hpp"
#include "firmware/host_tool/report/encoder_wave.hpp"
#include "firmware/host_tool/report/measured_sweeps.hpp"

namespace armsig::tool {

struct PointResidual {
  double reading = 0;
  Vector3 p_S = Vector3::Zero();
  // Revolute: outwards, along the axis, around the circle. Prismatic: the two directions across
  // the line, and along it.
  double radial_m = 0;
  double normal_m = 0;
  double tangential_m = 0;
  bool rejected = false;
};

struct SweepPicture {
  std::size_t joint = 0;  // from 0
  int target = 0;
  features::JointFeature feature;
  std::vector<PointResidual> points;
  std::optional<EncoderWave> wave;  // revolute joints swept far enough
};

// Fits the sweep again, as `method` does. Nothing where it gives no feature. The fit says how many
// points it rejected; they are those furthest from it.
[[nodiscard]] std::optional<SweepPicture> picture_of(const MeasuredSweep& sweep, JointType type,
                                                     features::Method method);

}  // namespace armsig::tool
