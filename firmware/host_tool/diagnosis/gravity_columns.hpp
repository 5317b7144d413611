// SPDX-License-Identifier: MIT
// How the points of an arm move that gravity bends at its joints: one column a term, as
// core/calibration/gravity_choice.hpp chooses them, and one a joint of a weight at the target on
// the last link, which no term of the drawing's link frames holds. Four more are of a base that
// leans under the arm, as the weight of what it carries is farther out.
#pragma once

#include "core/calibration/model.hpp"
#include "firmware/host_tool/diagnosis/deviating_chain.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

class GravityColumns {
 public:
  explicit GravityColumns(const Arm& drawing);

  [[nodiscard]] Eigen::Index count() const {
    return static_cast<Eigen::Index>(model_.gravity.size() + model_.joint_count()) + kLeans;
  }
  // Of them, those of a weight at the target.
  [[nodiscard]] DeviatingChain::Columns of_tool() const {
    return {static_cast<Eigen::Index>(model_.gravity.size()),
            static_cast<Eigen::Index>(model_.joint_count())};
  }
  // `J`: of the row, as DeviatingChain::derivatives() gives them.
  [[nodiscard]] Eigen::Matrix3Xd of(const EvidenceRow& row, const DeviatingChain& chain,
                                    const Eigen::Matrix3Xd& J) const;

 private:
  static constexpr Eigen::Index kLeans = 4;  // a turn and a shift about each of two level axes

  [[nodiscard]] Eigen::Matrix3Xd by_tool(const EvidenceRow& row, const DeviatingChain& chain,
                                         const Eigen::Matrix3Xd& J) const;
  [[nodiscard]] Eigen::Matrix<double, 3, kLeans> by_base(const EvidenceRow& row,
                                                         const DeviatingChain& chain) const;

  calibration::ArmModel model_;
};

}  // namespace armsig::tool
