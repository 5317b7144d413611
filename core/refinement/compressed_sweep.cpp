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

// All ones for the joints that a sweep holds.
using HeldJoints = std::array<Lanes<double>::Integer, kMaxJoints>;
static_assert(kMaxJoints % Lanes<double>::kCount == 0);

bool same_sweep(const Observation& a, const Observation& b, const HeldJoints& held) {
  using V = Pack<double>;
  using Mask = PackMask<double>;
  if (b.kind != ObservationKind::kPosition || b.sweep != a.sweep || b.target != a.target ||
      (a.sigma_m > 0) != (b.sigma_m > 0)) {
    return false;
  }
  Mask moved{};
  for (std::size_t i = 0; i < kMaxJoints; i += Lanes<double>::kCount) {
    const V a_i = load<V>(a.readings.data() + i);
    const V b_i = load<V>(b.readings.data() + i);
    moved |= (a_i != b_i) & load<Mask>(&held[i]);
  }
  return all(moved == 0);
}

// One sweep seen from its swept joint.
struct View {
  std::span<const Observation> rows;
  const Chain& chain;
  const SweptJoint& swept;
  Vector3 p_first;  // statistics are taken about it, so that a far sensor costs no digits
};

double sigma_of(const Observation& row) { return row.sigma_m > 0 ? row.sigma_m : 1.0; }

// The rows from `first` on, as many as a block takes: regressors but the first, and positions about
// p_first. Returns their number; those beyond it are zeros or have the weight zero.
std::size_t take(const View& view, std::size_t first, MotionRls::Block& block) {
  using V = Pack<double>;
  const SweptJoint& swept = view.swept;
  const double middle = swept.middle.joints[swept.joint].moved;
  const std::size_t count = std::min(MotionRls::kBlockRows, view.rows.size() - first);
  if (count < MotionRls::kBlockRows) block = {};
  auto& [ones, second, third, x, y, z] = block.columns;
  double farthest = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Observation& row = view.rows[first + k];
    second[k] = view.chain.motion_of(swept.joint, row.readings) - middle;
    farthest = std::max(farthest, std::abs(second[k]));
    x[k] = row.p_S.x() - view.p_first.x();
    y[k] = row.p_S.y() - view.p_first.y();
    z[k] = row.p_S.z() - view.p_first.z();
  }
  if (!swept.revolute) {
    for (std::size_t k = 0; k < count; ++k) second[k] /= swept.half_length;
    third.fill(0);
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

// Lengths of the residuals of the path with the coefficients `fit`, into the outcomes.
void find_lengths(const View& view, const Matrix3& fit, std::span<RowOutcome> outcomes) {
  using V = Pack<double>;
  MotionRls::Block block;
  for (std::size_t first = 0; first < view.rows.size(); first += MotionRls::kBlockRows) {
    const std::size_t count = take(view, first, block);
    auto& [lengths, second, third, x, y, z] = block.columns;
    for (std::size_t k = 0; k < count; k += Lanes<double>::kCount) {
      const V f_1 = load<V>(&second[k]);
      const V f_2 = load<V>(&third[k]);
      const auto off = [&](const MotionRls::Column& measured, int c) {
        return load<V>(&measured[k]) - (fit(0, c) + f_1 * fit(1, c) + f_2 * fit(2, c));
      };
      const V d_x = off(x, 0);
      const V d_y = off(y, 1);
      const V d_z = off(z, 2);
      store(&lengths[k], square_root(d_x * d_x + d_y * d_y + d_z * d_z));
    }
    for (std::size_t k = 0; k < count; ++k) outcomes[first + k].residual_m = lengths[k];
  }
}

MotionRls factor_of(const View& view, std::span<const RowOutcome> outcomes) {
  using V = Pack<double>;
  MotionRls factor;
  MotionRls::Block block;
  for (std::size_t first = 0; first < view.rows.size(); first += MotionRls::kBlockRows) {
    const std::size_t count = take(view, first, block);
    auto& [roots, second, third, x, y, z] = block.columns;
    MotionRls::Column sigmas;
    sigmas.fill(1);
    for (std::size_t k = 0; k < count; ++k) {
      const Observation& row = view.rows[first + k];
      roots[k] = row.use == RowUse::kFit ? outcomes[first + k].weight : 0;
      sigmas[k] = sigma_of(row);
    }
    for (std::size_t k = 0; k < count; k += Lanes<double>::kCount) {
      const V root = square_root(load<V>(&roots[k])) / load<V>(&sigmas[k]);
      store(&roots[k], root);
      for (auto* column : {&second, &third, &x, &y, &z}) {
        store(&(*column)[k], load<V>(&(*column)[k]) * root);
      }
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
    find_lengths(view, fit, outcomes);
    LogHistogram squares;
    for (std::size_t k = 0; k < view.rows.size(); ++k) {
      // In sigma here; judge_rows() has the last word.
      double& length = outcomes[k].residual_m;
      length /= sigma_of(view.rows[k]);
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

// Joint, range of its motion, where the others rest. Returns the number of rows to fit.
std::size_t place(std::span<const Observation> rows, const Chain& chain, JointType type,
                  SweptJoint& swept) {
  swept.joint = rows.front().sweep - 1;
  swept.revolute = type == JointType::kRevolute;
  std::size_t fitted = 0;
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (const Observation& row : rows) {
    if (row.use != RowUse::kFit) continue;
    ++fitted;
    const double moved = chain.motion_of(swept.joint, row.readings);
    lowest = std::min(lowest, moved);
    highest = std::max(highest, moved);
  }
  swept.half_length = 0.5 * (highest - lowest);
  swept.middle = chain.motion(rows.front().readings);
  chain.move(swept.middle, swept.joint, 0.5 * (lowest + highest));
  return fitted;
}

}  // namespace

std::size_t sweep_length(std::span<const Observation> log, std::size_t first,
                         const ReadingModel& readings) {
  const Observation& row = log[first];
  if (row.sweep == 0 || row.kind != ObservationKind::kPosition) return 0;
  // The swept joint carries another one with it: no circle.
  for (const JointCoupling& coupling : readings.couplings) {
    if (coupling.from + 1 == row.sweep) return 0;
  }
  HeldJoints held{};
  for (std::size_t i = 0; i < row.readings.size(); ++i) held[i] = i + 1 == row.sweep ? 0 : -1;
  std::size_t count = 1;
  while (first + count < log.size() && same_sweep(row, log[first + count], held)) ++count;
  return count;
}

bool compress_sweep(std::span<const Observation> log, std::size_t first, std::size_t count,
                    const Chain& chain, JointType type, std::span<RowOutcome> outcomes,
                    CompressedSweep& sweep) {
  const View view{log.subspan(first, count), chain, sweep.swept, log[first].p_S};
  const std::size_t fitted = place(view.rows, chain, type, sweep.swept);
  if (fitted < kFewestSweepRows || !(sweep.swept.half_length > 0)) return false;
  const int regressors = sweep.swept.revolute ? 3 : 2;
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
  sweep.R = factor.factor();
  // Back from coordinates about the first point.
  sweep.Z = factor.rotated_right_hand_sides() + sweep.R.col(0) * view.p_first.transpose();
  return true;
}

void sweep_residuals(std::span<const Observation> rows, const CompressedSweep& sweep,
                     const Chain& chain, const Matrix3& path_S, std::span<RowOutcome> outcomes) {
  find_lengths({rows, chain, sweep.swept, Vector3::Zero()}, path_S, outcomes);
}

}  // namespace armsig::refinement
