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
  const auto joints = static_cast<Eigen::Index>(model_.joint_count());
  columns.middleCols(static_cast<Eigen::Index>(model_.gravity.size()), joints) =
      by_tool(row, chain, J);
  columns.rightCols<kLeans>() = by_base(row, chain);
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

// A weight at the point that is seen turns the base about two level axes. They are somewhere below
// its origin, or above it, so that the origin is shifted as well.
Eigen::Matrix<double, 3, GravityColumns::kLeans> GravityColumns::by_base(
    const EvidenceRow& row, const DeviatingChain& chain) const {
  const Vector3 up_S = chain.X_SB().R * model_.up_0;
  const Vector3 r_S = row.p_S - chain.X_SB().p;
  const Vector3 level_S = up_S.unitOrthogonal();
  Eigen::Matrix<double, 3, kLeans> columns;
  Eigen::Index column = 0;
  for (const Vector3& axis_S : {level_S, Vector3(up_S.cross(level_S))}) {
    const double moment = axis_S.dot(r_S.cross(-up_S));
    columns.col(column++) = moment * axis_S.cross(r_S);
    columns.col(column++) = moment * axis_S.cross(up_S);
  }
  return columns;
}

}  // namespace armsig::tool
