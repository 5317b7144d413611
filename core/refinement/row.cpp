// SPDX-License-Identifier: MIT
#include "core/refinement/row.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::refinement {

namespace {

void absorb_position(const Refined& estimate, const PoeChain& chain, const Observation& row,
                     double weight, const Linearised& at, SquareRootFactor& factor) {
  const Layout& layout = estimate.layout;
  const std::size_t n = layout.size();
  const double scaled = 1 + estimate.scale;
  RowBlock<3> block;
  block.clear(n);
  add_derivatives(layout, estimate.signature, chain, at.motion, row.target, at.jacobian,
                  weight * scaled, block);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto c = static_cast<Eigen::Index>(k);
    if (layout.scale != kNoColumn) block.rows[k][layout.scale] = weight * at.jacobian.p_S[c];
    block.rows[k][n] = weight * (row.p_S[c] - scaled * at.jacobian.p_S[c]);
  }
  factor.absorb(block);
}

void absorb_range(const Refined& estimate, const Receivers& receivers, const PoeChain& chain,
                  const Observation& row, double weight, const Linearised& at,
                  SquareRootFactor& factor) {
  const Layout& layout = estimate.layout;
  const std::size_t n = layout.size();
  const PredictedRange predicted = predict_range(estimate, receivers, row, at.jacobian.p_S);
  RowBlock<1> block;
  block.clear(n);
  add_derivatives(layout, estimate.signature, chain, at.motion, row.target, at.jacobian,
                  weight * predicted.gradient, block);
  if (layout.receiver_offsets != kNoColumn) {
    block.rows[0][layout.receiver_offsets + row.receiver] = weight;
  }
  if (layout.scale != kNoColumn) {
    block.rows[0][layout.scale] = weight * (at.jacobian.p_S - receivers[row.receiver]).norm();
  }
  block.rows[0][n] = weight * (row.range_m - predicted.value);
  factor.absorb(block);
}

}  // namespace

bool is_finite(const Observation& row) {
  // Zero times anything finite is zero, times anything else no number.
  double zero = 0 * row.sigma_m;
  zero += 0 * (row.kind == ObservationKind::kPosition ? row.p_S.sum() : row.range_m);
  for (const double reading : row.readings) zero += 0 * reading;
  return zero == 0;
}

PredictedRange predict_range(const Refined& estimate, const Receivers& receivers,
                             const Observation& row, const Vector3& p_S) {
  const Vector3 from_receiver = p_S - receivers[row.receiver];
  const double distance = from_receiver.norm();
  const double scaled = 1 + estimate.scale;
  PredictedRange predicted;
  predicted.value = scaled * distance + estimate.receiver_offsets_m[row.receiver];
  // A target on the receiver itself has no direction; its row then says nothing about the target.
  if (distance > 0) predicted.gradient = scaled / distance * from_receiver;
  return predicted;
}

double residual_length(const Refined& estimate, const Receivers& receivers, const Observation& row,
                       const Vector3& p_S) {
  if (row.kind == ObservationKind::kRange) {
    return std::abs(row.range_m - predict_range(estimate, receivers, row, p_S).value);
  }
  return (row.p_S - (1 + estimate.scale) * p_S).norm();
}

Linearised position_rows(const Refined& estimate, const PoeChain& chain,
                         const JointVector& readings, std::size_t target, RowBlock<3>& rows) {
  Linearised at;
  at.motion = chain.motion(readings);
  chain.point_and_jacobian(at.motion, estimate.signature.targets[target], at.jacobian);
  rows.clear(estimate.layout.size());
  add_derivatives(estimate.layout, estimate.signature, chain, at.motion, target, at.jacobian, 1.0,
                  rows);
  return at;
}

void absorb_row(const Refined& estimate, const Receivers& receivers, const PoeChain& chain,
                const Observation& row, double weight, SquareRootFactor& factor,
                Linearised& linearised) {
  linearised.motion = chain.motion(row.readings);
  chain.point_and_jacobian(linearised.motion, estimate.signature.targets[row.target],
                           linearised.jacobian);
  if (row.kind == ObservationKind::kPosition) {
    absorb_position(estimate, chain, row, weight, linearised, factor);
  } else {
    absorb_range(estimate, receivers, chain, row, weight, linearised, factor);
  }
}

}  // namespace armsig::refinement
