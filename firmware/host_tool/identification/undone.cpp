// SPDX-License-Identifier: MIT
#include "firmware/host_tool/identification/undone.hpp"

#include <span>

#include <Eigen/Dense>

namespace armsig::tool {
namespace {

// How far the errors of the ranges to the receivers move a point that is found from them: least
// squares, to first order.
Vector3 moved_by_offsets(const Vector3& p_S, const SensorDescription& sensor,
                         std::span<const double> offsets_m) {
  Matrix3 H = Matrix3::Zero();
  Vector3 g = Vector3::Zero();
  for (std::size_t r = 0; r < offsets_m.size(); ++r) {
    const Vector3 u = (p_S - sensor.receivers_S[r]).normalized();
    H += u * u.transpose();
    g += u * offsets_m[r];
  }
  return H.ldlt().solve(g);
}

}  // namespace

Evidence undone(const Evidence& evidence, const RefinementOutcome& outcome,
                const std::optional<SensorDescription>& sensor) {
  Evidence unscaled = evidence;
  const std::size_t offsets =
      outcome.fitted.receiver_offsets && sensor ? sensor->receivers_S.size() : 0;
  for (EvidenceRow& row : unscaled.rows) {
    if (offsets > 0) {
      row.p_S -= moved_by_offsets(row.p_S, *sensor,
                                  std::span(outcome.refined->receiver_offsets_m).first(offsets));
    }
    row.p_S /= 1 + outcome.refined->scale;
    const auto moved = outcome.moved_by_play.find(row.line);
    if (moved != outcome.moved_by_play.end()) row.p_S -= moved->second;
  }
  return unscaled;
}

}  // namespace armsig::tool
