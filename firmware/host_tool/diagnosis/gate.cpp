// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/gate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/core.h>

#include "firmware/host_tool/diagnosis/changes.hpp"
#include "firmware/host_tool/diagnosis/common_scale.hpp"
#include "firmware/host_tool/diagnosis/deviation_words.hpp"
#include "firmware/host_tool/diagnosis/explanation.hpp"
#include "firmware/host_tool/diagnosis/row_groups.hpp"
#include "firmware/host_tool/diagnosis/unchanging_arm.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kRowsToJudge = 400;
// Stated noise beyond so many times what the rows show at most is a wrong column.
constexpr double kSigmaTooLarge = 6;
constexpr std::size_t kFewestForSigma = 30;
// A method may miss the rows by so much more than the nearest arm does, and than it says itself.
constexpr double kMethodFactor = 3;
// What gravity bends a sound arm by, which features know nothing of: as a share of its reach
// always, and where the rows show it, up to a larger share. Elsewhere so many times as much.
constexpr double kBent = 1e-3;
constexpr double kBentAtMost = 5e-3;
constexpr double kBentElsewhere = 1.5;
// A sweep may miss by so much more than all rows together.
constexpr double kOfGroup = 2;

// What the found arm misses each row by, negative where it does not say.
std::vector<double> misses_m(const Evidence& evidence, const FoundArm& found) {
  std::vector<double> lengths_m;
  for (const EvidenceRow& row : evidence.rows) {
    const auto p_S = found.predicted_S(row);
    lengths_m.push_back(p_S ? (row.p_S - *p_S).norm() : -1);
  }
  return lengths_m;
}

// What the found arm misses less than the nearest to the drawing does is no mistake: gravity and
// maps explain it.
void judge_by(const FoundArm& found, const Evidence& evidence, Reference& reference) {
  std::vector<double> lengths_m = misses_m(evidence, found);
  std::erase_if(lengths_m, [](double length_m) { return length_m < 0; });
  if (lengths_m.size() < evidence.rows.size()) return;
  NearFit& fit = reference.fit;
  fit.clipped_m = std::min(fit.clipped_m, clipped_rms(lengths_m, fit.reach_m));
  fit.best_rms_m = std::min(fit.best_rms_m, trimmed_rms(std::move(lengths_m)));
}

// Nor is what an arm does that stays as it is: gravity, gears and backlash are no mistakes.
void judge_by_unchanging(const Evidence& evidence, Reference& reference) {
  const UnchangingArm arm(evidence, reference.chain, reference.fit.residuals_S);
  std::vector<double> lengths_m;
  for (const Vector3& left_S : arm.left_S()) lengths_m.push_back(left_S.norm());
  NearFit& fit = reference.fit;
  fit.clipped_m = std::min(fit.clipped_m, clipped_rms(lengths_m, fit.reach_m));
  fit.best_rms_m = std::min(fit.best_rms_m, trimmed_rms(std::move(lengths_m)));
}

// A group of rows that the nearest arm does not explain, while it explains the others.
std::string objection_to_group(const Evidence& evidence, const NearFit& fit, double allowed_m) {
  std::vector<double> lengths_m;
  for (const Vector3& residual_S : fit.residuals_S) lengths_m.push_back(residual_S.norm());
  const GroupMiss worst = worst_group(evidence, lengths_m);
  if (worst.length_m <= kOfGroup * allowed_m) return {};
  return fmt::format("{} and the other rows are not of one arm: there the nearest misses by {}",
                     worst.name, short_length(worst.length_m));
}

bool states_too_much(const Reference& reference, const Evidence& evidence) {
  const double scatter_m = std::max(reference.sweeps_m, reference.shown_m);
  return !evidence.located && evidence.rows.size() >= kFewestForSigma && scatter_m > kComputed_m &&
         reference.stated_m > kSigmaTooLarge * scatter_m;
}

UnchangingArm unchanging(const Evidence& evidence, const Reference& reference) {
  return {evidence, reference.chain, reference.fit.residuals_S};
}

// What features may miss a row by because gravity bends the arm, or because its joints came from
// the other side of their backlash.
double bent_m(const Evidence& evidence, const Reference& reference) {
  const std::vector<Vector3> bent_S = unchanging(evidence, reference).bent_S();
  double most_m = 0;
  for (const Vector3& one_S : bent_S) {
    most_m = std::max(most_m, kBentElsewhere * one_S.norm());
    for (const Vector3& other_S : bent_S) most_m = std::max(most_m, (one_S - other_S).norm());
  }
  return std::min(most_m, kBentAtMost * reference.fit.reach_m);
}

// What is wrong with the nearest arm, or with the method's against it; empty where nothing is.
std::string objection(const Evidence& evidence, const Reference& reference, const ArmLimits& limits,
                      const std::optional<FoundArm>& found) {
  const NearFit& fit = reference.fit;
  const double allowed_m = acceptable_m(fit, reference.stated_m);
  if (fit.best_rms_m > allowed_m) {
    return fmt::format(
        "no arm like its nominal model explains the measurements: the nearest misses by {} (the "
        "best "
        "seven "
        "tenths of the rows)",
        short_length(fit.best_rms_m));
  }
  if (fit.farthest(limits, evidence.arm) > 1) {
    return "this is not the arm of the nominal model: " +
           deviation_in_words(fit, limits, evidence.arm);
  }
  if (states_too_much(reference, evidence)) {
    return fmt::format("sigma_mm states {}, and the rows scatter by {}",
                       short_length(reference.stated_m), short_length(reference.shown_m));
  }
  if (auto group = objection_to_group(evidence, fit, allowed_m); !group.empty()) return group;
  if (found) {
    const GroupMiss worst = worst_group(evidence, misses_m(evidence, *found));
    const double noise_m = std::numbers::sqrt3 * std::max(reference.stated_m, reference.sweeps_m);
    const double expected_m =
        std::max(fit.best_rms_m, std::hypot(noise_m, found->predicted_error_m));
    if (worst.length_m > std::max(kBent * fit.reach_m, kMethodFactor * expected_m) &&
        worst.length_m > bent_m(evidence, reference)) {
      return fmt::format(
          "the arm found misses {} by {}, where one near the nominal model misses by {}",
          worst.name, short_length(worst.length_m), short_length(fit.best_rms_m));
    }
  }
  return {};
}

// Deviations that are one factor on all lengths: the sensor's scale, or the drawing's. Said where
// the evidence (a logarithm of likelihoods) is fair; refused where it is strong, and the factor
// larger than any good sensor's. Of 144 sound arms, half of them made to twice the usual
// tolerances, the strongest was 2.8; of 500 it was above 6 once.
constexpr double kFairEvidence = 4;
constexpr double kStrongEvidence = 9;
constexpr double kLeastFactor = 2.5e-3;
constexpr double kLeastSaid = 1e-3;

constexpr const char* kMendOfLeads =
    "look at the leads of the prismatic joints, and at the scale of the sensor";

std::optional<CommonScale> fair_scale(const Evidence& evidence, const NearFit& fit,
                                      const ArmLimits& limits) {
  auto scale = common_scale(evidence, fit, limits);
  if (!scale || scale->evidence < kFairEvidence) return std::nullopt;
  if (std::abs(scale->factor - 1) < kLeastSaid) return std::nullopt;
  return scale;
}

Evidence without(Evidence evidence, const std::vector<Vector3>& moved_S) {
  for (std::size_t k = 0; k < moved_S.size(); ++k) evidence.rows[k].p_S -= moved_S[k];
  return evidence;
}

std::optional<CommonScale> scale_of(const Evidence& evidence, const ArmLimits& limits) {
  const auto fit = fit_near(evidence, limits);
  return fit ? fair_scale(evidence, *fit, limits) : std::nullopt;
}

// What the leads of prismatic joints explain as well is not asserted of all lengths.
std::string scale_in_words(double factor, bool leads_as_well) {
  if (!leads_as_well) {
    return fmt::format("all lengths seen are {:.4f} times those of the nominal model", factor);
  }
  return fmt::format(
      "prismatic joints move {:.4f} times as far as they read, or all lengths seen are {:.4f} "
      "times those of the nominal model",
      factor, factor);
}

// Gravity and backlash shift axes as well: the factor must be there without them.
std::optional<Doubt> doubt_of_scale(const Evidence& evidence, const Reference& reference,
                                    const ArmLimits& limits) {
  if (!fair_scale(evidence, reference.fit, limits)) return std::nullopt;
  const UnchangingArm arm = unchanging(evidence, reference);
  const Evidence weightless = without(evidence, arm.bent_S());
  const auto scale = scale_of(weightless, limits);
  if (!scale) return std::nullopt;
  const double off = std::abs(scale->factor - 1);
  const bool leads_as_well = !scale_of(without(weightless, arm.by_leads_S()), limits);
  return Doubt{.what = scale_in_words(scale->factor, leads_as_well),
               .cause = fmt::format(
                   "divided by it the axes are within {} of the nominal model's, instead of {}",
                   short_length(scale->after_m), short_length(scale->before_m)),
               .expected = leads_as_well ? kMendOfLeads : kMendOfScale,
               .refuses = scale->evidence > kStrongEvidence && off > kLeastFactor,
               .probability = 1 / (1 + std::exp(kFairEvidence - scale->evidence)),
               .lengths_factor = scale->factor};
}

// What changed while it was measured: said where it has evidence and explains something, refused
// where it explains so much that what is stated may not hold. Of sweeps the joints' own errors come
// and go with the rows as well, and a change is easily taken for the arm: of 60 sound sets that are
// not as the model says the largest was 1.32; of 72 sets of poses 1.05, of the UR5 and UR10 1.07.
constexpr double kEvidenceOfChange = 12;
struct Explaining {
  double something = 0;
  double too_much = 0;
};
constexpr Explaining kOfPoses{1.25, 2.5};
constexpr Explaining kOfSweeps{1.4, 1.6};
constexpr double kMissesNothing = 1e-4;  // of the reach

std::optional<Change> change_of(const Evidence& evidence, const Reference& reference,
                                const std::optional<FoundArm>& found, Backlash backlash) {
  auto likeliest = likeliest_change(evidence, reference.chain, reference.fit.residuals_S, backlash);
  if (!found) return likeliest;
  std::vector<Vector3> residuals_S = reference.fit.residuals_S;
  for (std::size_t k = 0; k < residuals_S.size(); ++k) {
    const EvidenceRow& row = evidence.rows[k];
    if (const auto p_S = found->predicted_S(row)) residuals_S[k] = row.p_S - *p_S;
  }
  auto of_found = likeliest_change(evidence, reference.chain, residuals_S, backlash);
  // What the arm that was found does not miss has not changed. Of sweeps alone maps may have taken
  // a change, and of any rows part of a strain; and backlash part of a lag.
  const bool all_along =
      likeliest && (likeliest->of == Change::Of::kStrain || likeliest->of == Change::Of::kLag);
  const bool swept =
      std::ranges::none_of(evidence.rows, [](const EvidenceRow& row) { return row.sweep == 0; });
  if (!swept && !all_along && rms_length(residuals_S) < rms_length(reference.fit.residuals_S)) {
    return of_found;
  }
  if (!likeliest || (of_found && of_found->explains() > likeliest->explains())) return of_found;
  return likeliest;
}

std::optional<Doubt> doubt_of_change(const Evidence& evidence, const Reference& reference,
                                     const std::optional<FoundArm>& found) {
  const auto change = change_of(evidence, reference, found, Backlash::kNone);
  if (!change || change->evidence < kEvidenceOfChange) return std::nullopt;
  // Backlash is a step between two sweeps: what it explains wholly has no other cause, and what it
  // explains for the most part may have either.
  const auto beside = change_of(evidence, reference, found, Backlash::kPossible);
  if (!beside || beside->evidence < kEvidenceOfChange) return std::nullopt;
  const bool swept =
      std::ranges::any_of(evidence.rows, [](const EvidenceRow& row) { return row.sweep != 0; });
  const Explaining& explaining = swept ? kOfSweeps : kOfPoses;
  // Rows that are rejected weigh little, and their misfit must have a cause.
  const bool of_rejected = found && found->rejects_many;
  if (!of_rejected && change->explains() < explaining.something) return std::nullopt;
  const bool or_backlash =
      change->explains() >= explaining.something && beside->explains() < explaining.something;
  return Doubt{
      .what = (or_backlash ? "joints have backlash, or " : "") + in_words(*change, evidence.arm),
      .cause = fmt::format("with that corrected the rows fit within {}, instead of {}",
                           short_length(change->after_m), short_length(change->before_m)),
      .expected = mend_of(*change) +
                  (or_backlash ? "; free poses beside the sweeps tell backlash from it" : ""),
      .refuses = !or_backlash && change->explains() > explaining.too_much &&
                 change->before_m > kMissesNothing * reference.fit.reach_m,
      .probability = 1,
      .tool_off_m = moved_by_change(*change, evidence, reference.chain)};
}

// Of measurements that no method takes: what is wrong with them is known to the caller.
std::optional<Doubt> as_cause(std::optional<Doubt> doubt) {
  if (doubt) doubt->cause = doubt->what + ": " + doubt->cause;
  return doubt;
}

// Where no mistake explains what is wrong.
void say_what_is_expected(Doubt& result, bool states_too_much, bool found,
                          const std::optional<Doubt>& change) {
  if (states_too_much) {
    if (!found) result.cause = result.what;
    result.expected = "1 sigma of a position per axis, in the unit of the column's name";
  } else if (change && change->refuses) {
    result.cause = as_cause(change)->cause;
    result.expected = change->expected;
  } else {
    result.expected =
        "the arm of the description, in one place, with rigid targets; or --accept-different-arm";
  }
}

}  // namespace

std::optional<Doubt> doubt(const Evidence& all, const ArmLimits& limits,
                           const std::optional<FoundArm>& found) {
  const Evidence evidence = thinned(all, kRowsToJudge);
  auto reference = reference_of(evidence, limits);
  if (!reference) return std::nullopt;
  Doubt result;
  result.what = objection(evidence, *reference, limits, found);
  const bool refused = !result.what.empty() || !found;
  std::optional<Doubt> scale;
  if (!refused) {
    scale = doubt_of_scale(evidence, *reference, limits);
    if (scale && scale->refuses) return scale;
  }
  const auto change = doubt_of_change(evidence, *reference, found);
  const auto& said = change ? change : scale;
  if (!refused) judge_by(*found, evidence, *reference);
  if (!refused && is_suspicious(*reference)) judge_by_unchanging(evidence, *reference);
  if (!refused && !is_suspicious(*reference)) return said;
  if (const auto explanation = explain(evidence, *reference, limits, refused)) {
    if (result.what.empty() && !found && explanation->harmless) return std::nullopt;
    if (result.what.empty()) {
      result.what =
          fmt::format("the measurements contradict each other: the nearest arm misses by {}",
                      short_length(reference->fit.clipped_m));
    }
    result.cause = explanation->words;
    result.expected = explanation->mend;
    return result;
  }
  if (result.what.empty()) return found ? said : as_cause(said);
  say_what_is_expected(result, states_too_much(*reference, evidence), found.has_value(), change);
  return result;
}

}  // namespace armsig::tool
