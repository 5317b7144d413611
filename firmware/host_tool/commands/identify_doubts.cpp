// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/identify_doubts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/calibration/chain.hpp"
#include "firmware/host_tool/diagnosis/rejected_rows.hpp"
#include "firmware/host_tool/refinement/refinement_words.hpp"
#include "firmware/host_tool/signature/doubt_stated.hpp"

namespace armsig::tool {
namespace {

// Fewer rows than these say nothing against an arm.
constexpr std::size_t kFewestToDoubt = 12;

// A coupling that explains more than this of the error of rows left out makes what is stated wrong.
constexpr double kExplainsTooMuch = 1.5;

Doubt doubt_of_coupling(const FoundCoupling& found) {
  return {.what = in_words(found),
          .cause = evidence_in_words(found),
          .expected = remedy_for(found),
          .refuses = found.rejected < found.rejected_without ||
                     found.left_out_mean_without_m > kExplainsTooMuch * found.left_out_mean_m};
}

// What the rows say against the refinement's model beside what they say against the arm.
std::optional<Doubt> doubt_of_model(const Evidence& evidence, const RefinementOutcome& outcome) {
  auto rejected = doubt_of_rejected(evidence, outcome.outlying_lines);
  if (!outcome.coupling) return rejected;
  Doubt coupling = doubt_of_coupling(*outcome.coupling);
  if (!rejected) return coupling;
  rejected->cause = coupling.what + ": " + coupling.cause;
  rejected->expected = coupling.expected;
  return rejected;
}

}  // namespace

std::optional<Doubt> doubt_of(const Evidence& evidence, const ArmLimits& limits,
                              const SignatureRecord& record, double enlarged,
                              const RefinementOutcome* outcome) {
  if (evidence.rows.size() < kFewestToDoubt) return std::nullopt;
  const calibration::PoeChain chain(record.signature, record.readings());
  const auto& targets = record.signature.targets;
  const auto predicted_S = [&](const EvidenceRow& row) -> std::optional<Vector3> {
    const auto* target = std::ranges::find(targets, row.target, &Target::number);
    if (target == targets.end()) return std::nullopt;
    return chain.point(chain.motion(row.q), *target);
  };
  const double predicted_m = record.accuracy.predicted ? record.accuracy.predicted->rms_m : 0;
  auto of_model = outcome == nullptr ? std::nullopt : doubt_of_model(evidence, *outcome);
  const bool rejects_many =
      outcome != nullptr && doubt_of_rejected(evidence, outcome->outlying_lines).has_value();
  auto of_arm = doubt(evidence, limits,
                      FoundArm{.predicted_S = predicted_S,
                               .predicted_error_m = predicted_m / enlarged,
                               .rejects_many = rejects_many});
  if (!of_model || (of_arm && of_arm->refuses)) return of_arm;
  if (of_arm && of_model->refuses && of_model->cause.empty()) {
    of_model->cause = of_arm->what + ": " + of_arm->cause;
    of_model->expected = of_arm->expected;
  }
  return of_model;
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
