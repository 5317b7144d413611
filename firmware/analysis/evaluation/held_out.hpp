// SPDX-License-Identifier: MIT
// How well the model predicts poses that it was not fitted to, and what accuracy may therefore be
// stated (docs/model.md, section 9).
#pragma once

#include <atomic>

#include "core/calibration/engine.hpp"
#include "firmware/analysis/evaluation/row_part.hpp"

namespace armsig::calibration {

// What a row left out says: the length of its error, e^T S^-1 e with S the covariance stated for
// it, and the trace of S.
struct RowScore {
  float length_m = 0;
  float normalised_squares = 0;
  float stated_m2 = 0;
  std::uint8_t scalars = 3;  // 1 of a range
  bool scored = false;
};

struct HeldOutScore {
  std::size_t rows = 0;  // left out and predicted, all of them
  double mean_m = 0;     // of their errors
  double rms_m = 0;
  double largest_m = 0;
  std::size_t rejected = 0;  // those among them that the fit to everything calls blunders
  double mean_kept_m = 0;    // of the others
  double rms_kept_m = 0;
  // k, by which the errors exceed what is stated for them (1 at least), of the rows kept.
  double factor = 1;
  double stated_rms_m = 0;  // k sqrt(tr S), rms over the rows kept: to be compared with rms_kept_m
  // What e^T S^-1 e stays below in 95 % of the rows kept, as of three coordinates (split conformal
  // prediction; Vovk, Gammerman and Shafer, Algorithmic Learning in a Random World, 2005); 0: too
  // few rows.
  double region_squares = 0;
};

// What a fit says of a row that it was not fitted to.
struct Prediction {
  Vector3 residual = Vector3::Zero();
  Matrix3 inverse = Matrix3::Identity();  // of the covariance of a measured row there
  double variance = 0;                    // its trace
  bool held_out = false;
};

// Everything that a fit needs; see Engine.
struct Problem {
  ArmModel& model;  // where every fold's fit begins
  std::span<ModelTarget> targets;
  std::span<FitRow> rows;
  std::span<ChainFrames> cache;
  std::span<double> matrix;
  Workspace& work;
  double stated_variance = 0;
  // Where rows were merged: of every measured row, and memory for as many predictions as rows.
  std::span<const RowPart> parts{};
  std::span<Prediction> predictions{};
  PlayBlock* play = nullptr;  // found too where given, from what it has; of the last fold on return
};

// Fits kFolds times without one fold, each time from where `problem` stands (maps apart, which
// begin at zero), with the scales found by the fit to everything, and scores the fold.
// `rejected[k]`: row k is a blunder by that fit. `rejected`, `scores` and `order` are of the rows,
// or of the measured rows where `parts` has them. Precondition: deal_folds(). On return the model
// is there again, without maps. `order` is for work. Errors: those of Engine::run().
[[nodiscard]] Result<HeldOutScore> score_held_out(const Problem& problem, const ModelParts& parts,
                                                  const Scales& scales,
                                                  std::span<const bool> rejected,
                                                  std::span<RowScore> scores,
                                                  std::span<float> order);

// The two halves of it. No fold depends on another one: several problems, each with rows and memory
// of its own, may share the folds of one log and its scores.
// Scores one fold after the other from `next_fold` on, which counts those that were begun, until
// there is no more.
[[nodiscard]] Result<void> score_folds(const Problem& problem, const ModelParts& parts,
                                       const Scales& scales, std::atomic<unsigned>& next_fold,
                                       std::span<RowScore> scores);
[[nodiscard]] HeldOutScore summarise(std::span<const RowScore> scores,
                                     std::span<const bool> rejected, std::span<float> order);

}  // namespace armsig::calibration
