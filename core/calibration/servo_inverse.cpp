// SPDX-License-Identifier: MIT
#include "core/calibration/servo_inverse.hpp"

#include <cmath>

namespace armsig::calibration {

namespace {

using kinematics::Verdict;

// Whether the readings `q` themselves keep what was asked: what the joints turn was given more
// room.
Verdict verdict_of_readings(const ServoReadings& joints, const JointVector& q,
                            const JointVector& seed, const kinematics::InverseOptions& options,
                            Verdict verdict) {
  const std::size_t count = q.size();
  if (options.respect_limits && !joints.limits().empty()) {
    const JointLimits* const limits = joints.limits().data();
    for (std::size_t i = 0; i < count; ++i) {
      if (q.data()[i] < limits[i].lower || q.data()[i] > limits[i].upper) {
        return Verdict::kJointLimit;
      }
    }
  }
  const double* const most = options.max_step.data();
  for (std::size_t i = 0; i < options.max_step.size(); ++i) {
    if (!(std::abs(q.data()[i] - seed.data()[i]) <= most[i])) return Verdict::kStepLimit;
  }
  return verdict;
}

}  // namespace

Result<Pose> forward(const kinematics::Chain& chain, const ServoReadings& joints,
                     const JointVector& q) {
  if (joints.exact()) return kinematics::forward(chain, q);
  ARMSIG_TRY(turned, joints.turned(q));
  return kinematics::forward(chain, turned);
}

Result<kinematics::InverseSolution> inverse(const kinematics::Chain& chain,
                                            const ServoReadings& joints, const Pose& X_0n,
                                            const JointVector& seed,
                                            const kinematics::InverseOptions& options,
                                            LatelyTurned& lately) {
  if (joints.exact()) return kinematics::inverse(chain, X_0n, seed, options);
  JointVector turned_seed = seed;
  double* const to = turned_seed.data();
  for (std::size_t i = 0; i < seed.size(); ++i) to[i] += lately.by[i];
  kinematics::InverseOptions with_room = options;
  for (double& step : with_room.max_step) step += 2 * joints.largest();
  auto solution = kinematics::inverse(chain, X_0n, turned_seed, with_room);
  if (!solution) return solution;
  auto q = joints.readings(solution->q, lately);
  if (!q) return std::unexpected(q.error());
  solution->q = *q;
  if (solution->verdict == Verdict::kConverged || solution->verdict == Verdict::kDegraded) {
    solution->verdict = verdict_of_readings(joints, *q, seed, options, solution->verdict);
  }
  return solution;
}

Result<kinematics::InverseSolution> inverse(const kinematics::Chain& chain,
                                            const ServoReadings& joints, const Pose& X_0n,
                                            const JointVector& seed,
                                            const kinematics::InverseOptions& options) {
  LatelyTurned nothing;
  return inverse(chain, joints, X_0n, seed, options, nothing);
}

}  // namespace armsig::calibration
