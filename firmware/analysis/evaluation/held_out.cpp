// SPDX-License-Identifier: MIT
#include "firmware/analysis/evaluation/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/calibration/engine_detail.hpp"

namespace armsig::calibration {

namespace {

constexpr double kInside = 0.95;
// 95 % of one normal coordinate's square, to that of three.
constexpr float kThreeOfOne = 7.815F / 3.841F;

RowScore score(const Engine& engine, const ChainFrames& frames, const FitRow& row) {
  const Engine::Stated stated = engine.covariance_of(row, frames);
  const Matrix3 S = stated.row + stated.model;
  if (row.is_range()) {
    const double error = row.p_S.dot(row.residual);
    const double variance = row.p_S.dot(S * row.p_S);
    return {static_cast<float>(std::abs(error)), static_cast<float>(error * error / variance),
            static_cast<float>(variance), 1, true};
  }
  return {static_cast<float>(row.residual.norm()),
          static_cast<float>(row.residual.dot(S.inverse() * row.residual)),
          static_cast<float>(S.trace()), 3, true};
}

RowScore score(const RowPart& part, std::span<const Prediction> by_index) {
  const Prediction& first = by_index[part.first];
  const Prediction& second = by_index[part.share == 0 ? part.first : part.first + 1];
  if (!first.held_out) return {};
  const Vector3 residual = residual_of(part, first.residual, second.residual);
  const Prediction& nearer = part.share < 0.5F ? first : second;
  return {static_cast<float>(residual.norm()),
          static_cast<float>(residual.dot(nearer.inverse * residual)),
          static_cast<float>(nearer.variance), 3, true};
}

// The rows held out, all of them positions.
void score_parts(const Problem& problem, const Engine& engine, std::span<RowScore> scores) {
  const std::span<Prediction> by_index = problem.predictions;
  ARMSIG_CHECK(by_index.size() == problem.rows.size());
  ChainFrames frames;
  for (FitRow& row : problem.rows) {
    by_index[row.index].held_out = row.held_out;
    if (!row.held_out) continue;
    evaluate_chain(problem.model, row.readings, problem.targets[row.target].link, frames);
    engine.evaluate(row, frames);
    const Engine::Stated stated = engine.covariance_of(row, frames);
    const Matrix3 S = stated.row + stated.model;
    by_index[row.index] = {row.residual, S.inverse(), S.trace(), true};
  }
  for (std::size_t k = 0; k < scores.size(); ++k) {
    const RowScore scored = score(problem.parts[k], by_index);
    if (scored.scored) scores[k] = scored;
  }
}

void score_rows(const Problem& problem, const Engine& engine, std::span<RowScore> scores) {
  ChainFrames frames;
  for (std::size_t k = 0; k < scores.size(); ++k) {
    FitRow& row = problem.rows[k];
    if (!row.held_out) continue;
    evaluate_chain(problem.model, row.readings, problem.targets[row.target].link, frames);
    engine.evaluate(row, frames);
    scores[k] = score(engine, frames, row);
  }
}

// Where every fold's fit begins.
struct Start {
  std::array<std::array<double, kDeviations>, kMaxJoints> deviations{};
  std::array<MapCoefficients, kMaxJoints> maps{};
  std::array<double, kMaxFurther> further{};
  FixedVector<GravityTerm, kMaxGravityTerms> gravity;
  Pose X_SB;
  std::array<Vector3, kMaxTargets> p_L;

  explicit Start(const Problem& problem)
      : gravity(problem.model.gravity), X_SB(problem.model.X_SB) {
    for (std::size_t j = 0; j < problem.model.joint_count(); ++j) {
      deviations[j] = problem.model.joints[j].deviation;
      maps[j] = problem.model.joints[j].map;
    }
    for (std::size_t k = 0; k < problem.model.further.size(); ++k) {
      further[k] = value_of(std::as_const(problem.model), problem.model.further[k]);
    }
    for (std::size_t t = 0; t < problem.targets.size(); ++t) p_L[t] = problem.targets[t].p_L;
  }

  void restore(const Problem& problem) const {
    problem.model.gravity = gravity;
    problem.model.X_SB = X_SB;
    for (std::size_t j = 0; j < problem.model.joint_count(); ++j) {
      problem.model.joints[j].deviation = deviations[j];
      problem.model.joints[j].map = maps[j];
    }
    for (std::size_t k = 0; k < problem.model.further.size(); ++k) {
      value_of(problem.model, problem.model.further[k]) = further[k];
    }
    for (std::size_t t = 0; t < problem.targets.size(); ++t) problem.targets[t].p_L = p_L[t];
  }
};

// That of `squares` that kInside of a further one are within; 0: there are too few to tell.
double region_squares(std::span<float> squares) {
  const auto count = static_cast<double>(squares.size());
  const auto rank = static_cast<std::size_t>(std::ceil(kInside * (count + 1)));
  if (rank > squares.size()) return 0;
  const auto nth = squares.begin() + static_cast<std::ptrdiff_t>(rank - 1);
  std::nth_element(squares.begin(), nth, squares.end());
  return static_cast<double>(*nth);
}

// How many rows are of `fold`, which are held out from now on.
std::size_t hold_out(std::span<FitRow> rows, std::uint8_t fold) {
  std::size_t held = 0;
  for (FitRow& row : rows) {
    row.held_out = row.fold == fold;
    held += row.held_out;
  }
  return held;
}

}  // namespace

HeldOutScore summarise(std::span<const RowScore> scores, std::span<const bool> rejected,
                       std::span<float> order) {
  HeldOutScore sum;
  double normalised = 0;
  double stated = 0;
  double numbers = 0;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < scores.size(); ++k) {
    const RowScore& row = scores[k];
    if (!row.scored) continue;
    const auto length = static_cast<double>(row.length_m);
    ++sum.rows;
    sum.mean_m += length;
    sum.rms_m += length * length;
    sum.largest_m = std::max(sum.largest_m, length);
    if (rejected[k]) {
      ++sum.rejected;
      continue;
    }
    sum.mean_kept_m += length;
    sum.rms_kept_m += length * length;
    normalised += static_cast<double>(row.normalised_squares);
    stated += static_cast<double>(row.stated_m2);
    numbers += static_cast<double>(row.scalars);
    order[kept++] = row.normalised_squares * (row.scalars == 1 ? kThreeOfOne : 1);
  }
  if (kept == 0) return {};
  const auto all = static_cast<double>(sum.rows);
  const auto some = static_cast<double>(kept);
  sum.mean_m /= all;
  sum.rms_m = std::sqrt(sum.rms_m / all);
  sum.mean_kept_m /= some;
  sum.rms_kept_m = std::sqrt(sum.rms_kept_m / some);
  sum.factor = std::sqrt(std::max(1.0, normalised / numbers));
  sum.stated_rms_m = sum.factor * std::sqrt(stated / some);
  sum.region_squares = region_squares(order.first(kept));
  return sum;
}

Result<void> score_folds(const Problem& problem, const ModelParts& parts, const Scales& scales,
                         std::atomic<unsigned>& next_fold, std::span<RowScore> scores) {
  const std::span<FitRow> rows = problem.rows;
  ARMSIG_CHECK(problem.targets.size() <= kMaxTargets);
  const Start start(problem);
  const PlayBlock::Numbers half =
      problem.play != nullptr ? problem.play->half : PlayBlock::Numbers::Zero();
  for (unsigned fold = next_fold++; fold < kFolds; fold = next_fold++) {
    start.restore(problem);
    const std::size_t held = hold_out(rows, static_cast<std::uint8_t>(fold));
    if (held == 0 || held == rows.size()) continue;
    Engine engine(problem.model, problem.targets, rows, problem.cache, problem.matrix,
                  problem.work);
    engine.set_stated_variance(problem.stated_variance);
    engine.set_scales(scales);
    engine.start_near();
    if (problem.play != nullptr) {
      *problem.play = {};
      problem.play->half = half;
      engine.find_play(*problem.play);
    }
    const auto fitted = engine.run(parts);
    if (!fitted) {
      start.restore(problem);
      return std::unexpected(fitted.error());
    }
    problem.parts.empty() ? score_rows(problem, engine, scores)
                          : score_parts(problem, engine, scores);
  }
  start.restore(problem);
  for (FitRow& row : rows) row.held_out = false;
  return {};
}

Result<HeldOutScore> score_held_out(const Problem& problem, const ModelParts& parts,
                                    const Scales& scales, std::span<const bool> rejected,
                                    std::span<RowScore> scores, std::span<float> order) {
  const std::size_t measured = problem.parts.empty() ? problem.rows.size() : problem.parts.size();
  ARMSIG_CHECK(rejected.size() == measured && scores.size() == measured &&
               order.size() == measured);
  std::fill(scores.begin(), scores.end(), RowScore{});
  std::atomic<unsigned> next_fold = 0;
  if (const auto done = score_folds(problem, parts, scales, next_fold, scores); !done) {
    return std::unexpected(done.error());
  }
  return summarise(scores, rejected, order);
}

}  // namespace armsig::calibration
