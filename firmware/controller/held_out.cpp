// SPDX-License-Identifier: MIT
#include "firmware/controller/held_out.hpp"

#include <cmath>

#include "core/frames/alignment.hpp"
#include "core/kinematics/s_model_chain.hpp"

namespace armsig::controller {

void lay_over(Signature& active, const Signature& candidate) {
  FixedVector<Pose, kMaxFrames> X_AL;
  for (std::size_t k = 0; k < active.X_SL.size(); ++k) {
    X_AL.push_back(kinematics::link_pose(active, candidate.configuration, k));
  }
  active.X_SL = X_AL;
  active.configuration = candidate.configuration;
  const Pose X_SA = frames::align(frames::axis_lines(candidate), frames::axis_lines(active)).X_AB;
  for (Pose& X : active.X_SL) X = X_SA * X;
  active.targets = candidate.targets;
}

HeldOutReport compare(const Signature& candidate, const Signature& active,
                      const MeasurementLog& log) {
  HeldOutReport report;
  double candidate_m2 = 0;
  double active_m2 = 0;
  for (const LogEntry& row : log) {
    if (row.sweep != 0) continue;
    const auto miss = [&](const Signature& model) {
      return (kinematics::target_position(model, row.readings, model.targets[0]) - row.p_S)
          .squaredNorm();
    };
    candidate_m2 += miss(candidate);
    active_m2 += miss(active);
    ++report.poses;
  }
  if (report.poses == 0) return report;
  const auto count = static_cast<double>(report.poses);
  report.candidate_rms_m = std::sqrt(candidate_m2 / count);
  report.active_rms_m = std::sqrt(active_m2 / count);
  return report;
}

}  // namespace armsig::controller
