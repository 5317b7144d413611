// SPDX-License-Identifier: MIT
// Models of one log, each fitted to everything and scored on poses left out: geometry alone, with
// corrections of the readings, with gravity and maps. Which of them is believed is decided by the
// scores.
#pragma once

#include "firmware/analysis/starts/start.hpp"
#include "firmware/host_tool/refinement/beside.hpp"
#include "firmware/host_tool/refinement/fitting.hpp"

namespace armsig::tool {

// Corrections of the readings must earn their keep by this much on poses that they have not seen.
inline constexpr double kWorthCorrections = 0.95;
// Fewer rows taken back may be chance.
inline constexpr std::size_t kFewestTakenBack = 2;

struct Candidate {
  FitStart start;  // where its fit began
  FitStart end;    // and where it ended: folds begin there, and need not find the way again
  calibration::ModelParts parts;
  calibration::ParameterRequest request;
  std::unique_ptr<calibration::Refined> refined = std::make_unique<calibration::Refined>();
  std::shared_ptr<calibration::ArmModel> model;
  calibration::FitSummary summary;
  std::optional<LeftOut> left_out;  // none of too few poses
  std::size_t tried = 0;            // with it: which of Candidates::tried()
  std::vector<calibration::RowOutcome> verdicts;
  std::vector<std::size_t> alone;  // targets that a single row sees
  double variance = 0;
  bool deflected = false;  // with gravity or maps
  // Half of each joint's play, none where it was not found; what it has moved the target of every
  // row of the log by; and as the engine found it.
  calibration::HalfPlays half_plays;
  std::vector<Vector3> moved_by_play;
  calibration::PlayBlock::Numbers half = calibration::PlayBlock::Numbers::Zero();
};

// Whether `candidate` predicts poses left out with at most `share` of the mean error of `other`, of
// the rows that either of them does not reject.
[[nodiscard]] bool predicts_better(const Candidate& candidate, const Candidate& other,
                                   double share);

// How many rows `other` rejects and `candidate` does not.
[[nodiscard]] std::size_t taken_back(const Candidate& candidate, const Candidate& other);

// Whether play is there beyond any doubt.
[[nodiscard]] bool is_certain(const calibration::HalfPlay& half);
[[nodiscard]] bool has_certain_play(const Candidate& found);

// Whether a joint's reading is proportionally off by more than encoders are, beyond chance.
[[nodiscard]] bool is_off_by_its_gear(const calibration::Refined& refined, std::size_t joint);

class Candidates {
 public:
  explicit Candidates(const CalibrationLog& log) : log_(log), fitting_(log) {}

  // Before fits from there, or from where such a fit ended: the rows of a long log (fitting.hpp).
  void gather(const FitStart& start) {
    fitting_.gather(start);
    tried_.clear();
  }
  [[nodiscard]] std::optional<std::size_t> merged_rows() const { return fitting_.merged_rows(); }

  // Geometry alone, scored. Errors: those of calibration::Engine::run(); kNotConverged and
  // kTooManyOutliers where it is not to be believed.
  [[nodiscard]] std::expected<Candidate, Refusal> geometry(const FitStart& from);

  // With those corrections of the readings that predict poses left out better than fewer of them,
  // if any do.
  [[nodiscard]] std::optional<Candidate> corrected(const Candidate& plain);

  // With gears that are off, where they predict poses left out as well as `whole` does: a map can
  // stand in for a gear, and says nothing of readings beyond those measured.
  [[nodiscard]] std::optional<Candidate> geared(const Candidate& plain, const Candidate& whole);

  // With gravity, with maps, or with both, whichever predicts poses left out best, if any does
  // better. A joint whose map is no arm's goes without one. Gravity pulls as the arm description
  // has it, or along the vertical that the rows show, where poses left out are predicted better so.
  [[nodiscard]] std::optional<Candidate> deflected(const Candidate& geometry);

  // The same as `plain` with the play of the joints, where a score test gives it `worth` (a
  // logarithm of likelihoods), it is certain, and poses left out are predicted better. Every later
  // candidate then has it too.
  [[nodiscard]] std::optional<Candidate> played(const Candidate& plain, double worth);
  void find_play(bool wanted) { fitting_.find_play(wanted); }

  // From another start, with all that `like` has.
  [[nodiscard]] std::optional<Candidate> fitted_as(const FitStart& start, const Candidate& like);

  // What other unknowns would explain beside it.
  [[nodiscard]] Beside beside(const Candidate& found,
                              Beside::Asked asked = Beside::Asked::kPlayAndPairs) const {
    return {log_, fitting_.rows(), found.end, found.half, asked};
  }

  // Whether the richest corrections take back rows that `plain` rejects.
  [[nodiscard]] bool corrections_take_back(const Candidate& plain);

  // Those scored since gather(), and others that belong to them.
  [[nodiscard]] const std::vector<TriedModel>& tried() const { return tried_; }
  void note(const TriedModel& model) { tried_.push_back(model); }

  [[nodiscard]] double stated_variance() const { return fitting_.stated_variance(); }
  [[nodiscard]] const calibration::StartLimits& limits() const { return limits_; }

 private:
  [[nodiscard]] std::expected<Candidate, Refusal> fitted(
      const FitStart& from, const calibration::ModelParts& parts,
      const calibration::ParameterRequest& request);
  [[nodiscard]] std::expected<Candidate, Refusal> geometry(
      const FitStart& from, const calibration::ParameterRequest& request);
  [[nodiscard]] std::expected<void, Refusal> believable(const Candidate& found) const;
  [[nodiscard]] std::optional<Candidate> with_terms(const Candidate& plain,
                                                    const calibration::ReadingTerms& terms);
  // The best of `best` and of those with gravity along `up_0`.
  [[nodiscard]] std::optional<Candidate> pulled_along(const Vector3& up_0,
                                                      const Candidate& geometry,
                                                      std::optional<Candidate> best);
  [[nodiscard]] std::optional<Candidate> bounded(const FitStart& bent,
                                                 calibration::ModelParts parts,
                                                 const calibration::ParameterRequest& request);
  void score(Candidate& found);
  [[nodiscard]] TriedModel model_tried(const Candidate& found) const;
  static void deflect(Candidate& found);
  // What a fit may be left with: an arm's, or a coarse sensor's.
  [[nodiscard]] double most_m() const;

  const CalibrationLog& log_;
  Fitting fitting_;
  std::vector<TriedModel> tried_;
  // An arm of several metres, or one driven by cables, may be left with more than a table-top one.
  calibration::StartLimits limits_{.rms_m = 10e-3};
};

}  // namespace armsig::tool
