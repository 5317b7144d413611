// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/fitting.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <future>
#include <limits>
#include <system_error>
#include <thread>

#include "core/calibration/approach_direction.hpp"
#include "firmware/host_tool/refinement/merged_rows.hpp"

namespace armsig::tool {

using calibration::Engine;
using calibration::FitRow;

namespace {

// Variance of a prior about what the rows themselves gave, in the engine's units: a hundredth of a
// radian and five millimetres say next to nothing.
constexpr double kWide = 25;

// Of more rows, the memory of a second fit beside the first is too much: 2 kB each.
constexpr std::size_t kMostRowsTwice = 50'000;

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

FitRow row_of(const calibration::Observation& from, double stated_variance, const Sides& sides) {
  FitRow row;
  row.sides = sides.sides;
  row.sided = sides.sided;
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

// None where the system gives no thread.
std::future<bool> begin_beside(auto task) {
  try {
    return std::async(std::launch::async, std::move(task));
  } catch (const std::system_error&) {
    return {};
  }
}

struct LogSides {
  std::vector<Sides> rows;
  std::uint8_t often = 0;  // a bit a joint: those that turned back often
};

// By the order of the rows, of the joints that turned back often.
LogSides sides_of(const CalibrationLog& log) {
  const JointTypes types = types_of(log.nominal.joints);
  calibration::ApproachDirection approach;
  TurnsBack turns_back;
  LogSides found;
  found.rows.reserve(log.rows.size());
  for (const calibration::Observation& from : log.rows) {
    const std::uint8_t sides = approach.sides();
    const std::uint8_t sided = approach.sided();
    approach.go_to(types, from.readings);
    turns_back.add(sided & approach.sided() & (sides ^ approach.sides()));
    found.rows.push_back({approach.sides(), approach.sided()});
  }
  found.often = turns_back.often();
  for (Sides& row : found.rows) row.sided = static_cast<std::uint8_t>(row.sided & found.often);
  return found;
}

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

Fitting::Fitting(const CalibrationLog& log) : log_(log), stated_variance_(mean_variance(log.rows)) {
  if (merges(log.rows)) return;
  const LogSides sides = sides_of(log_);
  sided_ = sides.often;
  std::vector<FitRow> rows;
  rows.reserve(log.rows.size());
  for (std::size_t k = 0; k < log.rows.size(); ++k) {
    rows.push_back(row_of(log.rows[k], stated_variance_, sides.rows[k]));
    rows.back().index = static_cast<std::uint32_t>(k);
  }
  group(std::move(rows));
}

void Fitting::gather(const FitStart& start) {
  if (!merges(log_.rows)) return;
  const LogSides sides = sides_of(log_);
  sided_ = sides.often;
  const auto row = [&](std::size_t k) {
    return row_of(log_.rows[k], stated_variance_, sides.rows[k]);
  };
  RowsToFit gathered = merged(log_.rows, sides.rows, row, start);
  parts_ = std::move(gathered.parts);
  group(std::move(gathered.rows));
}

// Sorts the rows by poses, and deals these to folds.
void Fitting::group(std::vector<FitRow> rows) {
  rows_ = std::move(rows);
  calibration::group_poses(rows_, types_of(log_.nominal.joints));
  if (!parts_.empty()) join_groups(rows_, parts_);
  poses_ = calibration::deal_folds(rows_);
  cache_.resize(rows_.size());
  places_.resize(rows_.size());
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    places_[rows_[k].index] = static_cast<std::uint32_t>(k);
  }
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
  auto summary = engine_->run(parts);
  gate_m_ = engine_->gate_m();
  return summary;
}

// Each fold is a fit of its own, and no other changes its answer. A second thread has rows and
// memory of its own.
bool Fitting::score_folds(FitStart& start, const calibration::ModelParts& parts,
                          std::span<calibration::RowScore> scores) {
  const calibration::Scales scales = engine_->scales();
  std::atomic<unsigned> next_fold = 0;
  const auto score_with =
      [&](FitStart& from, std::vector<FitRow>& rows, std::vector<calibration::ChainFrames>& cache,
          std::vector<double>& matrix, calibration::Workspace& work, calibration::PlayBlock& play) {
        std::vector<calibration::Prediction> predictions(parts_.empty() ? 0 : rows.size());
        const calibration::Problem problem{
            from.model, from.targets,     rows,   cache,       matrix,
            work,       stated_variance_, parts_, predictions, finds_play_ ? &play : nullptr};
        return calibration::score_folds(problem, parts, scales, next_fold, scores).has_value();
      };
  std::future<bool> other;
  if (std::thread::hardware_concurrency() > 1 && rows_.size() <= kMostRowsTwice) {
    other = begin_beside([&, from = start, rows = rows_, play = play_]() mutable {
      std::vector<calibration::ChainFrames> cache(rows.size());
      std::vector<double> matrix(matrix_.size());
      const auto work = std::make_unique<calibration::WorkspaceFor<kMaxJoints>>();
      return score_with(from, rows, cache, matrix, *work, play);
    });
  }
  const bool done = score_with(start, rows_, cache_, matrix_, *work_, play_);
  return (!other.valid() || other.get()) && done;
}

// The place of a measured row in the scores: in the log's order where rows were merged.
std::size_t Fitting::measured() const { return parts_.empty() ? rows_.size() : parts_.size(); }

// Of a group that was rejected, the rows that would have been by themselves.
bool Fitting::is_rejected(std::size_t k) const {
  if (parts_.empty()) return rows_[k].weight == 0;
  const FitRow& first = rows_[places_[parts_[k].first]];
  if (first.weight > 0) return false;
  return first.merged.count == 1 || residual(k).norm() > gate_m_;
}

// Of a measured row, where rows were merged.
Vector3 Fitting::residual(std::size_t k) const {
  const calibration::RowPart& part = parts_[k];
  const FitRow& first = rows_[places_[part.first]];
  const FitRow& second = rows_[places_[part.share == 0 ? part.first : part.first + 1]];
  return calibration::residual_of(part, first.residual, second.residual);
}

std::optional<LeftOut> Fitting::score(FitStart start, const calibration::ModelParts& parts) {
  if (poses_ < calibration::kFolds) return std::nullopt;
  const auto rejected = std::make_unique<bool[]>(measured());
  for (std::size_t k = 0; k < measured(); ++k) rejected[k] = is_rejected(k);
  std::vector<calibration::RowScore> scores(measured());
  std::vector<float> order(measured());
  if (!score_folds(start, parts, scores)) return std::nullopt;
  const calibration::HeldOutScore left_out =
      calibration::summarise(scores, {rejected.get(), measured()}, order);
  if (left_out.rows == left_out.rejected) return std::nullopt;
  LeftOut found{left_out, std::vector<float>(measured())};
  for (std::size_t k = 0; k < measured(); ++k) {
    found.length_m[parts_.empty() ? rows_[k].index : k] = scores[k].length_m;
  }
  return found;
}

calibration::HalfPlays Fitting::half_plays(std::size_t joints) const {
  return finds_play_ ? calibration::half_plays(play_, joints) : calibration::HalfPlays{};
}

std::vector<Vector3> Fitting::moved_by_play() const {
  if (!finds_play_) return {};
  std::vector<Vector3> moved(log_.rows.size(), Vector3::Zero());
  const auto behind = [&](std::size_t k) { return engine_->behind(rows_[k], cache_[k]); };
  for (std::size_t k = 0; k < measured(); ++k) {
    if (parts_.empty()) {
      moved[rows_[k].index] = behind(k);
    } else {
      moved[k] = behind(places_[parts_[k].first]);
    }
  }
  return moved;
}

void Fitting::note_covered(calibration::ArmModel& model) const {
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    JointLimits& covered = model.joints[i].covered;
    covered = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (std::size_t k = 0; k < measured(); ++k) {
      if (is_rejected(k)) continue;
      const double reading = parts_.empty() ? rows_[k].readings[i] : log_.rows[k].readings[i];
      covered.lower = std::min(covered.lower, reading);
      covered.upper = std::max(covered.upper, reading);
    }
  }
}

void Fitting::report(std::span<calibration::RowOutcome> verdicts,
                     calibration::FitQuality& quality) const {
  double squares = 0;
  const auto add = [&](std::size_t index, const Vector3& residual, const FitRow& row,
                       bool is_rejected) {
    verdicts[index] = {residual.norm(), is_rejected ? 0.0 : row.weight, is_rejected};
    if (is_rejected) {
      ++quality.rows_rejected;
      return;
    }
    ++quality.rows_used;
    quality.scalars += row.is_range() ? 1 : 3;
    squares += residual.squaredNorm();
  };
  for (std::size_t k = 0; parts_.empty() && k < rows_.size(); ++k) {
    add(rows_[k].index, rows_[k].residual, rows_[k], is_rejected(k));
  }
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    add(k, residual(k), rows_[places_[parts_[k].first]], is_rejected(k));
  }
  quality.rms_m = std::sqrt(squares / static_cast<double>(quality.rows_used));
}

}  // namespace armsig::tool
