// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/gravity_columns.hpp"

#include <algorithm>

namespace armsig::tool {

GravityColumns::GravityColumns(const Arm& drawing)
    : model_(calibration::model_of(drawing, Pose{})) {
  model_.couplings = drawing.couplings;
  calibration::choose_gravity_terms(drawing, model_);
}

Eigen::Matrix3Xd GravityColumns::of(const EvidenceRow& row, const DeviatingChain& chain,
                                    const Eigen::Matrix3Xd& J) const {
  calibration::GravityLevers levers;
  calibration::gravity_levers(model_, effective_readings(model_.couplings, row.q), levers);
  Eigen::Matrix3Xd columns(3, count());
  for (std::size_t t = 0; t < model_.gravity.size(); ++t) {
    const std::size_t joint = model_.gravity[t].joint;
    columns.col(static_cast<Eigen::Index>(t)) = levers[t] * J.col(chain.of_zero(joint).first);
  }
  columns.rightCols(static_cast<Eigen::Index>(model_.joint_count())) = by_tool(row, chain, J);
  return columns;
}

// The lever of a weight about an axis is how fast the joint lowers it.
Eigen::Matrix3Xd GravityColumns::by_tool(const EvidenceRow& row, const DeviatingChain& chain,
                                         const Eigen::Matrix3Xd& J) const {
  const std::size_t joints = model_.joint_count();
  Eigen::Matrix3Xd columns = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(joints));
  const auto tool = std::ranges::find(chain.targets(), joints, &SeenTarget::link);
  if (tool == chain.targets().end()) return columns;
  Eigen::Matrix3Xd of_tool = J;
  if (tool->number != row.target) {
    EvidenceRow at_tool = row;
    at_tool.target = tool->number;
    chain.derivatives(at_tool, of_tool);
  }
  const Vector3 down = -(chain.X_SB().R * model_.up_0);
  for (std::size_t j = 0; j < joints; ++j) {
    const Eigen::Index zero = chain.of_zero(j).first;
    columns.col(static_cast<Eigen::Index>(j)) = down.dot(of_tool.col(zero)) * J.col(zero);
  }
  return columns;
}

}  // namespace armsig::tool
