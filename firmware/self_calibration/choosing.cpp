// SPDX-License-Identifier: MIT
// Which pose is visited next, and when there are no more visits.
#include "firmware/self_calibration/pose_choice.hpp"
#include "firmware/self_calibration/self_calibration.hpp"

namespace armsig::controller {
namespace {

constexpr std::size_t kOffers = 4;  // looked at for a visit

}  // namespace

std::optional<SelfCalibration::Outcome> SelfCalibration::end_of_visits(hal::Instant now) const {
  if (count_ == memory_.rows.size()) return Outcome::kMemoryFull;
  // What the poses measured again and the held-out ones of the identification are going to take.
  const hal::Duration after =
      each_visit().value_or(hal::Duration{}) *
      static_cast<std::int64_t>(Repeats::kMost + configuration_.sweeps.validation_poses);
  return now + after >= aim_.ends ? std::optional(Outcome::kTimeOver) : std::nullopt;
}

std::optional<hal::Duration> SelfCalibration::each_visit() const {
  if (!visiting_since_ || visited_ <= recalled_) return std::nullopt;
  return (now_ - *visiting_since_) / static_cast<std::int64_t>(visited_ - recalled_);
}

// A look at one offer.
void SelfCalibration::choose(hal::Instant now) {
  if (!visiting_since_) visiting_since_ = now;
  if (visited_ >= wanted_ || end_of_visits(now)) {
    begin_fit({});
    return;
  }
  const JointVector pose = offered_pose(configuration_, offered_);
  const WayLook::Says says = look_at_offer(pose);
  if (says == WayLook::Says::kMore) return;
  look_ = {};
  ++offered_;
  if (says == WayLook::Says::kLeaves) {
    ++passed_over_;
    return;
  }
  // Those held out are spread without a choice.
  if (!knows_ || (visited_ + 1) % kHeldOutEvery == 0) {
    take_offer(pose);
    return;
  }
  calibration::ChainFrames frames;
  evaluate(pose, frames);
  const double open_m2 = engine_->covariance_at(frames, 0, {1, 0, 0, 1, 0, 1}).model.trace();
  if (looked_at_ == 0 || open_m2 > best_m2_) {
    best_m2_ = open_m2;
    best_ = pose;
  }
  if (++looked_at_ == kOffers) take_offer(JointVector(best_));
}

// A bounded step of it: the way to the pose, and that it may be come to from each of its sides.
WayLook::Says SelfCalibration::look_at_offer(const JointVector& pose) {
  const JointVector& home = configuration_.sweeps.configuration;
  const WayLook::Says says = look_on(look_, configuration_, home, pose);
  if (says != WayLook::Says::kClear || configuration_.around.are_empty()) return says;
  const double room_m = room_at(configuration_, pose, approach(configuration_)).left_m;
  return room_m > kLeastRoom_m ? says : WayLook::Says::kLeaves;
}

void SelfCalibration::take_offer(const JointVector& pose) {
  looked_at_ = 0;
  Sides sides = dealt_sides(offered_);
  visit_.again = false;
  visit_.pose = pose;
  visit_.approach = approach_to(configuration_, pose, sides);
  stage_ = Stage::kVisiting;
}

}  // namespace armsig::controller
