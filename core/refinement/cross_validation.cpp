// SPDX-License-Identifier: MIT
#include "core/refinement/cross_validation.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/reading_hash.hpp"

namespace armsig::refinement {

namespace {

// A richer model must earn its keep by this much on poses it has not seen.
constexpr double kWorthwhile = 0.95;

// Deals rows to folds by their readings, whatever the order of the log.
class Dealer {
 public:
  explicit Dealer(std::span<const Observation> log) {
    std::size_t mixed = 0;
    for (const Observation& row : log) {
      if (row.use == RowUse::kFit && row.sweep == 0) ++mixed;
    }
    mixed_only_ = mixed >= 2 * kFolds;
  }

  // The fold of a row, or kFolds where the row is always fitted.
  [[nodiscard]] std::size_t fold(const Observation& row) const {
    if (row.use == RowUse::kIgnore || (mixed_only_ && row.sweep != 0)) return kFolds;
    return static_cast<std::size_t>(hash_of(row.readings) % kFolds);
  }

 private:
  bool mixed_only_ = false;
};

// Marks the rows of one fold kScore, or back.
void mark(std::span<Observation> log, std::size_t fold, RowUse from, RowUse to,
          const Dealer& deal) {
  for (Observation& row : log) {
    if (deal.fold(row) == fold && row.use == from) row.use = to;
  }
}

}  // namespace

std::expected<CrossValidation, Refusal> cross_validate(const Signature& start,
                                                       std::span<Observation> log,
                                                       const RefinementConfig& config,
                                                       std::span<RowOutcome> outcomes,
                                                       Refined& scratch) {
  CrossValidation score;
  const Dealer dealer(log);
  for (const Observation& row : log) ARMSIG_CHECK(row.use != RowUse::kScore);
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    mark(log, fold, RowUse::kFit, RowUse::kScore, dealer);
    const std::expected<void, Refusal> fitted = refine(start, log, config, outcomes, scratch);
    for (std::size_t k = 0; fitted && k < log.size(); ++k) {
      if (log[k].use != RowUse::kScore) continue;
      const double residual = outcomes[k].residual_m;
      ++score.rows;
      score.mean_m += residual;
      score.rms_m += residual * residual;
      score.largest_m = std::max(score.largest_m, residual);
    }
    mark(log, fold, RowUse::kScore, RowUse::kFit, dealer);
    if (!fitted) return std::unexpected(fitted.error());
  }
  if (score.rows > 0) {
    score.mean_m /= static_cast<double>(score.rows);
    score.rms_m = std::sqrt(score.rms_m / static_cast<double>(score.rows));
  }
  return score;
}

std::expected<ReadingTerms, Refusal> choose_reading_terms(const Signature& start,
                                                          std::span<Observation> log,
                                                          const RefinementConfig& config,
                                                          std::span<RowOutcome> outcomes,
                                                          Refined& scratch, CrossValidation& best) {
  RefinementConfig trial = config;
  trial.request.readings.clear();
  ARMSIG_TRY(plain, cross_validate(start, log, trial, outcomes, scratch));
  best = plain;
  ReadingTerms chosen;
  constexpr std::array<ReadingTerms, 4> kRicher{
      {{false, true, false}, {false, false, true}, {true, true, false}, {true, true, true}}};
  for (const ReadingTerms& terms : kRicher) {
    trial.request.readings.clear();
    trial.request.readings.resize(start.joint_count(), terms);
    const auto score = cross_validate(start, log, trial, outcomes, scratch);
    // A model too rich for the log is no error, only no choice.
    if (!score || score->mean_m > kWorthwhile * best.mean_m) continue;
    best = *score;
    chosen = terms;
  }
  return chosen;
}

}  // namespace armsig::refinement
