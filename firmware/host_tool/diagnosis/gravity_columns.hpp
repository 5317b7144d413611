// SPDX-License-Identifier: MIT
// How the points of an arm move that gravity bends at its joints: one column a term, as
// core/arm_model/gravity_choice.hpp chooses them.
#pragma once

#include "core/arm_model/model.hpp"
#include "firmware/host_tool/diagnosis/deviating_chain.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

class GravityColumns {
 public:
  explicit GravityColumns(const Arm& drawing);

  [[nodiscard]] Eigen::Index count() const {
    return static_cast<Eigen::Index>(model_.gravity.size());
  }
  // `J`: of the row, as DeviatingChain::derivatives() gives them.
  [[nodiscard]] Eigen::Matrix3Xd of(const EvidenceRow& row, const DeviatingChain& chain,
                                    const Eigen::Matrix3Xd& J) const;

 private:
  calibration::ArmModel model_;
};

}  // namespace armsig::tool
