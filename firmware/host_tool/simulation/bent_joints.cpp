// SPDX-License-Identifier: MIT
#include "firmware/host_tool/simulation/bent_joints.hpp"

#include <cmath>

#include <fmt/format.h>

#include "core/calibration/packed_deflections.hpp"

namespace armsig::tool {

Read<std::shared_ptr<const calibration::ArmModel>> bounded_bends(const Arm& drawing,
                                                                 const cabinet::Bends& bends,
                                                                 simulated::Random& random) {
  if (!bends.any()) return nullptr;
  auto bent =
      std::make_shared<const calibration::ArmModel>(cabinet::bent_model(drawing, bends, random));
  const calibration::PackedDeflections told = calibration::packed(*bent);
  for (std::size_t i = 0; i < told.maps.size(); ++i) {
    if (calibration::is_bounded(told.maps[i])) continue;
    return std::unexpected(
        Problem{"--maps-deg", 0, 0,
                fmt::format("{:.3g} is too steep a map of joint {}", degrees(bends.map_rad), i + 1),
                "one that moves the joint by at most a tenth of what its reading moves"});
  }
  for (const calibration::GravityTerm& term : told.gravity) {
    if (calibration::is_bounded(term, drawing)) continue;
    return std::unexpected(Problem{
        "--deflection-mm", 0, 0,
        fmt::format("{:.3g} turns joint {} by {:.2g}° for each metre that the weight is out",
                    1e3 * bends.sag_m, term.joint + 1, degrees(std::abs(term.coefficient))),
        fmt::format("at most {:.2g}°", degrees(calibration::kLargestDeflection /
                                               calibration::longest_lever_m(drawing)))});
  }
  return bent;
}

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
