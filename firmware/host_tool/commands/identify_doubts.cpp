// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/identify_doubts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/refinement/chain.hpp"
#include "firmware/host_tool/signature/doubt_stated.hpp"

namespace armsig::tool {
namespace {

// Fewer rows than these say nothing against an arm.
constexpr std::size_t kFewestToDoubt = 12;

}  // namespace

std::optional<Doubt> doubt_of(const Evidence& evidence, const ArmLimits& limits,
                              const SignatureRecord& record, double enlarged) {
  if (evidence.rows.size() < kFewestToDoubt) return std::nullopt;
  const refinement::PoeChain chain(record.signature, record.readings());
  const auto& targets = record.signature.targets;
  const auto predicted_S = [&](const EvidenceRow& row) -> std::optional<Vector3> {
    const auto* target = std::ranges::find(targets, row.target, &Target::number);
    if (target == targets.end()) return std::nullopt;
    return chain.point(chain.motion(row.q), *target);
  };
  return doubt(evidence, limits,
               FoundArm{.predicted_S = predicted_S,
                        .predicted_error_m = record.predicted_tool_error_m.value_or(0) / enlarged});
}

Problem explained(Problem problem, const Evidence& evidence, const ArmLimits& limits) {
  if (evidence.rows.size() < kFewestToDoubt) return problem;
  const auto found = doubt(evidence, limits, std::nullopt);
  if (!found || found->cause.empty()) return problem;
  problem.what += "; most likely " + found->cause;
  problem.expected += (problem.expected.empty() ? "" : "; ") + found->expected;
  return problem;
}

Problem problem_of(const Doubt& doubt, const std::string& file) {
  const std::string cause = doubt.cause.empty() ? "" : "; " + doubt.cause;
  return {file, 0, 0, doubt.what + cause, doubt.expected};
}

void warn_of(const Doubt& doubt, std::string words, SignatureRecord& record, Found& found) {
  record.warnings.push_back(std::move(words));
  const double stated_m = state_doubt(record, doubt);
  found.scale_stated = found.scale_stated || (doubt.lengths_factor != 1 && stated_m > 0);
  if (found.refinement && found.refinement->predicted_over_limits_m) {
    double& over_limits_m = *found.refinement->predicted_over_limits_m;
    over_limits_m = std::hypot(over_limits_m, stated_m);
  }
}

}  // namespace armsig::tool
