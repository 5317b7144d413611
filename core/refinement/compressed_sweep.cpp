// SPDX-License-Identifier: MIT
#include "core/refinement/compressed_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/lanes.hpp"
#include "core/base/sine_cosine.hpp"
#include "core/features/sweep_statistics.hpp"
#include "core/refinement/robust.hpp"

namespace armsig::refinement {

namespace {

constexpr int kSweepPasses = 12;
constexpr std::size_t kFewestSweepRows = 4;
// Least diagonal of the factor relative to its largest: an arc of about 5 degrees. Below it the
// three regressors are hardly apart and the rows are better taken one by one.
constexpr double kLeastDiagonal = 1e-4;

using features::MotionRls;

bool determined(const Matrix3& R, int regressors) {
  for (int i = 0; i < regressors; ++i) {
    if (!(R(i, i) > kLeastDiagonal * R(0, 0))) return false;
  }
  return true;
}

bool same_sweep(const Observation& a, const Observation& b) {
  if (b.kind != ObservationKind::kPosition || b.sweep != a.sweep || b.target != a.target ||
      (a.sigma_m > 0) != (b.sigma_m > 0)) {
    return false;
  }
  const std::size_t swept = a.sweep - 1;
  return std::equal(a.readings.begin(), a.readings.begin() + swept, b.readings.begin()) &&
         std::equal(a.readings.begin() + a.sweep, a.readings.end(), b.readings.begin() + a.sweep);
}

// One sweep seen from its swept joint.
struct View {
  std::span<const Observation> rows;
  const Chain& chain;
  const CompressedSweep& sweep;
  Vector3 p_first;  // statistics are taken about it, so that a far sensor costs no digits
};

double sigma_of(const Observation& row) { return row.sigma_m > 0 ? row.sigma_m : 1.0; }

// The rows from `first` on, as many as a block takes, with the weight 1: regressors and positions
// about p_first. Returns their number.
std::size_t take(const View& view, std::size_t first, MotionRls::Block& block) {
  using V = Pack<double>;
  const CompressedSweep& sweep = view.sweep;
  const std::size_t count = std::min(MotionRls::kBlockRows, view.rows.size() - first);
  block = {};
  auto& [ones, second, third, x, y, z] = block.columns;
  double farthest = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Observation& row = view.rows[first + k];
    ones[k] = 1;
    second[k] = view.chain.motion_of(sweep.joint, row.readings) - sweep.middle;
    farthest = std::max(farthest, std::abs(second[k]));
    x[k] = row.p_S.x() - view.p_first.x();
    y[k] = row.p_S.y() - view.p_first.y();
    z[k] = row.p_S.z() - view.p_first.z();
  }
  if (!sweep.revolute) {
    for (std::size_t k = 0; k < count; ++k) second[k] /= sweep.half_length;
  } else if (farthest <= SineCosineConstants<double>::kLargestAngle) {
    for (std::size_t k = 0; k < count; k += Lanes<double>::kCount) {
      V sine;
      V cosine;
      sine_cosine<double>(load<V>(&second[k]), sine, cosine);
      store(&second[k], cosine);
      store(&third[k], sine);
    }
  } else {
    for (std::size_t k = 0; k < count; ++k) {
      const auto [sine, cosine] = sine_and_cosine(second[k]);
      second[k] = cosine;
      third[k] = sine;
    }
  }
  return count;
}

// Residual lengths over sigma, into the outcomes.
void find_lengths(const View& view, const Matrix3& fit, std::span<RowOutcome> outcomes) {
  using V = Pack<double>;
  MotionRls::Block block;
  for (std::size_t first = 0; first < view.rows.size(); first += MotionRls::kBlockRows) {
    const std::size_t count = take(view, first, block);
    auto& [squares, second, third, x, y, z] = block.columns;
    for (std::size_t k = 0; k < count; k += Lanes<double>::kCount) {
      const V f_1 = load<V>(&second[k]);
      const V f_2 = load<V>(&third[k]);
      const auto off = [&](const MotionRls::Column& measured, int c) {
        return load<V>(&measured[k]) - (fit(0, c) + f_1 * fit(1, c) + f_2 * fit(2, c));
      };
      const V d_x = off(x, 0);
      const V d_y = off(y, 1);
      const V d_z = off(z, 2);
      store(&squares[k], d_x * d_x + d_y * d_y + d_z * d_z);
    }
    for (std::size_t k = 0; k < count; ++k) {
      outcomes[first + k].residual_m = std::sqrt(squares[k]) / sigma_of(view.rows[first + k]);
    }
  }
}

MotionRls factor_of(const View& view, std::span<const RowOutcome> outcomes) {
  using V = Pack<double>;
  MotionRls factor;
  MotionRls::Block block;
  for (std::size_t first = 0; first < view.rows.size(); first += MotionRls::kBlockRows) {
    const std::size_t count = take(view, first, block);
    auto& weights = block.columns[0];
    for (std::size_t k = 0; k < count; ++k) {
      const Observation& row = view.rows[first + k];
      weights[k] =
          row.use == RowUse::kFit ? std::sqrt(outcomes[first + k].weight) / sigma_of(row) : 0;
    }
    for (std::size_t i = 1; i < block.columns.size(); ++i) {
      MotionRls::Column& column = block.columns[i];
      for (std::size_t k = 0; k < MotionRls::kBlockRows; k += Lanes<double>::kCount)
        store(&column[k], load<V>(&column[k]) * load<V>(&weights[k]));
    }
    factor.update(block);
  }
  return factor;
}

// Robust fit of the regressors over `fitted` rows; leaves the weights in `outcomes` and the factor
// of the rows so weighted. False without half of the rows.
bool weigh(const View& view, int regressors, std::size_t fitted, std::span<RowOutcome> outcomes,
           MotionRls& factor) {
  const auto rows = static_cast<double>(fitted);
  const double freedom = rows / (rows - regressors);
  for (int pass = 0; pass < kSweepPasses; ++pass) {
    factor = factor_of(view, outcomes);
    if (!determined(factor.factor(), regressors)) return false;
    const Matrix3 fit = factor.solve();
    find_lengths(view, fit, outcomes);  // in sigma here; judge_rows() has the last word
    LogHistogram squares;
    for (std::size_t k = 0; k < view.rows.size(); ++k) {
      const double length = outcomes[k].residual_m;
      if (view.rows[k].use == RowUse::kFit) squares.add(length * length);
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
  return determined(factor.factor(), regressors);
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

Vector3 sweep_regressors(const CompressedSweep& sweep, const Chain& chain,
                         const JointVector& readings) {
  const double d = chain.motion_of(sweep.joint, readings) - sweep.middle;
  if (sweep.revolute) {
    const auto [sine, cosine] = sine_and_cosine(d);
    return {1, cosine, sine};
  }
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
  MotionRls factor;
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
  sweep.residual_squares = factor.residual_products().trace();
  const Matrix3 R = factor.factor();
  sweep.Z = factor.rotated_right_hand_sides();
  sweep.W = R * sweep.from_nodes;
  // Back from coordinates about the first point.
  sweep.Z += R.col(0) * view.p_first.transpose();
  return true;
}

}  // namespace armsig::refinement
