// SPDX-License-Identifier: MIT
// Where an arm of known drawing stands, and where on its last link the target is.
//
// The base's pose in the sensor frame (any rotation) and the target in the last link are found by
// the search of rotation_search.hpp, repeated with Huber weights so that gross outliers lose their
// say. Where there are more targets, all rows have their say in the base (base_and_targets.hpp).
#pragma once

#include <span>

#include "core/base/error.hpp"
#include "core/calibration/observation.hpp"
#include "core/calibration/readings.hpp"
#include "core/signature.hpp"

namespace armsig::calibration {

struct BaseAndTool {
  Pose X_SB;
  FixedVector<Vector3, kMaxTargets>
      p_LT;              // targets in their links' frames; zero where not observed
  std::size_t main = 0;  // index of the target on the last link that has most rows
  double rms_m = 0;      // residual lengths of the rows that carry at least half weight
};

// Fits base and targets to the position rows of `log` whose use is kFit. `targets` says on which
// link each target is; their positions are not used. Preconditions: every row's target is among
// `targets`, at most kMaxTargets. Errors: kNotFinite (index of the row); kTooFewPoints (positions
// of the main target, 4); kJointDidNotMove (no joint moved); kCoincidentPoints (its positions are
// all one); kNotConverged (RMS [m], 0: no minimum was found). `memory`, as long as `log` or empty,
// saves evaluating the nominal model anew in every pass.
[[nodiscard]] Judged<BaseAndTool> fit_base_and_tool(const Arm& arm,
                                                    std::span<const Observation> log,
                                                    std::span<const Target> targets,
                                                    std::span<Pose> memory = {});

}  // namespace armsig::calibration
