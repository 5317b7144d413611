// SPDX-License-Identifier: MIT
// How well the refined model predicts poses that it was not fitted to.
#pragma once

#include "core/refinement/refinement.hpp"

namespace armsig::refinement {

inline constexpr std::size_t kFolds = 5;

struct CrossValidation {
  std::size_t rows = 0;  // scored
  double mean_m = 0;     // of the residual lengths
  double rms_m = 0;
  double largest_m = 0;
};

// Fits kFolds times, each time without one fold, and scores the fold. Poses are dealt to the folds
// by a hash of their readings, so that rows that repeat them stay together and the order of the log
// does not matter. Poses of sweep 0 are dealt where there are enough of them, otherwise the rows of
// the sweeps. Only rows of use kFit take part (mark the fit's rejected rows kIgnore before); `log`
// is unchanged on return. `outcomes` and `scratch` are for work. Errors: those of refine(), of any
// fold.
[[nodiscard]] std::expected<CrossValidation, Refusal> cross_validate(const Signature& start,
                                                                     std::span<Observation> log,
                                                                     const RefinementConfig& config,
                                                                     std::span<RowOutcome> outcomes,
                                                                     Refined& scratch);

// The corrections of the readings, the same ones for every joint, that lower the cross-validated
// mean by at least a twentieth: tried are none, once a turn, twice a turn, gain and once, gain and
// both. `best` receives the score of the choice. Errors: those of refine() without corrections.
[[nodiscard]] std::expected<ReadingTerms, Refusal> choose_reading_terms(
    const Signature& start, std::span<Observation> log, const RefinementConfig& config,
    std::span<RowOutcome> outcomes, Refined& scratch, CrossValidation& best);

}  // namespace armsig::refinement
