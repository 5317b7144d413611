// SPDX-License-Identifier: MIT
// One joint's map improved, the other unknowns as they are.
#include "core/calibration/engine.hpp"
#include "core/calibration/engine_detail.hpp"

namespace armsig::calibration {

// Visits the rows that map `joint_` moves: with their motion for one unit of it.
template <typename Visit>
void Engine::for_rows_of_map(Units rows, Visit visit) {
  const JointType type = model_.joints[joint_].type;
  const bool revolute = type == JointType::kRevolute;
  const double unit = map_unit(type);
  for (std::size_t k = rows.first; k < rows.last; ++k) {
    FitRow& row = rows_[k];
    const ModelTarget& target = targets_[row.target];
    if (row.held_out || joint_ >= target.link) continue;
    const ChainFrames& frames = frames_of(k);
    const Vector3 p_S = frames.X_SL * target.p_L;
    visit(row, Vector3(unit * motion_of(revolute, frames.X_SJ[joint_], p_S)),
          frames.support[joint_]);
  }
}

void Engine::begin_map() {
  const MapCoefficients& own = model_.joints[joint_].map;
  const MapCoefficients& step = work_.map_step[joint_];
  for (std::size_t k = 0; k < kKnots; ++k) {
    const double from_own = probes_ ? 0 : map_prior_times(own, k);
    work_.map_gradient[k] = -(from_own + map_prior_times(step, k)) / scales_.map[joint_];
  }
}

void Engine::pull_map(Units rows) {
  MapCoefficients& x = work_.map_gradient;
  for_rows_of_map(
      rows, [&](const FitRow& row, const Vector3& motion, const SplineSupport& support) {
        if (row.weight == 0) return;
        const double pull =
            row.weight / scales_.sigma_squared * motion.dot(precision(row) * row.residual);
        for (std::size_t k = 0; k < kSplines; ++k) x[support.knot(k)] += pull * support.weight[k];
      });
}

void Engine::solve_map() {
  MapCoefficients& x = work_.map_gradient;
  work_.factor.factorise(work_.band[joint_], scales_.sigma_squared, map_prior(),
                         scales_.map[joint_]);
  work_.factor.solve(x);
  for (std::size_t k = 0; k < kKnots; ++k) work_.map_step[joint_][k] += x[k];
}

void Engine::follow_map(Units rows) {
  const MapCoefficients& x = work_.map_gradient;
  for_rows_of_map(rows, [&](FitRow& row, const Vector3& motion, const SplineSupport& support) {
    row.residual -= map_value(x, support) * motion;
  });
}

}  // namespace armsig::calibration
