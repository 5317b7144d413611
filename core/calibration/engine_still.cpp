// SPDX-License-Identifier: MIT
// Of joints that stood still nothing is estimated: their axes and zeros, and the zero of the last
// joint that moved, do to the rows what base, target or the next axis that moved can do as well.
// The jitter of readings would tell them apart by chance, and other poses would be predicted from
// that. Nor do they get gravity or corrections. What they may be off by is in the covariance.
#include "core/calibration/engine.hpp"

namespace armsig::calibration {

void Engine::count_turns(const FitRow& row) {
  const JointVector effective = effective_readings(model_.couplings, row.readings);
  for (std::size_t j = 0; j < targets_[row.target].link; ++j) turned_[j].add(effective[j]);
}

void Engine::note_held() {
  const std::size_t n = model_.joint_count();
  std::size_t first = 0;
  while (first < n && stands_still(first)) ++first;
  std::size_t last = n;
  while (last > first && stands_still(last - 1)) --last;
  for (std::size_t j = 0; j < n; ++j) {
    // The base stands for the first axis that moved as well.
    const bool all = stands_still(j) || (first > 0 && j == first);
    for (std::size_t k = 0; all && k < kDeviations; ++k) held_[joint_column(j) + k] = true;
  }
  if (first < last && last < n) held_[joint_column(last - 1) + 4] = true;
  for (std::size_t k = 0; k < model_.further.size(); ++k) {
    const Parameter& parameter = model_.further[k];
    if (of_reading(parameter) && stands_still(parameter.index)) held_[further_column() + k] = true;
  }
}

// True where a term had a coefficient, or stood before one that stays.
bool Engine::drop_gravity() {
  const auto terms = model_.gravity;
  model_.gravity.clear();
  for (const GravityTerm& term : terms) {
    if (!stands_still(term.joint)) model_.gravity.push_back(term);
  }
  columns_ = gravity_column() + model_.gravity.size();
  return model_.gravity.size() != terms.size();
}

// True where the model did not stand there.
bool Engine::reset_held() {
  bool moved = false;
  for (std::size_t c = joint_column(0); c < gravity_column(); ++c) {
    if (!held_[c] || deviation(c) == 0) continue;
    moved = true;
    if (c >= further_column()) {
      value_of(model_, model_.further[c - further_column()]) = 0;
    } else {
      const std::size_t k = c - joint_column(0);
      model_.joints[k / kDeviations].deviation[k % kDeviations] = 0;
    }
  }
  return moved;
}

}  // namespace armsig::calibration
