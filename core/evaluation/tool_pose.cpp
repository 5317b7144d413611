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
  using enum kinematics::Verdict;
  if (solution.verdict == kConverged || solution.verdict == kDegraded) return solution.q;
  if (solution.verdict == kOutOfReach) return std::unexpected(Error::kOutOfReach);
  if (solution.verdict == kJointLimit) return std::unexpected(Error::kJointLimit);
  return std::unexpected(Error::kNotConverged);  // no step is limited here
}

VertexWalk::VertexWalk(const Grid& grid, const JointVector& at_origin) : grid_(grid) {
  starts_.fill(at_origin);
}

bool VertexWalk::next() {
  const std::size_t n = visited_++;
  at_ = {n % grid_.count[0], n / grid_.count[0] % grid_.count[1],
         n / (grid_.count[0] * grid_.count[1])};
  return n < grid_.vertex_count();
}

const JointVector& VertexWalk::seed() const {
  if (at_[0] > 0) return starts_[0];
  return at_[1] > 0 ? starts_[1] : starts_[2];
}

void VertexWalk::reached(const JointVector& q) {
  starts_[0] = q;
  if (at_[0] == 0) starts_[1] = q;
  if (at_[0] == 0 && at_[1] == 0) starts_[2] = q;
}

}  // namespace armsig::evaluation
