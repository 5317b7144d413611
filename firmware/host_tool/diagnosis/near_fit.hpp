// SPDX-License-Identifier: MIT
// The arm nearest to its drawing that explains what was measured.
//
// Maximum a posteriori: every link may differ from the drawing by a small rotation and shift at its
// joint, every joint by a zero, each with a prior as wide as any workshop would build; base and
// targets are free. The deviations are about points where the axes are near each other, so they do
// not depend on the frames of the drawing (a row of d = 300 m says the same as one of d = 0), and
// of all ways to write one arm the smallest deviations are found.
#pragma once

#include <optional>
#include <vector>

#include "firmware/formats/arm_limits.hpp"
#include "firmware/host_tool/diagnosis/deviating_chain.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

struct NearFit {
  std::vector<Deviation> joints;     // one a joint
  std::vector<Vector3> residuals_S;  // a row each
  double sigma_m = 0;                // 1 sigma per axis by the median residual
  double best_rms_m = 0;             // of the residual lengths of the best seven tenths of the rows
  double clipped_m = 0;  // RMS of all residual lengths, none counted above a tenth of the reach
  double reach_m = 0;    // of the drawing
  double scale = 1;      // of what was seen against the arm: all lengths times this
  double gain = 1;       // of the readings against the joints: how far they turn times this
  Pose X_SB;
  Pose X_SM;  // how the sensor's second place sees the arm: X_SM * (what the first would)

  // The largest deviation in units of what `limits` allow: above 1 is another arm.
  [[nodiscard]] double farthest(const ArmLimits& limits, const Arm& arm) const;
  // Mean square of the deviations in units of a third of the limits, zeros left out.
  [[nodiscard]] double strangeness(const ArmLimits& limits) const;
};

// RMS of the best seven tenths of the residual lengths of the drawing as it is, base and targets
// fitted, as a share of the drawing's reach: quick, to choose by. Infinite without rows.
[[nodiscard]] double drawn_misfit(const Evidence& evidence);

// RMS of lengths, none counted above a tenth of the reach. Precondition: not empty.
[[nodiscard]] double clipped_rms(const std::vector<double>& lengths_m, double reach_m);

struct NearestArm {
  NearFit fit;
  DeviatingChain chain;  // as fitted, to be differentiated
};

// Nothing without rows. `limits` says how wide the priors are.
[[nodiscard]] std::optional<NearestArm> nearest_arm(const Evidence& evidence,
                                                    const ArmLimits& limits, int steps = 20);
[[nodiscard]] std::optional<NearFit> fit_near(const Evidence& evidence, const ArmLimits& limits,
                                              int steps = 20);

}  // namespace armsig::tool
