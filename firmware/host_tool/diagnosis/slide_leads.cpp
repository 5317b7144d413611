// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/slide_leads.hpp"

#include <algorithm>
#include <cmath>

#include "core/calibration/standing_still.hpp"

namespace armsig::tool {

SlideLeads::SlideLeads(const Evidence& evidence) {
  const auto& joints = evidence.arm.joints;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto readings = [](const EvidenceRow& row) { return row.q; };
    if (joints[j].type != JointType::kPrismatic ||
        calibration::stood_still(evidence.rows, readings, j, joints[j].type)) {
      continue;
    }
    const double alpha = joints[j].alpha_rad;
    slides_.push_back({j, Vector3(0, std::sin(alpha), std::cos(alpha))});
  }
}

Eigen::Matrix3Xd SlideLeads::of(const EvidenceRow& row, const DeviatingChain& chain,
                                const Eigen::Matrix3Xd& J) const {
  Eigen::Matrix3Xd columns = Eigen::Matrix3Xd::Zero(3, count());
  const auto& targets = chain.targets();
  const auto target = std::ranges::find(targets, row.target, &SeenTarget::number);
  for (Eigen::Index k = 0; k < count(); ++k) {
    const Slide& slide = slides_[static_cast<std::size_t>(k)];
    if (slide.joint >= target->link) continue;
    // The zero of the joint before the target is the target's: the chain has none of its own.
    const auto own = chain.of_target(static_cast<std::size_t>(target - targets.begin()));
    const Vector3 along_S = slide.joint + 1 == target->link
                                ? Vector3(J.middleCols<3>(own.first) * slide.axis_L)
                                : Vector3(J.col(chain.of_zero(slide.joint).first));
    columns.col(k) = row.q[slide.joint] * along_S;
  }
  return columns;
}

}  // namespace armsig::tool
