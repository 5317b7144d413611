// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/low_discrepancy.hpp"
#include "core/evaluation/tool_pose.hpp"

namespace armsig::evaluation {
namespace {

constexpr int kCandidates = 96;
constexpr double kShrink = 0.8;
constexpr int kShrinkSteps = 11;  // 0.8^11 is just under a tenth

// Candidate 0 is the middle of the limits; the others fill them evenly (Halton sequence).
JointVector candidate(const ToolModel& drawing, int n) {
  JointVector q;
  for (std::size_t i = 0; i < drawing.chain.joint_count; ++i) {
    auto [lower, upper] = drawing.chain.limits[i];
    if (drawing.chain.revolute[i]) {
      lower = std::max(lower, -kPi);
      upper = std::min(upper, kPi);
    }
    const double share = n == 0 ? 0.5 : halton(i, n);
    // The outer tenth on either side is left to the corners of the grid.
    q.push_back(lower + (0.1 + 0.8 * share) * (upper - lower));
  }
  return q;
}

struct Trial {
  TaughtReadings taught;
  double largest_step = std::numeric_limits<double>::infinity();  // between neighbouring vertices
};

// Walks the grid centred at the tool pose of `centre`, aligned with frame 0; an infinite step where
// a vertex can't be reached. The largest joint step says how far from singular the walk stays.
Trial try_placement(const ToolModel& drawing, const Grid& grid, const JointVector& centre) {
  Trial trial;
  const Result<Pose> X_0C = tool_pose(drawing, centre);
  if (!X_0C) return trial;
  const Vector3 half(grid.size_m[0] / 2, grid.size_m[1] / 2, grid.size_m[2] / 2);
  const auto joints_at = [&](const Vector3& p_W, const JointVector& seed) {
    return joints_for_tool_pose(drawing, Pose{X_0C->R, X_0C->p + p_W - half}, seed);
  };
  const auto origin = joints_at(Vector3::Zero(), centre);
  if (!origin) return trial;

  double worst = 0;
  VertexWalk walk(grid, *origin);
  while (walk.next()) {
    const auto q = joints_at(walk.vertex(), walk.seed());
    if (!q) return trial;
    worst = std::max(worst, largest_change(walk.seed(), *q));
    walk.reached(*q);
  }
  const auto on_x = joints_at(Vector3(grid.size_m[0], 0, 0), *origin);
  const auto on_xy = joints_at(Vector3(0, grid.size_m[1], 0), *origin);
  if (!on_x || !on_xy) return trial;
  trial.taught = {*origin, *on_x, *on_xy};
  trial.largest_step = worst;
  return trial;
}

}  // namespace

Result<GridPlacement> place_grid(const ToolModel& drawing, const Grid& grid) {
  GridPlacement placement{.taught = {}, .grid = grid};
  for (int shrink = 0; shrink <= kShrinkSteps; ++shrink) {
    Trial best;
    for (int n = 0; n < kCandidates; ++n) {
      const Trial trial = try_placement(drawing, placement.grid, candidate(drawing, n));
      if (trial.largest_step < best.largest_step) best = trial;
    }
    if (std::isfinite(best.largest_step)) {
      placement.taught = best.taught;
      return placement;
    }
    for (double& size : placement.grid.size_m) size *= kShrink;
  }
  return std::unexpected(Error::kOutOfReach);
}

}  // namespace armsig::evaluation
