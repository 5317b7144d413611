// SPDX-License-Identifier: MIT
#include "firmware/host_tool/programs/correct_poses.hpp"

#include <algorithm>
#include <utility>

namespace armsig::tool {
namespace {

// The readings where the nominal model reaches the pose, near `seed` or the middle of the limits.
std::optional<JointVector> nominal_readings(const EncoderArm& arm, const Pose& X_BF,
                                            const JointVector* seed, const Vector3& p_FT) {
  const auto all = arm.solutions(X_BF, seed != nullptr ? *seed : JointVector(), p_FT);
  if (!all) return std::nullopt;
  for (const FoundReadings& found : *all) {
    if (is_solved(found.verdict)) return found.readings;
  }
  return std::nullopt;
}

}  // namespace

CorrectedPoses corrected_poses(const std::vector<Pose>& poses, const ControllerView& view,
                               const std::vector<JointVector>& seeds) {
  const Pose* const tool = view.frames.tools.find("");
  const Pose* const frame = view.frames.frames.find("");
  const Pose X_FT = view.X_nE * (tool != nullptr ? *tool : Pose{});
  const Pose X_BW = view.X_0C * (frame != nullptr ? *frame : Pose{});
  CorrectedPoses result;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Pose X_BF = X_BW * poses[k] * X_FT.inverse();
    const JointVector* const seed = seeds.empty() ? nullptr : &seeds[std::min(k, seeds.size() - 1)];
    CorrectedTarget target{static_cast<int>(k) + 1, "pose", {}, {}};
    const auto at = nominal_readings(view.compensation->nominal(), X_BF, seed, X_FT.p);
    if (at) {
      target.correction = view.compensation->pose(X_BF, *at, X_FT);
    } else {
      target.correction.why = Uncorrected::kNominalReach;
    }
    const bool corrected = target.correction.why == Uncorrected::kNone;
    if (!corrected) {
      result.left.push_back({target.line, std::string(describe(target.correction.why))});
    }
    result.poses.push_back(corrected ? X_BW.inverse() * target.correction.X_BF * X_FT : poses[k]);
    result.targets.push_back(std::move(target));
  }
  return result;
}

}  // namespace armsig::tool
