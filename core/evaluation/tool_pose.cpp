// SPDX-License-Identifier: MIT
#include "core/evaluation/tool_pose.hpp"

#include "core/kinematics/forward.hpp"

namespace armsig::evaluation {

Result<Pose> tool_pose(const ToolModel& model, const JointVector& q) {
  ARMSIG_TRY(X_0n, kinematics::forward(model.chain, q));
  return Pose{X_0n.R, X_0n * model.p_nT};
}

Result<JointVector> joints_for_tool_pose(const ToolModel& model, const Pose& X_0T,
                                         const JointVector& seed) {
  const Pose X_0n{X_0T.R, X_0T.p - X_0T.R * model.p_nT};
  ARMSIG_TRY(solution, kinematics::inverse(model.chain, X_0n, seed, {.p_nP = model.p_nT}));
  return readings_found(solution);
}

Result<JointVector> readings_found(const kinematics::InverseSolution& solution) {
  switch (solution.verdict) {
    case kinematics::Verdict::kConverged:
    case kinematics::Verdict::kDegraded:
      return solution.q;
    case kinematics::Verdict::kOutOfReach:
      return std::unexpected(Error::kOutOfReach);
    case kinematics::Verdict::kJointLimit:
      return std::unexpected(Error::kJointLimit);
    case kinematics::Verdict::kStepLimit:  // no step is limited here
    case kinematics::Verdict::kNotConverged:
      return std::unexpected(Error::kNotConverged);
  }
  return std::unexpected(Error::kNotConverged);
}

VertexWalk::VertexWalk(const Grid& grid, const JointVector& at_origin)
    : grid_(grid), layer_start_(at_origin), row_start_(at_origin), previous_(at_origin) {}

bool VertexWalk::next() {
  if (!started_) {
    started_ = true;
    return true;
  }
  if (++i_ < grid_.count[0]) return true;
  i_ = 0;
  if (++j_ < grid_.count[1]) return true;
  j_ = 0;
  return ++k_ < grid_.count[2];
}

const JointVector& VertexWalk::seed() const {
  if (i_ > 0) return previous_;
  return j_ > 0 ? row_start_ : layer_start_;
}

void VertexWalk::reached(const JointVector& q) {
  previous_ = q;
  if (i_ == 0) row_start_ = q;
  if (i_ == 0 && j_ == 0) layer_start_ = q;
}

}  // namespace armsig::evaluation
