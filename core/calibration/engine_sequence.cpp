// SPDX-License-Identifier: MIT
// In which order the engine does what it does: each function either does a bounded part, or says
// which parts come next.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/calibration/engine.hpp"
#include "core/calibration/engine_detail.hpp"

namespace armsig::calibration {

namespace {

constexpr int kLeastRounds = 4;
constexpr int kLeastRoundsNear = 1;  // of a start where such a fit ended
constexpr int kMostRounds = 25;
constexpr int kSoftRounds = 2;
// Of the residuals' own scale: the coarse one has come down to it.
constexpr double kSettledScale = 2;
constexpr int kFirstPasses = 2;
constexpr int kLastPasses = 8;
constexpr int kMostTries = 7;
// Of sigma: a step below it no longer matters. Of sigma^2, as a logarithm.
constexpr double kHarmlessStep = 0.03;
constexpr double kHarmlessChange = 0.01;
// Of what the linear model promised, kept.
constexpr double kGoodGain = 0.75;
constexpr double kPoorGain = 0.25;

}  // namespace

Result<FitSummary> Engine::run(const ModelParts& parts) {
  begin(parts);
  while (step(std::numeric_limits<std::size_t>::max())) {
  }
  return result();
}

bool Engine::step(std::size_t work) {
  agenda_.go_on(*this, work);
  return !agenda_.empty();
}

Result<FitSummary> Engine::result() const {
  ARMSIG_CHECK(agenda_.empty());
  if (failed_) return std::unexpected(*failed_);
  return summary_;
}

void Engine::begin(const ModelParts& parts) {
  parts_ = parts;
  failed_.reset();
  summary_ = {};
  trust_ = 1;
  effective_ = 0;
  coarse_ = 0;
  looked_up_ = false;
  base_moved_.fill(0);
  read_.fill({});
  turned_.fill({});
  held_.reset();
  for (ModelTarget& target : targets_) {
    target.start_L = target.p_L;
    target.rows = 0;
  }
  if (!parts_.gravity) model_.gravity.clear();
  ARMSIG_CHECK(columns_ >= gravity_column() + model_.gravity.size());
  columns_ = gravity_column() + model_.gravity.size();
  agenda_.clear();
  agenda_.put({evaluation(), of_rows(&Engine::count_rows, kLook), &Engine::note_rows});
}

void Engine::count_rows(Units rows) {
  for (FitRow& row : rows_.subspan(rows.first, rows.last - rows.first)) {
    row.weight = 1;
    if (row.held_out) continue;
    summary_.rows += row.merged.count;
    targets_[row.target].rows += row.merged.count;
    for (std::size_t j = 0; j < model_.joint_count(); ++j) read_[j].add(row.readings[j]);
    count_turns(row);
  }
}

void Engine::note_rows() {
  if (summary_.rows == 0) {
    failed_ = Error::kTooFewPoints;
    return;
  }
  note_still();
  note_held();
  scales_.sigma_squared = 1;
  agenda_.put({lengths(), &Engine::conclude_lengths, &Engine::note_start, &Engine::begin_round});
  const bool dropped = drop_gravity();
  if (reset_held() || dropped) agenda_.put({evaluation()});
}

void Engine::note_still() {
  without_map_ = parts_.without_map;
  for (std::size_t j = 0; j < model_.joint_count(); ++j) {
    if (!read_[j].stood_still(model_.joints[j].type)) continue;
    without_map_ = static_cast<std::uint8_t>(without_map_ | 1U << j);
  }
}

void Engine::note_start() {
  scales_.sigma_squared = scale_ * scale_;
  looked_up_ = !cache_.empty();
}

void Engine::begin_round() {
  maps_on_ = parts_.maps && (near_ || summary_.rounds > 0);
  play_on_ = play_ != nullptr && (near_ || summary_.rounds > 0);
  sigma_squared_before_ = scales_.sigma_squared;
  passes_ = kFirstPasses;
  agenda_.put({lengths(), &Engine::conclude_lengths, &Engine::choose_weights,
               &Engine::begin_descent, &Engine::begin_scales, &Engine::end_round});
}

void Engine::choose_weights() {
  if (near_ || (summary_.rounds >= kSoftRounds && !(coarse_ > kSettledScale * scale_))) {
    begin_rejection();
  } else if (coarse_ > 0) {
    begin_soft_weights();
  } else {
    agenda_.put({of_rows(&Engine::add_squares, kLook), &Engine::conclude_coarse,
                 &Engine::begin_soft_weights});
  }
}

void Engine::end_round() {
  ++summary_.rounds;
  const double sigma = std::sqrt(scales_.sigma_squared);
  summary_.converged =
      summary_.rounds >= (near_ ? kLeastRoundsNear : kLeastRounds) &&
      moved_ < kHarmlessStep * sigma &&
      std::abs(std::log(scales_.sigma_squared / sigma_squared_before_)) < kHarmlessChange;
  if (summary_.rounds < kMostRounds && !summary_.converged) {
    begin_round();
  } else {
    begin_last();
  }
}

void Engine::begin_last() {
  passes_ = kLastPasses;
  agenda_.put({lengths(), &Engine::conclude_lengths, &Engine::begin_rejection,
               &Engine::begin_descent, &Engine::begin_scales, &Engine::begin_covariance,
               &Engine::conclude});
}

void Engine::conclude() {
  summary_.degrees_of_model = effective_;
  if (!std::isfinite(scales_.sigma_squared)) failed_ = Error::kSingular;
}

// One step, as long as the cost allows.
void Engine::begin_descent() {
  tries_ = 0;
  agenda_.put({costs(), &Engine::note_before, &Engine::begin_try});
  put_assembly();
}

void Engine::put_assembly() {
  agenda_.put({{&Engine::begin_assembly, columns_ * columns_ / 2 + kMapFactor},
               of_rows(&Engine::assemble, squaring_work())});
}

void Engine::note_before() { cost_before_ = cost(); }

void Engine::begin_try() {
  agenda_.put({{&Engine::begin_improvement, kMapFactor},
               of_rows(&Engine::add_motions, evaluation_work() / 4 + frames_work()),
               &Engine::take_step,
               costs(),
               &Engine::note_expected,
               evaluation(),
               costs(),
               &Engine::judge_try});
}

void Engine::take_step() {
  moved_ = std::sqrt(sums_.squares / std::max(sums_.weights, 1.0));
  move(1);
}

// Of the linear model: residuals as the blocks left them.
void Engine::note_expected() { cost_expected_ = cost(); }

void Engine::judge_try() {
  const double after = cost();
  if (after <= cost_before_) {
    const double gain = (cost_before_ - after) / std::max(cost_before_ - cost_expected_, 1e-300);
    trust_ *= gain > kGoodGain ? 3 : gain < kPoorGain ? 0.5 : 1;
    return;
  }
  move(-1);
  agenda_.put({evaluation(), &Engine::shorten});
}

void Engine::shorten() {
  trust_ /= 5;
  if (++tries_ < kMostTries) begin_try();
}

void Engine::begin_improvement() {
  clear_steps();
  proximal_ = true;
  holding_ = true;
  passes_left_ = passes_;
  agenda_.put({factorisation(), &Engine::improve_geometry, &Engine::improve_maps});
}

void Engine::clear_steps() {
  work_.step.fill(0);
  for (MapCoefficients& step : work_.map_step) step.fill(0);
  if (play_on_) play_->step.setZero();
}

void Engine::improve_geometry() {
  agenda_.put({{&Engine::begin_geometry, 4 * columns_},
               of_rows(&Engine::pull_geometry, filling_work()),
               {&Engine::solve_geometry, columns_ * columns_},
               of_rows(&Engine::follow_geometry, filling_work())});
}

// There and back over the joints, their play, and the geometry; then again.
void Engine::improve_maps() {
  if (!(maps_on_ || play_on_) || passes_left_ == 0) return;
  --passes_left_;
  visit_ = 0;
  agenda_.put({&Engine::improve_next_map, &Engine::improve_play, &Engine::improve_geometry,
               &Engine::improve_maps});
}

void Engine::improve_next_map() {
  const std::size_t n = model_.joint_count();
  if (!maps_on_ || visit_ == 2 * n - 1) return;
  joint_ = visit_ < n ? visit_ : 2 * (n - 1) - visit_;
  ++visit_;
  if (!has_map(joint_)) {
    agenda_.put({&Engine::improve_next_map});
    return;
  }
  agenda_.put({{&Engine::begin_map, 2 * kSplines * kKnots},
               of_rows(&Engine::pull_map, frames_work()),
               {&Engine::solve_map, kMapFactor + kMapSolution},
               of_rows(&Engine::follow_map, frames_work()),
               &Engine::improve_next_map});
}

void Engine::add_costs(Units rows) {
  if (rows.first == 0) sums_ = {};
  for (const FitRow& row : rows_.subspan(rows.first, rows.last - rows.first)) {
    if (!row.held_out && row.weight > 0) sums_.squares += row.weight * whitened_squares(row);
  }
}

// How far the steps of the blocks move the predictions; before move().
void Engine::add_motions(Units rows) {
  if (rows.first == 0) sums_ = {};
  for (std::size_t k = rows.first; k < rows.last; ++k) {
    const FitRow& row = rows_[k];
    if (row.held_out || row.weight == 0) continue;
    FitRow before = row;
    evaluate(before, frames_of(k));
    const Vector3 moved = before.residual - row.residual;
    // Per measured number, three of which are a position.
    const double weight = row.merged.count * row.weight;
    sums_.squares +=
        weight * (row.is_range() ? 3 * std::pow(row.p_S.dot(moved), 2) : moved.squaredNorm());
    sums_.weights += weight;
  }
}

}  // namespace armsig::calibration
