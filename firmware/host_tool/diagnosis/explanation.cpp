// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/explanation.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "firmware/host_tool/diagnosis/broken_rows.hpp"
#include "firmware/host_tool/diagnosis/common_scale.hpp"
#include "firmware/host_tool/diagnosis/hypothesis.hpp"
#include "firmware/host_tool/diagnosis/moved.hpp"
#include "firmware/host_tool/diagnosis/unstated_coupling.hpp"

namespace armsig::tool {
namespace {

// What gravity, gears and heat leave of a sound arm at most, as a share of its reach.
constexpr double kModelShare = 0.005;
constexpr double kOfSigma = 4 * std::numbers::sqrt3;
// Residuals beyond so many times the noise ask for a cause.
constexpr double kSuspicious = 3;
constexpr double kSuspiciousClipped = 8;
// Residuals below this share of the reach are nobody's mistake.
constexpr double kNothing = 1e-4;
// A cause must explain so much of the residuals of a set that is sound as it is.
constexpr double kExplains = 3;
constexpr std::size_t kRowsToChoose = 120;
constexpr std::size_t kRowsToFit = 260;
constexpr std::size_t kFitted = 10;
constexpr double kAsNoise = 1.15;  // what no other cause can better
constexpr double kStrange = 0.25;
constexpr double kSurprise = 0.5;
constexpr double kAsBefore = 0.8;
// Two causes with one and the same fit, and nearly as usual: no row tells which it is.
constexpr double kSameFit = 1e-3;
constexpr double kNearlyAsUsual = 0.5;  // of the score
// A larger factor, or one that is smaller than one by it, is a unit.
constexpr double kLargestFactor = 2.5;
// Smaller ratios of couplings are no mistake of a description.
constexpr double kLeastRatio = 2e-3;
constexpr std::array<double, 3> kSizes{1, 0.75, 1.33};  // to look for a factor from
// Arms from here to there are built.
constexpr double kShortestReach_m = 0.15;
constexpr double kLongestReach_m = 6;

bool is_built(const NearFit& fit) {
  return fit.reach_m > kShortestReach_m && fit.reach_m < kLongestReach_m;
}

// How far most rows are from their middle: a few that lie far out make nothing larger.
double size_of(const Evidence& evidence) {
  Vector3 middle;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> along;
    for (const EvidenceRow& row : evidence.rows) along.push_back(row.p_S[axis]);
    middle[axis] = median_of(std::move(along));
  }
  std::vector<double> lengths;
  for (const EvidenceRow& row : evidence.rows) lengths.push_back((row.p_S - middle).norm());
  return median_of(std::move(lengths));
}

// Readings farther from the joint limits than these are from each other.
bool is_out_of_reach(const Evidence& evidence) {
  const auto& limits = evidence.arm.limits;
  return std::ranges::any_of(evidence.rows, [&](const EvidenceRow& row) {
    for (std::size_t j = 0; j < std::min(limits.size(), row.q.size()); ++j) {
      const double range = limits[j].upper - limits[j].lower;
      if (row.q[j] < limits[j].lower - range || row.q[j] > limits[j].upper + range) return true;
    }
    return false;
  });
}

bool is_sound(const NearFit& fit, const ArmLimits& limits, const Arm& arm, double stated_m) {
  return fit.best_rms_m <= acceptable_m(fit, stated_m) && fit.farthest(limits, arm) <= 1;
}

// The lower the better: residuals down to the noise, deviations, how unusual the mistake is.
double score_of(const NearFit& fit, double noise_length_m, const ArmLimits& limits,
                double surprise) {
  const double floor_m = std::max(noise_length_m, 1e-5 * fit.reach_m);
  return std::log(std::max({fit.best_rms_m, 0.3 * fit.clipped_m, floor_m}) / fit.reach_m) +
         kStrange * std::min(40.0, fit.strangeness(limits)) + kSurprise * surprise +
         (is_built(fit) ? 0 : 2);
}

struct Tried {
  NearFit fit;
  double score = std::numeric_limits<double>::infinity();
  Explanation explanation;
  std::optional<Explanation> as_well;  // another cause, with one and the same fit
};

std::string fits_within(const NearFit& fit, const NearFit& before) {
  if (fit.best_rms_m > kAsBefore * before.best_rms_m) {  // what it mends is elsewhere
    if (fit.clipped_m < kAsBefore * before.clipped_m) {
      return fmt::format("all rows fit within {}, instead of {}", short_length(fit.clipped_m),
                         short_length(before.clipped_m));
    }
    return "the arm is like its nominal model";
  }
  return fmt::format("they fit within {}, instead of {}", short_length(fit.best_rms_m),
                     short_length(before.best_rms_m));
}

class Search {
 public:
  Search(const Evidence& evidence, const Reference& reference, const ArmLimits& limits,
         bool refused)
      : evidence_(thinned(evidence, kRowsToFit)),
        reference_(reference),
        limits_(limits),
        refused_(refused),
        before_(fit_near(evidence_, limits).value_or(reference.fit)) {}

  void try_hypotheses() {
    std::vector<Hypothesis> all = hypotheses_of_rows(evidence_);
    for (const Hypothesis& hypothesis : hypotheses_of_frozen_rows(evidence_)) try_one(hypothesis);
    for (auto* more : {&hypotheses_of_readings, &hypotheses_of_arm}) {
      std::ranges::move((*more)(evidence_), std::back_inserter(all));
    }
    const Evidence few = thinned(evidence_, kRowsToChoose);
    std::vector<std::pair<double, const Hypothesis*>> order;
    for (const Hypothesis& hypothesis : all) {
      Evidence undone = few;
      hypothesis.undo(undone);
      order.emplace_back(std::log(drawn_misfit(undone)) + 0.2 * hypothesis.surprise, &hypothesis);
    }
    std::ranges::sort(order, {}, [](const auto& pair) { return pair.first; });
    for (std::size_t k = 0; k < std::min(kFitted, order.size()); ++k) try_one(*order[k].second);
  }

  // Factors near one, which no table of units holds.
  void try_factors() {
    for (const double start : kSizes) {
      const auto scale = common_scale(evidence_, before_, limits_, start);
      if (!scale || scale->factor > kLargestFactor || scale->factor * kLargestFactor < 1) continue;
      take(scale->undone, scale->fit, 0.9,
           {.words = fmt::format(
                "all lengths seen are {:.4f} times those of the nominal model: divided by "
                "it {}",
                scale->factor, fits_within(scale->fit, before_)),
            .mend = kMendOfScale});
    }
    std::uint32_t turning = 0;
    for (std::size_t j = 0; j < evidence_.arm.joints.size(); ++j) {
      if (evidence_.arm.joints[j].type != JointType::kRevolute || !has_moved(evidence_, j)) {
        continue;
      }
      turning |= 1U << j;
      try_gain(1U << j, fmt::format("the reading of joint {} is", j + 1), 1);
    }
    if (std::popcount(turning) > 1) try_gain(turning, "the joint readings are", 0.9);
  }

  void try_coupling() {
    const auto found = find_unstated_coupling(evidence_, limits_);
    if (!found || std::abs(found->ratio) < kLeastRatio) return;
    take(found->undone, found->fit, 1,
         {.words = fmt::format("joint {} follows joint {} by {:+.4f} of its reading, which the arm "
                               "description does not say: with it {}",
                               found->joint + 1, found->from + 1, found->ratio,
                               fits_within(found->fit, before_)),
          .mend = "state it in the arm description: " +
                  coupling_line(found->joint, found->from, found->ratio)});
  }

  void try_broken_rows() {
    const auto found = find_broken_rows(evidence_, limits_);
    if (!found) return;
    const auto fit = fit_near(found->undone, limits_);
    if (!fit) return;
    take(found->undone, *fit, found->surprise,
         {.words = fmt::format("in lines {} to {} {}: {} {}", found->first_line, found->last_line,
                               found->cause, found->undoing, fits_within(*fit, before_)),
          .mend = found->mend});
  }

  void try_moves() {
    if (const auto moved = find_moved_sensor(evidence_, limits_)) {
      const Vector3& along = moved->along_S;
      take(moved->evidence, moved->fit, 0.6,
           {.words = fmt::format(
                "rows {} to {} were measured from another place: {} along ({:+.2f}, {:+.2f}, "
                "{:+.2f}), {:.2f}°; with that corrected {}",
                moved->first_line, moved->last_line, short_length(moved->shift_m), along.x(),
                along.y(), along.z(), degrees(moved->turn_rad), fits_within(moved->fit, before_)),
            .mend = "measure again with the sensor left where it is, or give each place a file of "
                    "its own"});
    }
    if (const auto changed = find_changed_tool(evidence_, limits_)) {
      take(changed->evidence, changed->fit, 0.8,
           {.words = fmt::format("from about line {} on the target is another point; as another "
                                 "target {}",
                                 changed->first_line, fits_within(changed->fit, before_)),
            .mend = "another number in column target for those rows"});
    }
  }

  [[nodiscard]] std::optional<Explanation> best() const {
    if (!std::isfinite(best_.score)) return std::nullopt;
    Explanation best = best_.explanation;
    if (best_.as_well) {
      best.words += "; or " + best_.as_well->words;
      best.mend += "; or " + best_.as_well->mend;
    }
    return best;
  }
  // As good as noise allows: nothing better is to be found.
  [[nodiscard]] bool is_convincing() const {
    const double noise_m = reference_.noise_length_m();
    return std::isfinite(best_.score) &&
           best_.fit.best_rms_m < (noise_m > 0 ? kAsNoise * noise_m : 1e-3 * best_.fit.reach_m);
  }

 private:
  void try_one(const Hypothesis& hypothesis) {
    Evidence undone = evidence_;
    hypothesis.undo(undone);
    const auto fit = fit_near(undone, limits_);
    if (!fit) return;
    take(undone, *fit, hypothesis.surprise,
         {.words = fmt::format("{}: {} {}", hypothesis.cause, hypothesis.undoing,
                               fits_within(*fit, before_)),
          .mend = hypothesis.mend,
          .harmless = hypothesis.harmless});
  }

  void try_gain(std::uint32_t joints, const std::string& whose, double surprise) {
    Evidence geared = evidence_;
    geared.free_gain = joints;
    const auto fit = fit_near(geared, limits_);
    if (!fit) return;
    take(geared, *fit, surprise,
         {.words = fmt::format("{} {:.4f} times what the joint turns: divided by it {}", whose,
                               fit->gain, fits_within(*fit, before_)),
          .mend = "look at the gear ratio, or at the counts of a turn"});
  }

  void take(const Evidence& undone, const NearFit& fit, double surprise, Explanation explanation) {
    if (!is_sound(fit, limits_, undone.arm, reference_.stated_m)) return;
    NearFit before = before_;
    // A mistake must explain what the arm that was found misses, not what a stiff one does.
    before.best_rms_m = std::min(before.best_rms_m, reference_.fit.best_rms_m);
    before.clipped_m = std::min(before.clipped_m, reference_.fit.clipped_m);
    if (is_built(before) && !is_built(fit)) return;
    if (is_out_of_reach(undone) && !is_out_of_reach(evidence_)) return;
    const double size_m = size_of(undone);
    const double size_before_m = size_of(evidence_);
    const double share = fit.best_rms_m / size_m;
    const double share_before = before.best_rms_m / size_before_m;
    const double clipped = fit.clipped_m / size_m;
    const double clipped_before = before.clipped_m / size_before_m;
    const bool explains = share * kExplains < share_before ||
                          (clipped * kExplains < clipped_before && share < 1.05 * share_before);
    // A large arm's axes may be farther from the drawing's: that alone makes it no likelier.
    NearFit as_small = fit;
    as_small.reach_m = std::min(fit.reach_m, before.reach_m);
    const bool nearer = refused_ && before.farthest(limits_, evidence_.arm) > 1 &&
                        as_small.farthest(limits_, undone.arm) <= 1 && share < 1.2 * share_before;
    if (!explains && !nearer) return;
    const double score = score_of(fit, reference_.noise_length_m(), limits_, surprise);
    Tried tried{fit, score, std::move(explanation), {}};
    if (!undone.free_scale && undone.free_gain == 0 && is_same_as_best(tried)) {
      Tried& likelier = tried.score < best_.score ? tried : best_;
      likelier.as_well = tried.score < best_.score ? best_.explanation : tried.explanation;
    }
    if (tried.score < best_.score) best_ = std::move(tried);
  }

  [[nodiscard]] bool is_same_as_best(const Tried& tried) const {
    return std::isfinite(best_.score) && std::abs(tried.score - best_.score) < kNearlyAsUsual &&
           std::abs(tried.fit.best_rms_m - best_.fit.best_rms_m) < kSameFit * best_.fit.best_rms_m;
  }

  Evidence evidence_;
  const Reference& reference_;
  const ArmLimits& limits_;
  bool refused_;
  NearFit before_;  // of the same rows as they are
  Tried best_;
};

}  // namespace

std::string short_length(double metres) {
  if (metres >= 1) return fmt::format("{:.3g} m", metres);
  return fmt::format("{:.3g} mm", 1e3 * metres);
}

double Reference::noise_length_m() const {
  if (stated_m <= 0) return std::numbers::sqrt3 * sweeps_m;
  // Sweeps show more where the arm errs; they show far more where the mistake is in them.
  return std::numbers::sqrt3 * std::max(stated_m, std::min(sweeps_m, 5 * stated_m));
}

std::optional<Reference> reference_of(const Evidence& evidence, const ArmLimits& limits) {
  auto nearest = nearest_arm(evidence, limits);
  if (!nearest) return std::nullopt;
  const double numbers = 3.0 * static_cast<double>(evidence.rows.size());
  const double unknowns = 3.0 * static_cast<double>(seen_targets(evidence).size()) +
                          5.0 * static_cast<double>(evidence.arm.joints.size());
  const double freedom = std::max(0.1, 1 - unknowns / numbers);
  Reference reference{.fit = std::move(nearest->fit),
                      .chain = std::move(nearest->chain),
                      .stated_m = stated_sigma_m(evidence),
                      .sweeps_m = noise_of_sweeps_m(evidence)};
  reference.shown_m = reference.fit.sigma_m / std::sqrt(freedom);
  return reference;
}

double acceptable_m(const NearFit& fit, double stated_m) {
  return kModelShare * fit.reach_m + kOfSigma * stated_m;
}

bool is_suspicious(const Reference& reference) {
  const double noise_m = reference.noise_length_m();
  const double least_m = kNothing * reference.fit.reach_m;
  if (noise_m <= 0) return reference.fit.best_rms_m > least_m;
  return reference.fit.best_rms_m > kSuspicious * noise_m + least_m ||
         reference.fit.clipped_m > kSuspiciousClipped * noise_m + least_m;
}

std::optional<Explanation> explain(const Evidence& evidence, const Reference& reference,
                                   const ArmLimits& limits, bool refused) {
  Search search(evidence, reference, limits, refused);
  search.try_hypotheses();
  if (refused && !search.is_convincing()) search.try_factors();
  if (!search.is_convincing()) search.try_coupling();
  if (refused && !search.is_convincing()) search.try_broken_rows();
  if (!search.is_convincing()) search.try_moves();
  auto best = search.best();
  if (!best && refused) {
    const std::string odd = odd_columns(evidence);
    if (!odd.empty()) best = Explanation{.words = odd, .mend = "the columns as they were measured"};
  }
  return best;
}

}  // namespace armsig::tool
