// SPDX-License-Identifier: MIT
// What was measured in the beginning is measured again.
#include <algorithm>

#include "core/calibration/engine_detail.hpp"
#include "firmware/self_calibration/pose_choice.hpp"
#include "firmware/self_calibration/self_calibration.hpp"

namespace armsig::controller {
namespace {

// Of the accuracy that was asked for: a smaller change does not matter.
constexpr double kMatters = 0.5;

// Of each joint's gravity terms that of the outermost weight, which is the nearest to the hand.
Repeats::Motions motions_by_load(const calibration::ArmModel& model,
                                 const calibration::ChainFrames& frames, const Motions& motions) {
  Repeats::Motions by_load;
  for (std::size_t j = 0; j < model.joint_count(); ++j) {
    std::optional<std::size_t> outermost;
    for (std::size_t t = 0; t < model.gravity.size(); ++t) {
      if (model.gravity[t].joint != j) continue;
      if (!outermost || model.gravity[t].origin > model.gravity[*outermost].origin) outermost = t;
    }
    if (outermost) by_load.push_back(frames.levers[*outermost] * motions[j]);
  }
  return by_load;
}

}  // namespace

void SelfCalibration::begin_repeats() {
  repeats_ = {};
  repeated_ = visited_;
  index_ = 0;
  differed_.reset();
  stage_ = Stage::kRepeating;
}

// Of each part of the first half the point at which a load moves the target most.
void SelfCalibration::choose_again() {
  const std::size_t part = std::max(count_ / (2 * Repeats::kMost), std::size_t{1});
  if (!differed_) {
    const std::size_t end = std::min(index_ + part, count_);
    if (index_ >= end || index_ >= part * Repeats::kMost) {
      finish_repeats();
      return;
    }
    again_ = index_;
    for (; index_ < end; ++index_) {
      if (pull_at(index_) > pull_at(again_)) again_ = index_;
    }
  }
  Sides sides = memory_.rows[again_].sides;
  JointVector pose =
      effective_readings(configuration_.drawing.couplings, memory_.rows[again_].readings);
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const auto [lower, upper] = configuration_.drawing.limits[i];
    pose[i] = std::clamp(pose[i], lower, upper);  // the arm may have stood a little beyond
  }
  visit_ = {.approach = approach_to(configuration_, pose, sides), .pose = pose, .again = true};
  stage_ = Stage::kMeasuringAgain;
}

double SelfCalibration::pull_at(std::size_t row) const {
  const calibration::ChainFrames& frames = memory_.cache[row];
  double squares = 0;
  for (const Vector3& motion :
       motions_by_load(model_, frames, motions_at(model_, frames, target_[0].p_L))) {
    squares += motion.squaredNorm();
  }
  return squares;
}

void SelfCalibration::take_again(const MeasuredPoint& point) {
  const calibration::FitRow& row = memory_.rows[again_];
  const calibration::ChainFrames& frames = memory_.cache[again_];
  const double sigma_m = findings_.sensor_m;
  // Of a pose of a sweep it is not known from which side it was come to.
  double play_m2 = 0;
  const Motions motions = motions_at(model_, frames, target_[0].p_L);
  for (std::size_t i = 0; i < findings_.play.size(); ++i) {
    play_m2 += findings_.play[i].squared() * motions[i].squaredNorm();
  }
  const double stated_m2 =
      reference_m2_ *
      (static_cast<double>(row.relative[0]) + static_cast<double>(row.relative[3]) +
       static_cast<double>(row.relative[5])) /
      3;
  const double variance_m2 =
      std::max(2 * sigma_m * sigma_m, stated_m2 + point.covariance_m2.trace() / 3) + 2 * play_m2;
  const Vector3 difference = point.p_S - row.p_S;
  stage_ = Stage::kRepeating;
  // Once more, as the second point may be a wrong one as well as the first; the nearer one counts.
  if (!differed_ && Repeats::is_beyond_chance(difference, variance_m2)) {
    differed_ = difference;
    return;
  }
  const bool was_nearer = differed_ && differed_->norm() < difference.norm();
  repeats_.add(frames.X_SL.R, was_nearer ? *differed_ : difference, variance_m2,
               motions_by_load(model_, frames, motions));
  differed_.reset();
}

void SelfCalibration::finish_repeats() {
  const double rejected = static_cast<double>(findings_.rejected) /
                          static_cast<double>(std::max(findings_.fitted, std::size_t{1}));
  change_ = repeats_.change(rejected, kMatters * aim_.accuracy_m);
  if (change_.what.empty()) {
    decide();
    return;
  }
  outcome_ = Outcome::kChanged;
  whole_.reset();
  geometry_.reset();
  stage_ = Stage::kConcluding;
}

}  // namespace armsig::controller
