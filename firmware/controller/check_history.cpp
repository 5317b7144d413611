// SPDX-License-Identifier: MIT
#include "firmware/controller/check_history.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "core/drift/check_drift.hpp"
#include "core/drift/course.hpp"
#include "core/numerics/quantiles.hpp"

namespace armsig::controller {
namespace {

// The residuals of the first check are compared with those that the signature was accepted with,
// at poses that are not the same: the RMS of 16 poses over that of 8 exceeds this by chance less
// than once in 1,000, were all three components of a pose to err together (Fisher's law).
constexpr double kFirstFactor = 3;

Vector3 mean_of(const MeasuredCheck& checked) {
  Vector3 sum = Vector3::Zero();
  for (const drift::PoseResidual& pose : checked.poses) sum += pose.residual_m;
  return sum / static_cast<double>(checked.poses.size());
}

double squares_of(const MeasuredCheck& checked) {
  double squares = 0;
  for (const drift::PoseResidual& pose : checked.poses) squares += pose.residual_m.squaredNorm();
  return squares;
}

Result<CheckVerdict> what_changed(const MeasuredCheck& checked, double sigma_m,
                                  CheckVerdict of_the_arm) {
  ARMSIG_TRY(report, drift::what_moved(checked.poses, sigma_m));
  return report.moved == drift::Moved::kReference ? CheckVerdict::kReferenceMoved : of_the_arm;
}

// The first check: against the signature itself and what it was accepted with.
Result<CheckVerdict> against_signature(const MeasuredCheck& checked, double held_out_rms_m) {
  const auto n = static_cast<double>(checked.poses.size());
  const double stood_m = std::max(held_out_rms_m, std::numbers::sqrt3 * checked.sigma_m);
  if (std::sqrt(squares_of(checked) / n) <= kFirstFactor * stood_m) {
    return CheckVerdict::kAsAccepted;
  }
  return what_changed(checked, stood_m / std::numbers::sqrt3, CheckVerdict::kStepped);
}

}  // namespace

std::string_view describe(CheckVerdict verdict) {
  switch (verdict) {
    case CheckVerdict::kAsAccepted:
      return "as accepted";
    case CheckVerdict::kDrifting:
      return "drifting";
    case CheckVerdict::kStepped:
      return "stepped";
    case CheckVerdict::kReferenceMoved:
      return "the reference moved";
    case CheckVerdict::kNotMeasured:
      return "could not measure";
  }
  return "unknown";
}

bool CheckHistory::begin(std::uint32_t sequence, std::int64_t identified_at_s) {
  if (sequence == state_.sequence && identified_at_s == state_.identified_at_s) return false;
  state_.sequence = sequence;
  state_.identified_at_s = identified_at_s;
  state_.learnt = 0;
  state_.sum = {};
  state_.reference.fill({});
  state_.since.fill({});
  state_.means.clear();
  return true;
}

// Leaves the residuals less their references, of the poses that have one.
void CheckHistory::compare_at_known_places(MeasuredCheck& checked) const {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < checked.poses.size(); ++i) {
    const CheckState::Mean& reference = state_.reference[checked.places[i]];
    if (reference.count == 0) continue;
    checked.places[kept] = checked.places[i];
    checked.poses[kept] = checked.poses[i];
    checked.poses[kept++].residual_m -= reference.value();
  }
  checked.poses.resize(kept);
  checked.places.resize(kept);
}

void CheckHistory::learn(const MeasuredCheck& less) {
  for (std::size_t i = 0; i < less.poses.size(); ++i) {
    CheckState::Mean& reference = state_.reference[less.places[i]];
    reference.add(reference.value() + less.poses[i].residual_m);
  }
  ++state_.learnt;
}

// `less`: the residuals of poses that have a reference, less that.
Result<CheckVerdict> CheckHistory::against_reference(MeasuredCheck& less) {
  const double sigma_m = less.sigma_m;
  const auto n = static_cast<double>(less.poses.size());
  const bool learning = state_.learnt < kCheckBaseline;
  const double told_m = learning ? sigma_m * std::sqrt(1 + 1.0 / state_.learnt) : sigma_m;
  // A sound check is beyond it once in some 100,000 even where sigma is told a tenth too small.
  const double limit = numerics::chi_square_quantile(3 * n, numerics::kFiveSigma);
  const bool beyond = squares_of(less) / (told_m * told_m) > limit;
  if (beyond && learning) return what_changed(less, told_m, CheckVerdict::kStepped);
  if (learning) return CheckVerdict::kAsAccepted;
  if (!beyond) return by_the_sum(less, sigma_m / std::sqrt(n));
  ARMSIG_TRY(at_once, what_changed(less, told_m, CheckVerdict::kStepped));
  ARMSIG_TRY(with_those_before, by_the_sum(less, sigma_m / std::sqrt(n)));
  return with_those_before == CheckVerdict::kAsAccepted ? at_once : with_those_before;
}

Result<CheckVerdict> CheckHistory::by_the_sum(MeasuredCheck& less, double check_sigma_m) {
  const Vector3 mean_m = mean_of(less);
  ARMSIG_TRY(next, drift::after_check(state_.sum, mean_m,
                                      {.sigma_m = check_sigma_m,
                                       .reference = kCheckReference,
                                       .threshold = kCheckThreshold}));
  state_.sum = next;
  if (state_.means.full()) {
    std::ranges::copy(std::span(state_.means).subspan(1), state_.means.begin());
    state_.means[state_.means.size() - 1] = mean_m.cast<float>();
  } else {
    state_.means.push_back(mean_m.cast<float>());
  }
  if (state_.sum.since == 0) state_.since.fill({});
  std::size_t fewest = kCheckBaseline;
  for (std::size_t i = 0; i < less.poses.size(); ++i) {
    CheckState::Mean& since = state_.since[less.places[i]];
    since.add(less.poses[i].residual_m);
    less.poses[i].residual_m = since.value();
    fewest = std::min<std::size_t>(fewest, since.count);
  }
  if (!state_.sum.named) return CheckVerdict::kAsAccepted;
  const double pose_sigma_m = less.sigma_m / std::sqrt(static_cast<double>(fewest));
  ARMSIG_TRY(moved, what_changed(less, pose_sigma_m, CheckVerdict::kDrifting));
  if (moved == CheckVerdict::kReferenceMoved) return moved;
  FixedVector<Vector3, kCheckBaseline> means;
  for (const CheckState::Small& mean : state_.means) means.push_back(mean.cast<double>());
  const auto course = drift::course_of(means, check_sigma_m);
  return course && course->course == drift::Course::kRamp ? CheckVerdict::kDrifting
                                                          : CheckVerdict::kStepped;
}

Result<CheckReport> CheckHistory::take(MeasuredCheck& checked, double held_out_rms_m) {
  if (checked.poses.size() < kFewestCheckPoses) return std::unexpected(Error::kTooFewPoints);
  if (!(checked.sigma_m > 0)) return std::unexpected(Error::kNotPositive);
  const auto n = static_cast<double>(checked.poses.size());
  CheckReport report{.mean_m = mean_of(checked),
                     .rms_m = std::sqrt(squares_of(checked) / n),
                     .sigma_m = checked.sigma_m / std::sqrt(n)};
  if (!std::isfinite(report.rms_m)) return std::unexpected(Error::kNotFinite);
  const bool first = state_.learnt == 0;
  if (!first) {
    compare_at_known_places(checked);
    if (checked.poses.size() < kFewestCheckPoses) return std::unexpected(Error::kTooFewPoints);
  }
  const bool learns = state_.learnt < kCheckBaseline;
  ARMSIG_TRY(verdict,
             first ? against_signature(checked, held_out_rms_m) : against_reference(checked));
  report.verdict = verdict;
  if (verdict == CheckVerdict::kAsAccepted && learns) learn(checked);
  report.sum = state_.sum.sum.norm();
  report.learnt = state_.learnt;
  return report;
}

}  // namespace armsig::controller
