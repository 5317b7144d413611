// SPDX-License-Identifier: MIT
#include "core/refinement/compressed_sweep.hpp"

#include <cmath>
#include <limits>

#include "core/refinement/robust.hpp"

namespace armsig::refinement {

namespace {

constexpr int kSweepPasses = 12;
constexpr std::size_t kFewestSweepRows = 4;
// Least diagonal of the factor relative to its largest: an arc of about 5 degrees. Below it the
// three regressors are hardly apart and the rows are better taken one by one.
constexpr double kLeastDiagonal = 1e-4;

// Triangular factor of rows [1, f, g | x, y, z].
struct SmallFactor {
  std::array<std::array<double, 6>, 3> rows{};
  double residual_squares = 0;

  void absorb(std::array<double, 6> row) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (row[j] == 0) continue;
      const double norm = std::sqrt(rows[j][j] * rows[j][j] + row[j] * row[j]);
      const double c = rows[j][j] / norm;
      const double s = row[j] / norm;
      for (std::size_t k = j; k < 6; ++k) {
        const double upper = rows[j][k];
        rows[j][k] = c * upper + s * row[k];
        row[k] = c * row[k] - s * upper;
      }
    }
    residual_squares += row[3] * row[3] + row[4] * row[4] + row[5] * row[5];
  }

  // Upper triangle and right-hand sides; `regressors` of the three columns are in use.
  [[nodiscard]] Matrix3 solve(int regressors) const {
    Matrix3 solution = Matrix3::Zero();
    for (int j = regressors; j-- > 0;) {
      const auto& row = rows[static_cast<std::size_t>(j)];
      Vector3 sum(row[3], row[4], row[5]);
      for (int k = j + 1; k < regressors; ++k) {
        sum -= row[static_cast<std::size_t>(k)] * solution.row(k).transpose();
      }
      solution.row(j) = sum.transpose() / row[static_cast<std::size_t>(j)];
    }
    return solution;
  }

  [[nodiscard]] bool determined(int regressors) const {
    for (int j = 0; j < regressors; ++j) {
      const auto i = static_cast<std::size_t>(j);
      if (!(rows[i][i] > kLeastDiagonal * rows[0][0])) return false;
    }
    return true;
  }
};

bool same_sweep(const Observation& a, const Observation& b) {
  if (b.kind != ObservationKind::kPosition || b.sweep != a.sweep || b.target != a.target ||
      (a.sigma_m > 0) != (b.sigma_m > 0)) {
    return false;
  }
  for (std::size_t i = 0; i < a.readings.size(); ++i) {
    if (i + 1 != a.sweep && a.readings[i] != b.readings[i]) return false;
  }
  return true;
}

// One sweep seen from its swept joint.
struct View {
  std::span<const Observation> rows;
  const Chain& chain;
  const CompressedSweep& sweep;
  Vector3 p_first;  // statistics are taken about it, so that a far sensor costs no digits
};

double residual_length(const View& view, const Observation& row, const Matrix3& fit) {
  const Vector3 predicted =
      fit.transpose() * sweep_regressors(view.sweep, view.chain, row.readings);
  const double sigma = row.sigma_m > 0 ? row.sigma_m : 1.0;
  return (row.p_S - view.p_first - predicted).norm() / sigma;
}

SmallFactor factor_of(const View& view, std::span<const RowOutcome> outcomes) {
  SmallFactor factor;
  for (std::size_t k = 0; k < view.rows.size(); ++k) {
    const Observation& row = view.rows[k];
    if (row.use != RowUse::kFit || outcomes[k].weight == 0) continue;
    const double w = std::sqrt(outcomes[k].weight) / (row.sigma_m > 0 ? row.sigma_m : 1.0);
    const Vector3 f = sweep_regressors(view.sweep, view.chain, row.readings);
    const Vector3 p = w * (row.p_S - view.p_first);
    factor.absorb({w * f[0], w * f[1], w * f[2], p.x(), p.y(), p.z()});
  }
  return factor;
}

// Robust fit of the regressors over `fitted` rows; leaves the weights in `outcomes` and the factor
// of the rows so weighted. False without half of the rows.
bool weigh(const View& view, int regressors, std::size_t fitted, std::span<RowOutcome> outcomes,
           SmallFactor& factor) {
  const auto rows = static_cast<double>(fitted);
  const double freedom = rows / (rows - regressors);
  for (int pass = 0; pass < kSweepPasses; ++pass) {
    factor = factor_of(view, outcomes);
    if (!factor.determined(regressors)) return false;
    const Matrix3 fit = factor.solve(regressors);
    LogHistogram squares;
    for (std::size_t k = 0; k < view.rows.size(); ++k) {
      if (view.rows[k].use != RowUse::kFit) continue;
      const double length = residual_length(view, view.rows[k], fit);
      outcomes[k].residual_m = length;  // in sigma here; judge_rows() has the last word
      squares.add(length * length);
    }
    double scale = std::sqrt(squares.median() / kMedianChiSquare3 * freedom);
    if (view.rows.front().sigma_m > 0) scale = std::max(scale, 1.0);
    // The gate only once Huber's convex fit has found the circle.
    const bool gated = pass >= kSweepPasses / 2;
    std::size_t used = 0;
    double change = 0;
    for (std::size_t k = 0; k < view.rows.size(); ++k) {
      if (view.rows[k].use != RowUse::kFit) continue;
      const double length = outcomes[k].residual_m;
      double weight = length <= kHuberKnee3 * scale ? 1.0 : kHuberKnee3 * scale / length;
      if (gated && length > kGate3 * scale) weight = 0;
      change = std::max(change, std::abs(weight - outcomes[k].weight));
      outcomes[k].weight = weight;
      outcomes[k].rejected = weight == 0;
      if (weight > 0) ++used;
    }
    if (2 * used < fitted || used < kFewestSweepRows) return false;
    if (change == 0 || (gated && change < 1e-6)) return true;
  }
  factor = factor_of(view, outcomes);
  return factor.determined(regressors);
}

// Joint, range of the motion, nodes: a third of a turn apart, or the two ends of the line. Returns
// the number of rows to fit.
std::size_t place(std::span<const Observation> rows, const Chain& chain, JointType type,
                  CompressedSweep& sweep) {
  sweep.joint = rows.front().sweep - 1;
  sweep.revolute = type == JointType::kRevolute;
  std::size_t fitted = 0;
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (const Observation& row : rows) {
    if (row.use != RowUse::kFit) continue;
    ++fitted;
    const double moved = chain.motion_of(sweep.joint, row.readings);
    lowest = std::min(lowest, moved);
    highest = std::max(highest, moved);
  }
  sweep.middle = 0.5 * (lowest + highest);
  sweep.half_length = 0.5 * (highest - lowest);
  sweep.from_nodes.setZero();
  sweep.nodes = {lowest, highest, sweep.middle};
  if (sweep.revolute) {
    for (int k = 0; k < 3; ++k) {
      const double d = 2.0 * kPi / 3.0 * k;
      sweep.nodes[static_cast<std::size_t>(k)] = sweep.middle + d;
      sweep.from_nodes.col(k) << 1.0 / 3.0, 2.0 / 3.0 * std::cos(d), 2.0 / 3.0 * std::sin(d);
    }
  } else {
    sweep.from_nodes.col(0) << 0.5, -0.5, 0;
    sweep.from_nodes.col(1) << 0.5, 0.5, 0;
  }
  return fitted;
}

}  // namespace

JointMotion node_motion(const CompressedSweep& sweep, const Chain& chain, const JointVector& held,
                        std::size_t node) {
  JointMotion motion = chain.motion(held);
  chain.move(motion, sweep.joint, sweep.nodes[node]);
  return motion;
}

Vector3 sweep_regressors(const CompressedSweep& sweep, const Chain& chain,
                         const JointVector& readings) {
  const double d = chain.motion_of(sweep.joint, readings) - sweep.middle;
  if (sweep.revolute) return {1, std::cos(d), std::sin(d)};
  return {1, d / sweep.half_length, 0};
}

std::size_t sweep_length(std::span<const Observation> log, std::size_t first,
                         const ReadingModel& readings) {
  const Observation& row = log[first];
  if (row.sweep == 0 || row.kind != ObservationKind::kPosition) return 0;
  // The swept joint carries another one with it: no circle.
  for (const JointCoupling& coupling : readings.couplings) {
    if (coupling.from + 1 == row.sweep) return 0;
  }
  std::size_t count = 1;
  while (first + count < log.size() && same_sweep(row, log[first + count])) ++count;
  return count;
}

bool compress_sweep(std::span<const Observation> log, std::size_t first, std::size_t count,
                    const Chain& chain, JointType type, std::span<RowOutcome> outcomes,
                    CompressedSweep& sweep) {
  const View view{log.subspan(first, count), chain, sweep, log[first].p_S};
  const std::size_t fitted = place(view.rows, chain, type, sweep);
  if (fitted < kFewestSweepRows || !(sweep.half_length > 0)) return false;
  const int regressors = sweep.revolute ? 3 : 2;
  const std::span<RowOutcome> marked = outcomes.subspan(first, count);
  for (RowOutcome& outcome : marked) outcome = {};
  SmallFactor factor;
  if (!weigh(view, regressors, fitted, marked, factor)) {
    for (RowOutcome& outcome : marked) outcome = {};
    return false;
  }

  sweep.first_row = first;
  sweep.row_count = count;
  sweep.used = 0;
  for (std::size_t k = 0; k < count; ++k) {
    if (view.rows[k].use == RowUse::kFit && !marked[k].rejected) ++sweep.used;
  }
  sweep.target = log[first].target;
  sweep.sigma_stated = log[first].sigma_m > 0;
  sweep.residual_squares = factor.residual_squares;
  Matrix3 R = Matrix3::Zero();
  sweep.Z.setZero();
  for (int i = 0; i < regressors; ++i) {
    const auto& row = factor.rows[static_cast<std::size_t>(i)];
    for (int j = i; j < regressors; ++j) R(i, j) = row[static_cast<std::size_t>(j)];
    sweep.Z.row(i) << row[3], row[4], row[5];
  }
  sweep.W = R * sweep.from_nodes;
  // Back from coordinates about the first point.
  sweep.Z += R.col(0) * view.p_first.transpose();
  return true;
}

}  // namespace armsig::refinement
