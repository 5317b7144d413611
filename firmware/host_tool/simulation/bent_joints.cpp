// SPDX-License-Identifier: MIT
#include "firmware/host_tool/simulation/bent_joints.hpp"

namespace armsig::tool {

JointVector BentJoints::turned(const JointVector& readings) {
  if (model_ == nullptr) return readings;
  JointVector behind;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (!before_.empty() && readings[i] != before_[i]) {
      side_[i] = readings[i] > before_[i] ? 1 : -1;
    }
    behind.push_back(0.5 * side_[i] * cabinet::bend_amount(model_->joints[i].type, play_rad_));
  }
  before_ = readings;
  return cabinet::turned(*model_, readings, behind);
}

}  // namespace armsig::tool
