// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/broken_rows.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "firmware/host_tool/diagnosis/hypothesis.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kFewestToSplit = 36;
constexpr std::size_t kEnds = 3;            // of as many parts the first, or the last, is fitted
constexpr std::size_t kFewestOfBroken = 6;  // rows
// Of the reach: what an arm near its drawing misses rows elsewhere by, and one with another zero.
constexpr double kSoundShare = 0.01;
// Of the rows on either side of the break, those that are on the wrong one.
constexpr double kStray = 0.2;
// A cause makes the rows miss by so much less.
constexpr double kCures = 5;
constexpr int kGrid_deg = 3;
constexpr std::size_t kRowsOfGrid = 30;
constexpr int kThirdings = 40;

double missed_m(const DeviatingChain& chain, const Evidence& rows) {
  std::vector<double> lengths_m;
  for (const Vector3& residual_S : chain.residuals(rows)) lengths_m.push_back(residual_S.norm());
  return lengths_m.empty() ? std::numeric_limits<double>::infinity()
                           : trimmed_rms(std::move(lengths_m));
}

Evidence part_of(const Evidence& evidence, std::size_t first, std::size_t last) {
  Evidence part = evidence;
  const auto begin = evidence.rows.begin();
  part.rows.assign(begin + static_cast<std::ptrdiff_t>(first),
                   begin + static_cast<std::ptrdiff_t>(last));
  return part;
}

bool sees_all_targets(const Evidence& part, const Evidence& evidence) {
  const auto seen = seen_targets(part);
  return std::ranges::equal(seen, seen_targets(evidence), {}, &SeenTarget::number,
                            &SeenTarget::number);
}

// The sound arm of one end, and the rows that do not agree with it.
struct Split {
  DeviatingChain chain;
  double reach_m = 0;
  std::size_t first = 0;  // of the broken rows
  std::size_t last = 0;   // behind them
};

std::optional<Split> split_by(const Evidence& evidence, const ArmLimits& limits, bool from_start) {
  const std::size_t n = evidence.rows.size();
  const std::size_t of_end = n / kEnds;
  const Evidence end = from_start ? part_of(evidence, 0, of_end) : part_of(evidence, n - of_end, n);
  if (!sees_all_targets(end, evidence)) return std::nullopt;
  auto nearest = nearest_arm(end, limits);
  if (!nearest) return std::nullopt;
  const double sound_m = kSoundShare * nearest->fit.reach_m;
  if (nearest->fit.best_rms_m > sound_m || nearest->fit.farthest(limits, evidence.arm) > 1) {
    return std::nullopt;
  }
  const std::vector<Vector3> residuals_S = nearest->chain.residuals(evidence);
  // By how many more rows are on their side, if those behind the first `k` (or before) are broken.
  double broken = 0;
  for (const Vector3& residual_S : residuals_S) broken += residual_S.norm() > sound_m;
  double best = -1;
  std::size_t at = 0;
  double before = 0;  // broken rows before k
  for (std::size_t k = 0; k <= n; ++k) {
    const double strays = from_start ? before + (static_cast<double>(n - k) - (broken - before))
                                     : static_cast<double>(k) - before + (broken - before);
    if (best < 0 || strays < best) {
      best = strays;
      at = k;
    }
    if (k < n) before += residuals_S[k].norm() > sound_m;
  }
  const std::size_t first = from_start ? at : 0;
  const std::size_t last = from_start ? n : at;
  if (last - first < kFewestOfBroken) return std::nullopt;
  if (best > kStray * static_cast<double>(std::min(last - first, n - (last - first)))) {
    return std::nullopt;
  }
  return Split{std::move(nearest->chain), nearest->fit.reach_m, first, last};
}

struct Cure {
  Hypothesis hypothesis;
  double missed_m = std::numeric_limits<double>::infinity();
};

void turn_reading(Evidence& rows, std::size_t joint, double by) {
  for (EvidenceRow& row : rows.rows) row.q[joint] += by;
}

// What the reading of a joint is off by where it is off by one angle.
double best_turn(const DeviatingChain& chain, const Evidence& broken, std::size_t joint) {
  const auto missed_at = [&](const Evidence& rows, double by) {
    Evidence turned = rows;
    turn_reading(turned, joint, by);
    return missed_m(chain, turned);
  };
  const Evidence few = thinned(broken, kRowsOfGrid);
  double best = 0;
  double least_m = std::numeric_limits<double>::infinity();
  for (int by_deg = -180; by_deg < 180; by_deg += kGrid_deg) {
    const double at_m = missed_at(few, radians(by_deg));
    if (at_m >= least_m) continue;
    least_m = at_m;
    best = radians(by_deg);
  }
  double low = best - radians(kGrid_deg);
  double high = best + radians(kGrid_deg);
  for (int k = 0; k < kThirdings; ++k) {
    const double a = low + (high - low) / 3;
    const double b = high - (high - low) / 3;
    if (missed_at(broken, a) < missed_at(broken, b)) {
      high = b;
    } else {
      low = a;
    }
  }
  return (low + high) / 2;
}

void try_turns(const Split& split, const Evidence& broken, Cure& best) {
  for (std::size_t j = 0; j < broken.arm.joints.size(); ++j) {
    if (broken.arm.joints[j].type != JointType::kRevolute) continue;
    const double by = best_turn(split.chain, broken, j);
    Evidence turned = broken;
    turn_reading(turned, j, by);
    const double at_m = missed_m(split.chain, turned);
    if (at_m >= best.missed_m) continue;
    best = {
        {.cause = fmt::format("the reading of joint {} is off by {:+.1f}°", j + 1, -degrees(by)),
         .undoing = fmt::format("with {:+.1f}° on q{}", degrees(by), j + 1),
         .mend = fmt::format("a look at the encoder of joint {}: a lost count, a homing, an "
                             "exchanged drive",
                             j + 1),
         .surprise = 0.8,
         .undo = [j, by](Evidence& e) { turn_reading(e, j, by); }},
        at_m};
  }
}

Cure best_cure(const Split& split, const Evidence& broken) {
  Cure best;
  std::vector<Hypothesis> all = hypotheses_of_rows(broken);
  std::ranges::move(hypotheses_of_readings(broken), std::back_inserter(all));
  for (Hypothesis& hypothesis : all) {
    Evidence undone = broken;
    hypothesis.undo(undone);
    if (!sees_all_targets(undone, broken)) continue;
    const double at_m = missed_m(split.chain, undone);
    if (at_m < best.missed_m) best = {std::move(hypothesis), at_m};
  }
  try_turns(split, broken, best);
  return best;
}

std::optional<BrokenRows> cured(const Evidence& evidence, const Split& split) {
  const Evidence broken = part_of(evidence, split.first, split.last);
  const Cure cure = best_cure(split, broken);
  if (cure.missed_m > kSoundShare * split.reach_m ||
      cure.missed_m * kCures > missed_m(split.chain, broken)) {
    return std::nullopt;
  }
  Evidence undone = broken;
  cure.hypothesis.undo(undone);
  BrokenRows found{.first_line = broken.rows.front().line,
                   .last_line = broken.rows.back().line,
                   .cause = cure.hypothesis.cause,
                   .undoing = cure.hypothesis.undoing,
                   .mend = cure.hypothesis.mend,
                   .surprise = cure.hypothesis.surprise,
                   .undone = part_of(evidence, 0, split.first)};
  std::ranges::move(undone.rows, std::back_inserter(found.undone.rows));
  std::ranges::move(part_of(evidence, split.last, evidence.rows.size()).rows,
                    std::back_inserter(found.undone.rows));
  return found;
}

}  // namespace

std::optional<BrokenRows> find_broken_rows(const Evidence& evidence, const ArmLimits& limits) {
  if (evidence.rows.size() < kFewestToSplit) return std::nullopt;
  for (const bool from_start : {true, false}) {
    const auto split = split_by(evidence, limits, from_start);
    if (!split) continue;
    if (auto found = cured(evidence, *split)) return found;
  }
  return std::nullopt;
}

}  // namespace armsig::tool
