// SPDX-License-Identifier: MIT
#include "firmware/analysis/postures/free_motion.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::kinematics {
namespace {

// The turn about the line while joints move without frame n: rounding.
constexpr double kNoTurn = 1e-8;
// On a fold the turn grows with the square of the way, and is far beyond rounding so far off it.
constexpr double kSurelyFree = 0.05;
// A stretch inside the limits may be shorter than a step: looked for where readings come as near to
// being inside as this.
constexpr double kNearlyInside = 0.4;
constexpr double kSamePoint = 1e-4;

// A rotation of frame n about it is none of those that the axes of an arm make.
Line any_line(const Chain& chain, const Pose& X_0n) {
  const Vector3 direction = Vector3(0.36, -0.48, 0.8).normalized();
  return {X_0n.p + 0.5 * chain.length * Vector3(0.7, 0.3, -0.4), direction};
}

}  // namespace

FreeMotion::FreeMotion(const Chain& chain, const Pose& X_0n, const PostureList& list)
    : chain_(chain), list_(list), curve_(chain, X_0n, any_line(chain, X_0n)) {}

FreeMotion::Kind FreeMotion::follow(const JointVector& q, Stretches& best) {
  candidates_.clear();
  stretches_ = 0;
  best.clear();
  const Sample first = sample(q);
  bool free = false;
  for (const bool forwards : {true, false}) {
    if (!curve_.begin(q, forwards)) return Kind::kNone;
    if (!follow_one_way(first, free)) return Kind::kKnown;
    if (curve_.is_whole()) break;
  }
  if (!free) return Kind::kNone;
  keep_best(best);
  return Kind::kNew;
}

bool FreeMotion::follow_one_way(const Sample& first, bool& free) {
  int stretch = 0;  // that of the first sample is the same both ways
  Sample before = first;
  Sample at = first;
  while (curve_.advance()) {
    if (std::abs(curve_.turn()) > kNoTurn) break;
    free = free || !curve_.has_line() || curve_.length() > kSurelyFree;
    if (free && passes_known()) return false;
    const Sample next = sample(curve_.readings());
    look_at(before, at, next, stretch);
    before = at;
    at = next;
  }
  // Where the curve closes, its last stretch is its first.
  if (curve_.is_whole() && first.worth.beyond == 0 && at.worth.beyond == 0) {
    for (Candidate& candidate : candidates_) {
      if (candidate.stretch == stretch) candidate.stretch = 0;
    }
  }
  look_at(before, at, at, stretch);
  return true;
}

// A sample worthier than both of its neighbours leads to the worthiest of a stretch.
void FreeMotion::look_at(const Sample& before, const Sample& at, const Sample& next, int& stretch) {
  if (at.worth.beyond > 0) stretch = ++stretches_;
  const bool best = at.worth <= before.worth && at.worth <= next.worth;
  if (!best || candidates_.full()) return;
  candidates_.push_back({at, stretch});
  if (at.worth.beyond > 0) stretch = ++stretches_;
}

bool FreeMotion::passes_known() const {
  return std::ranges::any_of(known_, [&](const JointVector& one) { return passes(one); });
}

// Whether the last step of the curve goes through `one`, by the point of the step beside it.
bool FreeMotion::passes(const JointVector& one) const {
  constexpr int kMostSecants = 3;
  constexpr double kPastAnEnd = 0.1;  // parts of a step: the next one has it as well
  const JointVector from = curve_.near(0);
  const JointVector to = curve_.near(1);
  JointVector goal = from;  // `one`, turned next to the step
  double squared = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const double by = one[i] - from[i];
    goal[i] += chain_.revolute[i] ? wrap_angle(by) : by;
    squared += (to[i] - from[i]) * (to[i] - from[i]);
  }
  const auto along = [&](const JointVector& q) {
    double sum = 0;
    for (std::size_t i = 0; i < q.size(); ++i) sum += (goal[i] - q[i]) * (to[i] - from[i]);
    return sum / squared;
  };
  double part = along(from);
  if (!(part >= -kPastAnEnd && part <= 1 + kPastAnEnd)) return false;
  // The curve leaves the straight step by less than this.
  if (largest_change(curve_.near(part), goal) > 0.3 * std::sqrt(squared) + kSamePoint) return false;
  for (int k = 0; k < kMostSecants; ++k) {
    const JointVector q = curve_.exactly(part);
    if (largest_change(q, goal) < kSamePoint) return true;
    part += along(q);
  }
  return false;
}

FreeMotion::Sample FreeMotion::refined(Sample at) const {
  constexpr int kMost = 100;
  constexpr double kShortest = 1e-8;
  double step = 0.1;
  for (int k = 0; k < kMost && step > kShortest; ++k) {
    bool better = false;
    for (const double by : {step, -step}) {
      const auto q = curve_.from(at.q, by);
      if (!q) continue;
      const Sample next = sample(*q);
      better = next.worth < at.worth;
      if (!better) continue;
      at = next;
      break;
    }
    if (!better) step *= 0.4;
  }
  return at;
}

void FreeMotion::keep_best(Stretches& best) {
  PostureList::Worth least{1e300, 0};
  for (Candidate& candidate : candidates_) least = std::min(least, candidate.sample.worth);
  FixedVector<Candidate, kMaxStretches> inside;
  Sample outside;
  PostureList::Worth least_outside{1e300, 0};
  for (const Candidate& candidate : candidates_) {
    const bool hopeless = candidate.sample.worth.beyond > kNearlyInside;
    if (hopeless && candidate.sample.worth > least) continue;
    const Sample at = refined(candidate.sample);
    if (at.worth.beyond > 0) {
      if (at.worth < least_outside) {
        outside = at;
        least_outside = at.worth;
      }
      continue;
    }
    Candidate* const same = std::ranges::find(inside, candidate.stretch, &Candidate::stretch);
    if (same == inside.end()) {
      if (!inside.full()) inside.push_back({at, candidate.stretch});
    } else if (at.worth < same->sample.worth) {
      same->sample = at;
    }
  }
  for (const Candidate& one : inside) best.push_back(one.sample.q);
  if (inside.empty() && !outside.q.empty()) best.push_back(outside.q);
}

}  // namespace armsig::kinematics
