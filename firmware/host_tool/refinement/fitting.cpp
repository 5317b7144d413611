// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/fitting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/calibration/approach_direction.hpp"

namespace armsig::tool {

using calibration::Engine;
using calibration::FitRow;

namespace {

// Variance of a prior about what the rows themselves gave, in the engine's units: a hundredth of a
// radian and five millimetres say next to nothing.
constexpr double kWide = 25;

// With the receivers of the log, and the corrections that are asked for.
void equip(const CalibrationLog& log, calibration::ArmModel& model) {
  model.sensor.receivers = log.receivers;
  calibration::ask_for(log.request, model);
}

// The mean of the variances that rows state; 0 where none does.
double mean_variance(std::span<const calibration::Observation> rows) {
  double sum = 0;
  std::size_t count = 0;
  for (const calibration::Observation& row : rows) {
    if (!(row.sigma_m > 0)) continue;
    sum += row.sigma_m * row.sigma_m;
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

FitRow row_of(const calibration::Observation& from, double stated_variance) {
  FitRow row;
  row.readings = from.readings;
  row.target = static_cast<std::uint8_t>(from.target);
  row.sweep = static_cast<std::uint8_t>(from.sweep);
  if (from.kind == calibration::ObservationKind::kRange) {
    row.receiver = static_cast<std::uint8_t>(from.receiver);
    row.range_m = from.range_m;
  } else {
    row.p_S = from.p_S;
  }
  if (!(from.sigma_m > 0)) return row;
  const auto relative = static_cast<float>(from.sigma_m * from.sigma_m / stated_variance);
  // Rounding must not make rows of one sigma differ.
  if (std::abs(relative - 1.0F) > 1e-5F) row.relative = {relative, 0, 0, relative, 0, relative};
  return row;
}

// How often each joint turned back from row to row: where it did so rarely, backlash looks like a
// step in time. Rows in no order of time show none.
class TurnsBack {
 public:
  void add(unsigned joints) {
    for (std::size_t j = 0; j < kMaxJoints; ++j) count_[j] += joints >> j & 1U;
  }
  // A bit a joint.
  [[nodiscard]] std::uint8_t often() const {
    constexpr std::size_t kFewest = 8;
    unsigned joints = 0;
    for (std::size_t j = 0; j < kMaxJoints; ++j) joints |= count_[j] >= kFewest ? 1U << j : 0U;
    return static_cast<std::uint8_t>(joints);
  }

 private:
  std::array<std::size_t, kMaxJoints> count_{};
};

}  // namespace

FitStart start_from_drawing(const CalibrationLog& log, const Arm& arm,
                            const calibration::BaseAndTool& fitted) {
  FitStart start{
      calibration::model_of(arm, fitted.X_SB),
      {},
      log.start ? *log.start : calibration::drawn_signature(arm, fitted, log.rows, log.targets),
      false};
  equip(log, start.model);
  for (std::size_t t = 0; t < log.targets.size(); ++t) {
    start.targets.push_back({.link = log.targets[t].link, .p_L = fitted.p_LT[t]});
  }
  return start;
}

FitStart start_from_signature(const CalibrationLog& log) {
  const Signature& signature = *log.start;
  FitStart start{{}, {}, signature, true};
  start.model.couplings = log.nominal.couplings;
  start.model.X_SB = signature.X_SL[0];
  for (std::size_t i = 0; i < signature.joint_count(); ++i) {
    calibration::JointModel joint;
    joint.type = signature.types[i];
    joint.offset = -signature.configuration[i];
    joint.after = signature.X_SL[i].inverse() * signature.X_SL[i + 1];
    joint.domain = calibration::map_domain(joint.type, log.nominal.limits[i]);
    start.model.joints.push_back(joint);
  }
  equip(log, start.model);
  for (const Target& target : signature.targets) {
    start.targets.push_back(
        {.link = target.link, .p_L = signature.X_SL[target.link].inverse() * target.p_S});
  }
  return start;
}

Fitting::Fitting(const CalibrationLog& log) : stated_variance_(mean_variance(log.rows)) {
  const JointTypes types = types_of(log.nominal.joints);
  calibration::ApproachDirection approach;
  TurnsBack turns_back;
  for (const calibration::Observation& from : log.rows) {
    rows_.push_back(row_of(from, stated_variance_));
    const std::uint8_t sides = approach.sides();
    const std::uint8_t sided = approach.sided();
    approach.go_to(types, from.readings);
    turns_back.add(sided & approach.sided() & (sides ^ approach.sides()));
    rows_.back().sides = approach.sides();
    rows_.back().sided = approach.sided();
    rows_.back().index = static_cast<std::uint32_t>(rows_.size() - 1);
  }
  sided_ = turns_back.often();
  for (FitRow& row : rows_) row.sided = static_cast<std::uint8_t>(row.sided & sided_);
  calibration::group_poses(rows_, types);
  poses_ = calibration::deal_folds(rows_);
  cache_.resize(rows_.size());
}

void Fitting::assume_first_sides(std::uint8_t up) {
  for (FitRow& row : rows_) {
    row.sides = static_cast<std::uint8_t>(row.sides | (up & sided_ & ~row.sided));
    row.sided = sided_;
  }
}

Result<calibration::FitSummary> Fitting::run(FitStart& start,
                                             const calibration::ModelParts& parts) {
  matrix_.resize(calibration::matrix_size(Engine::columns(start.model, start.targets.size())));
  engine_ = std::make_unique<Engine>(start.model, start.targets, rows_, cache_, matrix_, *work_);
  engine_->set_stated_variance(stated_variance_);
  play_ = {};
  if (finds_play_) engine_->find_play(play_);
  if (start.of_the_rows) {
    engine_->set_scales(
        {.rotation = kWide, .shift = kWide, .zero = kWide, .geometry_is_held = true});
  }
  return engine_->run(parts);
}

std::optional<LeftOut> Fitting::score(FitStart start, const calibration::ModelParts& parts) {
  if (poses_ < calibration::kFolds) return std::nullopt;
  const auto rejected = std::make_unique<bool[]>(rows_.size());
  for (std::size_t k = 0; k < rows_.size(); ++k) rejected[k] = rows_[k].weight == 0;
  std::vector<calibration::RowScore> scores(rows_.size());
  std::vector<float> order(rows_.size());
  const calibration::Scales scales = engine_->scales();
  const auto left_out =
      calibration::score_held_out({start.model, start.targets, rows_, cache_, matrix_, *work_,
                                   stated_variance_, finds_play_ ? &play_ : nullptr},
                                  parts, scales, {rejected.get(), rows_.size()}, scores, order);
  if (!left_out || left_out->rows == left_out->rejected) return std::nullopt;
  LeftOut found{*left_out, std::vector<float>(rows_.size())};
  for (std::size_t k = 0; k < rows_.size(); ++k)
    found.length_m[rows_[k].index] = scores[k].length_m;
  return found;
}

calibration::HalfPlays Fitting::half_plays(std::size_t joints) const {
  return finds_play_ ? calibration::half_plays(play_, joints) : calibration::HalfPlays{};
}

std::vector<Vector3> Fitting::moved_by_play() const {
  std::vector<Vector3> moved(rows_.size(), Vector3::Zero());
  for (std::size_t k = 0; finds_play_ && k < rows_.size(); ++k) {
    moved[rows_[k].index] = engine_->behind(rows_[k], cache_[k]);
  }
  return moved;
}

void Fitting::note_covered(calibration::ArmModel& model) const {
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    JointLimits& covered = model.joints[i].covered;
    covered = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const FitRow& row : rows_) {
      if (row.weight == 0) continue;
      covered.lower = std::min(covered.lower, row.readings[i]);
      covered.upper = std::max(covered.upper, row.readings[i]);
    }
  }
}

void Fitting::report(std::span<calibration::RowOutcome> verdicts,
                     calibration::FitQuality& quality) const {
  double squares = 0;
  for (const FitRow& row : rows_) {
    verdicts[row.index] = {row.residual.norm(), row.weight, row.weight == 0};
    if (row.weight == 0) {
      ++quality.rows_rejected;
      continue;
    }
    ++quality.rows_used;
    quality.scalars += row.scalars();
    squares += row.residual.squaredNorm();
  }
  quality.rms_m = std::sqrt(squares / static_cast<double>(quality.rows_used));
}

}  // namespace armsig::tool
