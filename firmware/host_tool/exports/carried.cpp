// SPDX-License-Identifier: MIT
#include "firmware/host_tool/exports/carried.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "core/identification.hpp"
#include "firmware/analysis/evaluation/geometry_alone.hpp"
#include "firmware/analysis/uncertainty/tool_covariance.hpp"
#include "firmware/host_tool/exports/provenance.hpp"
#include "firmware/library/estimate.hpp"

namespace armsig::tool {
namespace {

// Poses that the geometry is fitted at, and others at which it is judged: of those looked at, the
// ones that the signature is surest of, which are those that were measured and others like them.
constexpr int kLookedAt = 3200;
constexpr std::size_t kTaken = 800;
constexpr std::size_t kJudgedOf = 4;  // every fourth

struct Poses {
  std::vector<JointVector> fitted;
  std::vector<JointVector> judged;
};

Poses poses_of(const SignatureRecord& record) {
  const auto estimate = estimate_of(record, "");
  const auto tool = tool_target(record.signature);
  std::vector<std::pair<double, JointVector>> looked_at;
  for (int n = 1; n <= kLookedAt; ++n) {
    const JointVector q =
        calibration::covered_configuration(*record.deflections, record.nominal.limits, n);
    const double variance =
        estimate && tool ? uncertainty::tool_covariance(**estimate, q, *tool).trace() : n;
    looked_at.emplace_back(variance, q);
  }
  std::ranges::sort(looked_at, {}, [](const auto& pose) { return pose.first; });
  Poses poses;
  for (std::size_t k = 0; k < kTaken; ++k) {
    (k % kJudgedOf == 0 ? poses.judged : poses.fitted).push_back(looked_at[k].second);
  }
  return poses;
}

}  // namespace

Read<Carried> carried_by(std::string_view format, Carries carries, const SignatureRecord& record) {
  Carried carried{record};
  SignatureRecord& left = carried.record;
  if (!record.deflections || carries == Carries::kEverything) return carried;
  left.deflections = nullptr;
  if (carries == Carries::kMaps) {
    auto maps = std::make_shared<calibration::ArmModel>(*record.deflections);
    maps->gravity.clear();
    left.deflections = std::move(maps);
  }
  const Poses poses = poses_of(record);
  const auto fitted = calibration::fit_geometry_alone(record.readings(), left.readings(),
                                                      poses.fitted, left.signature);
  if (!fitted) {
    return cannot_hold(format,
                       fmt::format("no geometry stands for its gravity and maps: {}",
                                   describe(fitted.error().error)),
                       "json or maps-csv, which hold them");
  }
  derive_parameters(left.signature, record.nominal);
  const calibration::Leftover lost = calibration::difference(
      record.signature, record.readings(), left.signature, left.readings(), poses.judged);
  carried.lost_rms_m = lost.rms_m;
  carried.lost_largest_m = lost.largest_m;
  left.method += fmt::format(
      "; geometry fitted anew without {}, {:.3f} mm RMS at the tool lost over the readings "
      "measured",
      carries == Carries::kMaps ? "gravity" : "gravity and joint error maps", 1e3 * lost.rms_m);
  return carried;
}

}  // namespace armsig::tool
