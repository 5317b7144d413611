// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/self_calibration.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/self_calibration/pose_choice.hpp"

namespace armsig::controller {
namespace {

// Multiplications in a step of the fit; with loads and stores, about 100,000 instructions of a
// microcontroller.
constexpr std::size_t kStepWork = 10'000;
constexpr std::size_t kFirstVisits = 60;      // twelve of them held out
constexpr std::size_t kSamples = 100;         // over which the accuracy is predicted
constexpr std::size_t kMostSampled = 20'000;  // then those that are not clear, too
constexpr std::size_t kRowsAtOnce = 8;

std::array<float, 6> packed_covariance(const Matrix3& m) {
  const auto at = [&](Eigen::Index i, Eigen::Index j) { return static_cast<float>(m(i, j)); };
  return {at(0, 0), at(0, 1), at(0, 2), at(1, 1), at(1, 2), at(2, 2)};
}

}  // namespace

Result<std::size_t> SelfCalibration::do_begin(const Aim& aim, const Machine& machine) {
  stage_ = Stage::kIdle;
  outcome_ = Outcome::kNone;
  refused_.reset();
  aim_ = aim;
  visiting_since_.reset();
  approach_.forget();
  recalls_ = false;
  count_ = visited_ = recalled_ = repeated_ = offered_ = looked_at_ = passed_over_ = 0;
  look_ = {};
  change_ = {};
  reference_m2_ = 0;
  wanted_ = planned_ = kFirstVisits;
  engine_.reset();
  knows_ = false;
  whole_.reset();
  geometry_.reset();
  findings_ = {};
  if (journal_ == nullptr) return std::size_t{0};
  return journal_->begin(configuration_, machine, aim.anew);
}

std::optional<KeptPoint> SelfCalibration::do_recall(std::size_t sweep, const JointVector& wanted) {
  if (journal_ == nullptr) return std::nullopt;
  auto kept = journal_->next(sweep, wanted);
  if (kept && kept->point && sweep == 0) ++recalled_;
  // Where those points are from that were kept, the arm has not been since.
  if (recalls_ && !kept) approach_.forget();
  recalls_ = kept.has_value();
  return kept;
}

Result<void> SelfCalibration::do_keep(const KeptPoint& kept) {
  return journal_ == nullptr ? Result<void>() : journal_->keep(kept);
}

Result<void> SelfCalibration::do_forget() {
  return journal_ == nullptr ? Result<void>() : journal_->forget();
}

void SelfCalibration::do_take(std::size_t sweep, const JointVector& readings,
                              const MeasuredPoint& point) {
  note_way(sweep, readings);
  if (stage_ == Stage::kMeasuringAgain) {
    take_again(point);
    return;
  }
  if (stage_ == Stage::kVisiting) stage_ = Stage::kChoosing;
  if (count_ == memory_.rows.size()) return;
  // The first row's is the unit of all: any would do.
  if (count_ == 0) reference_m2_ = point.covariance_m2.trace() / 3;
  calibration::FitRow row;
  row.readings = encoder_readings(readings);
  row.p_S = point.p_S;
  row.relative = packed_covariance(point.covariance_m2 / reference_m2_);
  row.sweep = static_cast<std::uint8_t>(sweep);
  row.index = row.pose = static_cast<std::uint32_t>(count_);
  row.held_out = sweep == 0 && ++visited_ % kHeldOutEvery == 0;
  row.sides = approach_.sides();
  row.sided = approach_.sided();
  memory_.rows[count_++] = row;
}

// Also where the point is not taken.
void SelfCalibration::note_way(std::size_t sweep, const JointVector& readings) {
  const JointTypes types = types_of(configuration_.drawing.joints);
  if (sweep == 0) approach_.go_to(types, visit_.approach);
  approach_.go_to(types, readings);
}

void SelfCalibration::do_lose() {
  note_way(0, visit_.pose);
  differed_.reset();
  stage_ = stage_ == Stage::kMeasuringAgain ? Stage::kRepeating : Stage::kChoosing;
}

void SelfCalibration::do_refine(const Signature& signature) {
  signature_ = signature;
  aligning_.emplace(frames::axis_lines(signature),
                    frames::axis_lines(configuration_.drawing, signature.configuration));
  stage_ = Stage::kAligning;
}

Refinement::Next SelfCalibration::do_step(hal::Instant now) {
  now_ = now;
  switch (stage_) {
    case Stage::kChoosing:
      choose(now);
      return stage_ == Stage::kVisiting ? Next::kVisits : Next::kComputes;
    case Stage::kRepeating:
      choose_again();
      return stage_ == Stage::kMeasuringAgain ? Next::kVisits : Next::kComputes;
    case Stage::kVisiting:
    case Stage::kMeasuringAgain:
      return Next::kVisits;
    case Stage::kTelling:
      telling_ = &SelfCalibration::tell_progress;
      decide();
      return Next::kTells;
    case Stage::kConcluding:
      telling_ = &SelfCalibration::tell_outcome;
      stage_ = best() != nullptr ? Stage::kPlayTelling : Stage::kAdvising;
      return Next::kTells;
    case Stage::kPlayTelling:
      telling_ = &SelfCalibration::tell_play;
      stage_ = Stage::kBudgetTelling;
      return Next::kTells;
    case Stage::kBudgetTelling:
      telling_ = &SelfCalibration::tell_budget;
      stage_ = outcome_ == Outcome::kReached ? Stage::kDone : Stage::kAdvising;
      return Next::kTells;
    case Stage::kAdvising:
      telling_ = &SelfCalibration::tell_advice;
      stage_ = Stage::kDone;
      return Next::kTells;
    case Stage::kIdle:
    case Stage::kDone:
      return Next::kDone;
    default:
      work();
      return Next::kComputes;
  }
}

void SelfCalibration::work() {
  switch (stage_) {
    case Stage::kAligning:
      if (!aligning_->step()) begin_model();
      return;
    case Stage::kWeighing:
      if (!weighing_->step()) begin_visits();
      return;
    case Stage::kFitting:
      if (!engine_->step(kStepWork)) finish_fit();
      return;
    case Stage::kPlay:
      play_step();
      return;
    case Stage::kJudging:
      judge_step();
      return;
    default:
      predict_step();
      return;
  }
}

void SelfCalibration::begin_model() {
  model_ = calibration::model_of(configuration_.drawing, aligning_->result().X_AB);
  aligning_.reset();
  // As many as there is room for.
  weighing_.emplace(configuration_.drawing, model_,
                    calibration::most_gravity_terms(memory_.work->band.size()));
  stage_ = Stage::kWeighing;
}

void SelfCalibration::begin_visits() {
  weighing_.reset();
  calibration::ChainFrames frames;
  target_ = {{{.link = configuration_.drawing.joints.size()}}};
  evaluate(signature_.configuration, frames);
  target_[0].p_L = frames.X_SL.inverse() * signature_.targets[0].p_S;
  scales_ = {};
  play_.half.setZero();
  stage_ = Stage::kChoosing;
}

void SelfCalibration::evaluate(const JointVector& effective,
                               calibration::ChainFrames& frames) const {
  calibration::evaluate_chain(model_, encoder_readings(effective), target_[0].link, frames);
}

// The model goes on from where it stands, and the scales do.
void SelfCalibration::begin_fit(const calibration::ModelParts& parts) {
  parts_ = parts;
  engine_.emplace(model_, target_, rows(), memory_.cache.first(count_), memory_.matrix,
                  *memory_.work);
  knows_ = false;
  engine_->set_stated_variance(reference_m2_);
  engine_->set_scales(scales_);
  engine_->find_play(play_);
  engine_->begin(parts);
  stage_ = Stage::kFitting;
}

void SelfCalibration::finish_fit() {
  if (const auto fitted = engine_->result(); !fitted) {
    refuse(fitted.error());
    return;
  }
  knows_ = true;
  scales_ = engine_->scales();
  index_ = 0;
  squares_m2_ = 0;
  kept_ = 0;
  judge_ = {};
  covered_ = {};
  prediction_ = {};
  sampled_ = 0;
  stage_ = Stage::kPlay;
}

void SelfCalibration::play_step() {
  for (std::size_t n = 0; n < kRowsAtOnce && index_ < count_; ++n, ++index_) {
    const calibration::FitRow& row = memory_.rows[index_];
    if (row.weight == 0 || row.held_out) continue;
    ++kept_;
    squares_m2_ += row.residual.squaredNorm();
    covered_.add(effective_readings(configuration_.drawing.couplings, row.readings));
    if (row.sweep != 0) continue;
    judge_.add_fitted(row.residual, engine_->covariance_of(row, memory_.cache[index_]));
    ++index_;
    break;  // the covariance is a step's work
  }
  if (index_ < count_) return;
  findings_.sensor_m = std::sqrt(scales_.sigma_squared);
  findings_.play = half_plays(play_, model_.joint_count());
  index_ = 0;
  stage_ = Stage::kJudging;
}

// A held-out row a step.
void SelfCalibration::judge_step() {
  while (index_ < count_ && !memory_.rows[index_].held_out) ++index_;
  if (index_ < count_ && judge_.count() < kMostSelfHeldOut) {
    judge_.add(*engine_, memory_.rows[index_], memory_.cache[index_]);
    ++index_;
    return;
  }
  index_ = 0;
  stage_ = Stage::kPredicting;
}

// A sample a step.
void SelfCalibration::predict_step() {
  if (prediction_.poses < kSamples) {
    const JointVector pose = sample_pose(configuration_, sampled_++);
    const bool outside = room_at(configuration_, pose).left_m < kLeastRoom_m;
    if (outside && sampled_ < kMostSampled) return;
    calibration::ChainFrames frames;
    evaluate(pose, frames);
    prediction_.add(*engine_, frames, pose, covered_, motions_at(model_, frames, target_[0].p_L),
                    findings_.play);
    return;
  }
  note_findings();
}

}  // namespace armsig::controller
