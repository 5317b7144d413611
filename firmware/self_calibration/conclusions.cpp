// SPDX-License-Identifier: MIT
// What follows from a fit: more poses, or an end and the model that is kept.
#include <algorithm>
#include <cmath>

#include "core/calibration/packed_deflections.hpp"
#include "core/calibration/signature_of_model.hpp"
#include "core/identification.hpp"
#include "firmware/self_calibration/self_calibration.hpp"

namespace armsig::controller {
namespace {

constexpr std::size_t kFewestMore = 15;
constexpr double kMostMore = 0.6;  // of those that there are: a fit tells how many more it takes
constexpr double kMargin = 1.1;    // of those that it should take
// As the desk believes a fit (docs/refinement.md).
constexpr double kMostRejected = 0.4;
constexpr double kMostRms_m = 10e-3;
constexpr double kWorthDeflections = 0.98;
constexpr calibration::ModelParts kGeometry{.gravity = false, .maps = false};

}  // namespace

void SelfCalibration::note_findings() {
  const auto samples = static_cast<double>(prediction_.poses);
  findings_.held_out = judge_.score();
  const double k = findings_.held_out.factor;
  const double play_m2 = prediction_.play_m2 / samples;
  findings_.model_m = k * std::sqrt(prediction_.model_m2 / samples);
  findings_.play_m = std::sqrt(play_m2);
  findings_.budget =
      budget_of(prediction_, types_of(configuration_.drawing.joints), findings_.model_m);
  findings_.fitted = static_cast<std::size_t>(
      std::ranges::count_if(rows(), [](const auto& row) { return !row.held_out; }));
  findings_.rejected = findings_.fitted - kept_;
  if (!is_believable()) {
    refuse(Error::kNotConverged);
    return;
  }
  std::optional<Found>& found = parts_.maps ? whole_ : geometry_;
  calibration::ChainFrames frames;
  evaluate(signature_.configuration, frames);
  found.emplace(Found{model_, target_[0].p_L,
                      k * k * engine_->covariance_at(frames, 0, {1, 0, 0, 1, 0, 1}).model,
                      findings_});
  if (parts_.maps) {
    stage_ = Stage::kTelling;
  } else {
    compare();
  }
}

bool SelfCalibration::is_believable() const {
  const auto fitted = static_cast<double>(findings_.fitted);
  if (static_cast<double>(findings_.rejected) > kMostRejected * fitted) return false;
  return squares_m2_ <= kMostRms_m * kMostRms_m * static_cast<double>(kept_);
}

std::optional<SelfCalibration::Outcome> SelfCalibration::end_of_run() const {
  if (findings_.is_believed() && findings_.predicted_m() <= aim_.accuracy_m) {
    return Outcome::kReached;
  }
  if (const auto over = end_of_visits(now_)) return over;
  const bool never = !std::isfinite(findings_.times_more(aim_.accuracy_m));
  return findings_.is_believed() && never ? std::optional(Outcome::kPlay) : std::nullopt;
}

// After a fit of the whole model.
void SelfCalibration::decide() {
  const auto outcome = end_of_run();
  if (repeated_ < visited_ && (outcome || repeated_ == 0)) {
    begin_repeats();
    return;
  }
  if (!outcome) {
    plan_more();
    return;
  }
  outcome_ = *outcome;
  if (!findings_.is_believed()) {
    whole_.reset();
    stage_ = Stage::kConcluding;
    return;
  }
  for (calibration::JointModel& joint : model_.joints) joint.map.fill(0);
  begin_fit(kGeometry);
}

void SelfCalibration::plan_more() {
  const double more = findings_.times_more(aim_.accuracy_m);
  const auto measured = static_cast<double>(count_);
  const double most = kMostMore * measured;
  const double needed = std::isfinite(more) ? (kMargin * more - 1) * measured : most;
  const auto at_once = static_cast<std::size_t>(
      std::clamp(needed, static_cast<double>(kFewestMore), std::max(most, 1.0 * kFewestMore)));
  const double in_all = static_cast<double>(visited_) + std::max(needed, 0.0);
  wanted_ = visited_ + at_once;
  planned_ = std::max(wanted_, static_cast<std::size_t>(
                                   std::min(in_all, static_cast<double>(memory_.rows.size()))));
  stage_ = Stage::kChoosing;
}

// What was found without gravity and maps is in `geometry_`.
void SelfCalibration::compare() {
  stage_ = Stage::kConcluding;
  if (outcome_ != Outcome::kReached) return;
  // best() is half of a step's work.
  const auto reaches = [&] {
    const Found* const found = best();
    return found != nullptr && found->findings.predicted_m() <= aim_.accuracy_m;
  };
  if (reaches()) return;
  // Geometry that is no worse, but does not reach what gravity and maps reach.
  geometry_.reset();
  if (!reaches()) refuse(Error::kNotConverged);
}

void SelfCalibration::refuse(Error error) {
  if (stage_ != Stage::kConcluding && !parts_.maps) {  // what was found with them stands
    compare();
    return;
  }
  outcome_ = Outcome::kRefused;
  refused_ = error;
  whole_.reset();
  geometry_.reset();
  stage_ = Stage::kConcluding;
}

bool SelfCalibration::whole_is_better() const {
  if (!whole_) return false;
  if (!calibration::check(calibration::packed(whole_->model), configuration_.drawing)) return false;
  return !geometry_ ||
         whole_->findings.held_out.rms_m <= kWorthDeflections * geometry_->findings.held_out.rms_m;
}

const SelfCalibration::Found* SelfCalibration::best() const {
  if (whole_is_better()) return &*whole_;
  return geometry_ ? &*geometry_ : nullptr;
}

Result<void> SelfCalibration::do_write(SignatureRecord& record) const {
  if (outcome_ == Outcome::kChanged) return std::unexpected(Error::kNotConverged);
  const Found* const found = best();
  if (found == nullptr) return {};
  Signature& signature = record.signature;
  std::array<calibration::ModelTarget, 1> target{
      {{.link = signature.joint_count(), .p_L = found->p_L, .rows = 1}}};
  calibration::axes_to_signature(found->model, target, signature);
  signature.targets[0].covariance_m2 = found->tool_m2;
  derive_parameters(signature, configuration_.drawing);
  record.method = Method::kRefined;
  record.accuracy.predicted = found->findings.predicted();
  record.deflections = {};
  if (whole_ && found == &*whole_) record.deflections = calibration::packed(found->model);
  return {};
}

}  // namespace armsig::controller
