// SPDX-License-Identifier: MIT
#include "firmware/analysis/starts/reading_suspicion.hpp"

#include <array>
#include <limits>

#include "core/calibration/standing_still.hpp"

namespace armsig::calibration {

namespace {

// An explanation must leave less than this share of the residuals.
constexpr double kConvincing = 0.4;
// Of the ratio's golden-section search: how far it may be from -1 or 1, and how often it narrows.
constexpr double kRatioRange = 0.5;
constexpr int kRatioSteps = 16;
constexpr double kReversed = -2;
// A ratio other than -1 or 1 must leave less than this share of what those leave.
constexpr double kOtherRatio = 0.5;

// The drawing with that coupling instead of the one it has between the two joints.
double rms_with(const Arm& arm, const JointCoupling& coupling, std::span<const Observation> log,
                std::span<const Target> targets) {
  Arm changed = arm;
  changed.couplings.clear();
  for (const JointCoupling& drawn : arm.couplings) {
    if (drawn.joint != coupling.joint || drawn.from != coupling.from) {
      changed.couplings.push_back(drawn);
    }
  }
  if (changed.couplings.full()) return std::numeric_limits<double>::infinity();
  changed.couplings.push_back(coupling);
  const auto fitted = fit_base_and_tool(changed, log, targets);
  return fitted ? fitted->rms_m : std::numeric_limits<double>::infinity();
}

void fit_ratio(const Arm& arm, std::span<const Observation> log, std::span<const Target> targets,
               ReadingSuspicion& best) {
  constexpr double kGolden = 0.618033988749895;
  double low = best.coupling.ratio - kRatioRange;
  double high = best.coupling.ratio + kRatioRange;
  struct Trial {
    double ratio = 0;
    double rms_m = 0;
  };
  const auto trial = [&](double ratio) -> Trial {
    return {ratio, rms_with(arm, {best.coupling.joint, best.coupling.from, ratio}, log, targets)};
  };
  Trial left = trial(high - kGolden * (high - low));
  Trial right = trial(low + kGolden * (high - low));
  for (int step = 0; step < kRatioSteps; ++step) {
    if (left.rms_m < right.rms_m) {
      high = right.ratio;
      right = left;
      left = trial(high - kGolden * (high - low));
    } else {
      low = left.ratio;
      left = right;
      right = trial(low + kGolden * (high - low));
    }
  }
  const Trial found = trial(0.5 * (low + high));
  // Zeros and lengths that are not the drawing's shift the best ratio a little.
  if (found.rms_m > kOtherRatio * best.rms_m) return;
  best.coupling.ratio = found.ratio;
  best.rms_m = found.rms_m;
}

}  // namespace

std::optional<ReadingSuspicion> suspect_readings(const Arm& arm, std::span<const Observation> log,
                                                 std::span<const Target> targets) {
  const auto plain = fit_base_and_tool(arm, log, targets);
  if (!plain) return std::nullopt;
  ReadingSuspicion best;
  best.plain_rms_m = plain->rms_m;
  best.rms_m = plain->rms_m;
  const auto offer = [&](const JointCoupling& coupling) {
    const double rms_m = rms_with(arm, coupling, log, targets);
    if (rms_m >= best.rms_m) return;
    best.coupling = coupling;
    best.rms_m = rms_m;
  };
  std::array<bool, kMaxJoints> moved{};
  for (std::size_t joint = 0; joint < arm.joints.size(); ++joint) {
    moved[joint] = !stood_still(
        log, [](const Observation& row) { return row.readings; }, joint, arm.joints[joint].type);
    if (!moved[joint]) continue;
    offer({joint, joint, kReversed});
    for (std::size_t from = 0; from < joint; ++from) {
      if (!moved[from] || arm.joints[from].type != arm.joints[joint].type) continue;
      for (const double ratio : {1.0, -1.0, 0.0}) offer({joint, from, ratio});
    }
  }
  if (best.rms_m > kConvincing * best.plain_rms_m) return std::nullopt;
  if (!best.reversed() && best.coupling.ratio != 0) fit_ratio(arm, log, targets, best);
  return best;
}

}  // namespace armsig::calibration
