// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/another_arm.hpp"

#include <algorithm>
#include <limits>

#include <fmt/core.h>

#include "core/base/low_discrepancy.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/host_tool/diagnosis/deviation_words.hpp"

namespace armsig::tool {
namespace {

constexpr int kPoses = 150;
// Of the reach: what the nearest arm may miss by. Gravity and maps, of which it knows nothing, stay
// far below.
constexpr double kExplained = 5e-3;
constexpr double kAsFar = 1.5;

// Where the arm of `record` puts a tool at readings all over the limits of `drawing`.
Evidence evidence_of(const SignatureRecord& record, const Arm& drawing) {
  // Off the last axis, so that its zero and its tilt are seen too.
  const Vector3 tool(0.12, 0.05, 0.1);
  const Signature& signature = record.signature;
  const calibration::ReadingModel readings = record.readings();
  Evidence evidence{.arm = drawing, .rows = {}};
  for (int n = 1; n <= kPoses; ++n) {
    EvidenceRow row;
    row.line = static_cast<std::size_t>(n);
    row.target = 1;
    row.q = work_configuration(signature.types, drawing.limits, n);
    const JointVector turned = calibration::true_readings(readings, signature.configuration, row.q);
    row.p_S = kinematics::link_pose(signature, turned, signature.joint_count()) * tool;
    evidence.rows.push_back(row);
  }
  return evidence;
}

}  // namespace

Farness farness_of(const SignatureRecord& record, const Arm& drawing, const ArmLimits& limits) {
  const auto fit = fit_near(evidence_of(record, drawing), limits);
  constexpr double kBeyondAll = std::numeric_limits<double>::infinity();
  if (!fit) return {kBeyondAll, "nothing of it can be compared"};
  if (fit->best_rms_m > kExplained * fit->reach_m) {
    return {kBeyondAll, fmt::format("the nearest arm like the nominal model misses it by {:.0f} mm",
                                    1e3 * fit->best_rms_m)};
  }
  return {fit->farthest(limits, drawing), deviation_in_words(*fit, limits, drawing)};
}

bool is_of_another_arm(const Farness& truth, const Farness& found) {
  return truth.times_allowed > std::max(1.0, kAsFar * found.times_allowed);
}

}  // namespace armsig::tool
