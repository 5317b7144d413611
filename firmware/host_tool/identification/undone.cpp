// SPDX-License-Identifier: MIT
#include "firmware/host_tool/identification/undone.hpp"

#include <algorithm>
#include <span>

#include <Eigen/Dense>

#include "firmware/host_tool/refinement/candidates.hpp"

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
  std::uint8_t with_backlash = 0;
  for (std::size_t j = 0; j < outcome.half_plays.size(); ++j) {
    if (is_certain(outcome.half_plays[j])) with_backlash |= static_cast<std::uint8_t>(1U << j);
  }
  std::erase_if(unscaled.rows, [&](const EvidenceRow& row) {
    return row.sweep == 0 && (with_backlash & ~row.sided) != 0 &&
           std::ranges::binary_search(outcome.rejected_lines, row.line);
  });
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
