// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/gravity_columns.hpp"

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
  return columns;
}

}  // namespace armsig::tool
