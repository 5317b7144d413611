// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/coupled_joints.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::tool {
namespace {

// Of a score test (a logarithm of likelihoods): 103 sound sets of a simulator that shares no code
// had 20 at most.
constexpr double kWorthNamingPair = 40;
constexpr double kSignificantRatio = 5;  // sigmas of the ratio
constexpr std::size_t kPairsTried = 3;   // pairs, fitted in turn
constexpr int kStepsToRatio = 3;         // to the ratio, each a fit
// Of the mean error of rows left out: where there are rows enough to tell all pairs apart, where
// there are fewer, and where it says more than which rows are rejected.
constexpr double kWorthCoupling = 0.95;
constexpr double kWorthOfFew = 0.5;
constexpr double kFarBetter = 0.67;

// The arm with a coupling changed by that; none where it has no room for one more.
std::optional<Arm> coupled(const Arm& arm, const JointCoupling& change) {
  Arm changed = arm;
  for (JointCoupling& known : changed.couplings) {
    if (known.joint != change.joint || known.from != change.from) continue;
    known.ratio += change.ratio;
    return changed;
  }
  if (changed.couplings.full()) return std::nullopt;
  changed.couplings.push_back(change);
  return changed;
}

struct FittedWith {
  Candidate candidate;
  double left_ratio = 0;  // by which another step would change the ratio
  double sigma = 0;
};

std::optional<FittedWith> fit_with(const CalibrationLog& log, const Candidate& found,
                                   const Arm& arm, const JointCoupling& coupling) {
  const CalibrationLog with{.nominal = arm,
                            .start = log.start,
                            .rows = log.rows,
                            .positions = log.positions,
                            .targets = log.targets,
                            .receivers = log.receivers,
                            .request = log.request,
                            .choose_readings = log.choose_readings,
                            .as_read = log.as_read};
  Candidates candidates(with);
  candidates.find_play(!found.half_plays.empty());
  FitStart start = found.start;
  start.model.couplings = arm.couplings;
  candidates.gather(start);
  auto fitted = candidates.fitted_as(start, found);
  if (!fitted) return std::nullopt;
  FittedWith result{.candidate = std::move(*fitted)};
  for (const SuspectedPair& pair : candidates.beside(result.candidate).pairs()) {
    if (pair.coupling.joint != coupling.joint || pair.coupling.from != coupling.from) continue;
    result.left_ratio = pair.coupling.ratio;
    result.sigma = pair.sigma;
  }
  return result;
}

struct Trial {
  FoundCoupling coupling;
  Candidate candidate;
};

std::optional<Trial> tried(const CalibrationLog& log, const Candidate& found,
                           const SuspectedPair& pair) {
  JointCoupling change = pair.coupling;
  std::optional<Trial> best;
  for (int step = 0; step < kStepsToRatio; ++step) {
    const auto arm = coupled(log.nominal, change);
    if (!arm) return best;
    auto fitted = fit_with(log, found, *arm, change);
    if (!fitted) return best;
    const bool better = !best ||
                        fitted->candidate.summary.rejected < best->candidate.summary.rejected ||
                        predicts_better(fitted->candidate, best->candidate, 1);
    const double left = fitted->left_ratio;
    if (better) {
      best = Trial{{.coupling = change, .sigma = fitted->sigma}, std::move(fitted->candidate)};
    }
    if (std::abs(left) < best->coupling.sigma) break;
    change.ratio += left;
  }
  return best;
}

void note(const std::optional<Trial>& trial, const Candidate& found, Candidates& candidates) {
  if (!trial || !trial->candidate.left_out) return;
  TriedModel model = candidates.tried()[found.tried];
  model.coupling = trial->coupling.coupling;
  model.left_out_mean_m = trial->candidate.left_out->score.mean_m;
  model.rejected = trial->candidate.summary.rejected;
  candidates.note(model);
}

bool explains_more(const Candidate& with, const Candidate& without, bool few) {
  if (few) return predicts_better(with, without, kWorthOfFew);
  // A better model has a narrower gate, which keeps fewer rows.
  if (predicts_better(with, without, kFarBetter)) return true;
  if (taken_back(with, without) < taken_back(without, with)) return false;
  return taken_back(with, without) >= kFewestTakenBack ||
         predicts_better(with, without, kWorthCoupling);
}

}  // namespace

std::optional<FoundCoupling> find_coupling(const CalibrationLog& log, Candidates& candidates,
                                           const Candidate& found) {
  if (!found.left_out) return std::nullopt;
  const Beside beside = candidates.beside(found);
  const std::vector<SuspectedPair> pairs = beside.pairs();
  const bool few = !beside.tells_pairs_apart();
  std::optional<Trial> best;
  for (std::size_t k = 0; k < std::min(kPairsTried, pairs.size()); ++k) {
    const SuspectedPair& pair = pairs[k];
    if (pair.nats < kWorthNamingPair ||
        std::abs(pair.coupling.ratio) < kSignificantRatio * pair.sigma) {
      continue;
    }
    auto trial = tried(log, found, pair);
    note(trial, found, candidates);
    if (!trial || !trial->candidate.left_out || !explains_more(trial->candidate, found, few)) {
      continue;
    }
    if (!best || predicts_better(trial->candidate, best->candidate, 1)) best = std::move(trial);
  }
  if (!best) return std::nullopt;
  FoundCoupling coupling = best->coupling;
  for (const JointCoupling& known : log.nominal.couplings) {
    if (known.joint != coupling.coupling.joint || known.from != coupling.coupling.from) continue;
    coupling.drawn_ratio = known.ratio;
    coupling.coupling.ratio += known.ratio;
  }
  coupling.rejected = best->candidate.summary.rejected;
  coupling.rejected_without = found.summary.rejected;
  coupling.left_out_mean_m = best->candidate.left_out->score.mean_m;
  coupling.left_out_mean_without_m = found.left_out->score.mean_m;
  return coupling;
}

}  // namespace armsig::tool
