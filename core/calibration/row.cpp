// SPDX-License-Identifier: MIT
#include "core/calibration/row.hpp"

#include <cmath>

namespace armsig::calibration {

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
  add_derivatives(estimate.layout, estimate.signature, chain, at.motion, target, at.jacobian, rows);
  return at;
}

Linearised absorb_row(const Refined& estimate, const Receivers& receivers, const PoeChain& chain,
                      const Observation& row, double weight, SquareRootFactor& factor) {
  const Layout& layout = estimate.layout;
  const std::size_t n = layout.size();
  RowBlock<3> position;
  Linearised at = position_rows(estimate, chain, row.readings, row.target, position);
  const Vector3& p_S = at.jacobian.p_S;
  if (row.kind == ObservationKind::kPosition) {
    const double scaled = 1 + estimate.scale;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto c = static_cast<Eigen::Index>(k);
      for (std::size_t u = 0; u < n; ++u) position.rows[k][u] *= weight * scaled;
      if (layout.scale != kNoColumn) position.rows[k][layout.scale] = weight * p_S[c];
      position.rows[k][n] = weight * (row.p_S[c] - scaled * p_S[c]);
    }
    factor.absorb(position);
    return at;
  }
  const PredictedRange predicted = predict_range(estimate, receivers, row, p_S);
  const auto& [x, y, z] = position.rows;
  RowBlock<1> range;
  for (std::size_t u = 0; u < n; ++u) {
    range.rows[0][u] = weight * predicted.gradient.dot(Vector3(x[u], y[u], z[u]));
  }
  if (layout.receiver_offsets != kNoColumn) {
    range.rows[0][layout.receiver_offsets + row.receiver] = weight;
  }
  if (layout.scale != kNoColumn) {
    range.rows[0][layout.scale] = weight * (p_S - receivers[row.receiver]).norm();
  }
  range.rows[0][n] = weight * (row.range_m - predicted.value);
  factor.absorb(range);
  return at;
}

}  // namespace armsig::calibration
