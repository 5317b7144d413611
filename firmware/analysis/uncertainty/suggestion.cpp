// SPDX-License-Identifier: MIT
#include "firmware/analysis/uncertainty/suggestion.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/joint_range.hpp"
#include "core/base/low_discrepancy.hpp"
#include "core/calibration/row.hpp"
#include "firmware/analysis/uncertainty/tool_covariance.hpp"

namespace armsig::uncertainty {

using calibration::PoeChain;
using calibration::Refined;
using calibration::RowBlock;
using calibration::StateVector;

namespace {

// Candidates follow the configurations of the volume in the same even sequence.
constexpr int kFirstCandidate = 1000;
// Candidates outside the box are passed over, up to so many for one inside.
constexpr int kPatience = 20;
// Of the climb from the best candidate: first step as a share of a joint's range.
constexpr double kFirstStep = 0.1;
constexpr int kClimbRounds = 12;
// Each pose is offered a better place once the others are known (Fedorov's exchange).
constexpr int kExchangePasses = 2;

}  // namespace

bool SuggestionSearch::sees(const PoeChain& chain, const JointVector& readings,
                            RowBlock<3>& rows) const {
  return config_.box.contains(
      calibration::position_rows(*refined_, chain, readings, config_.target, rows).jacobian.p_S);
}

bool SuggestionSearch::has_room(const JointVector& readings) const {
  if (config_.rows.empty()) return true;
  const JointVector q = effective_readings(refined_->readings.couplings, readings);
  return clearance::room_at(config_.rows, config_.around, q).left_m >= clearance::kLeastRoom_m;
}

bool SuggestionSearch::is_clear(const JointVector& readings) const {
  if (config_.rows.empty()) return true;
  const JointCouplings& couplings = refined_->readings.couplings;
  clearance::WayLook look;
  return has_room(readings) &&
         look.whole(config_.rows, config_.around, effective_readings(couplings, config_.home),
                    effective_readings(couplings, readings)) == clearance::WayLook::Says::kClear;
}

Result<void> SuggestionSearch::start(const Refined& refined, const SuggestionConfig& config) {
  ARMSIG_CHECK(config.limits.size() == refined.signature.joint_count());
  ARMSIG_CHECK(refined.layout.target[config.target] != calibration::kNoColumn);
  refined_ = &refined;
  config_ = config;
  if (config_.sigma_m == 0) config_.sigma_m = refined.quality.sigma_m;
  config_.sigma_m = std::hypot(config_.sigma_m, refined.quality.unexplained_m);
  ARMSIG_CHECK(config_.sigma_m > 0);
  next_candidate_ = kFirstCandidate;
  information_ = refined.information;
  volume_.reset(refined.layout.size());
  const PoeChain chain(refined.signature, refined.readings);
  const auto& types = refined_->signature.types;
  int inside = 0;
  for (int k = 1; k <= config_.volume * kPatience && inside < config_.volume; ++k) {
    RowBlock<3> rows;
    const JointVector readings = work_configuration(types, config_.limits, k);
    if (!sees(chain, readings, rows)) continue;
    volume_.absorb(rows);
    ++inside;
  }
  if (inside == 0) return std::unexpected(Error::kOutOfReach);
  volume_.scale(1 / std::sqrt(inside));
  return {};
}

double SuggestionSearch::predicted_rms_m() const {
  const std::size_t n = information_.unknowns();
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    StateVector row;
    for (std::size_t j = 0; j < n; ++j) row[j] = j < i ? 0 : volume_.entry(i, j);
    sum += information_.variance(row, i);
  }
  const double unexplained_m = refined_->quality.unexplained_m;
  return std::sqrt(sum + 3 * unexplained_m * unexplained_m);
}

double SuggestionSearch::gain(RowBlock<3> rows) const {
  const Matrix3 S =
      config_.sigma_m * config_.sigma_m * Matrix3::Identity() + information_.covariance(rows);
  for (auto& row : rows.rows) information_.solve_upper(row);  // P J^T
  const auto& [x, y, z] = rows.rows;
  const std::size_t n = information_.unknowns();
  Matrix3 ZZ = Matrix3::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    Vector3 row = Vector3::Zero();
    for (std::size_t j = i; j < n; ++j) row += volume_.entry(i, j) * Vector3(x[j], y[j], z[j]);
    ZZ += row * row.transpose();
  }
  return (S.inverse() * ZZ).trace();
}

// Pattern search: one joint at a time, by steps that halve once none of them helps.
void SuggestionSearch::climb(const PoeChain& chain, JointVector& readings,
                             double& best_gain) const {
  double step = kFirstStep;
  for (int round = 0; round < kClimbRounds; ++round) {
    bool better = false;
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const JointLimits& limit = config_.limits[i];
      const JointLimits range = finite_range(limit);
      for (const double sense : {1.0, -1.0}) {
        JointVector trial = readings;
        trial[i] = std::clamp(trial[i] + sense * step * (range.upper - range.lower), limit.lower,
                              limit.upper);
        RowBlock<3> rows;
        if (!sees(chain, trial, rows)) continue;
        const double gained = gain(rows);
        if (gained <= best_gain || !is_clear(trial)) continue;
        best_gain = gained;
        readings = trial;
        better = true;
      }
    }
    if (!better) step *= 0.5;
  }
}

Result<JointVector> SuggestionSearch::best_pose(const PoeChain& chain, const JointVector* present) {
  const auto& types = refined_->signature.types;
  JointVector best;
  double best_gain = -1;
  RowBlock<3> rows;
  if (present != nullptr) {
    (void)sees(chain, *present, rows);
    best_gain = gain(rows);
    best = *present;
  }
  int inside = 0;
  for (int k = 0; k < config_.candidates * kPatience && inside < config_.candidates; ++k) {
    const JointVector readings = work_configuration(types, config_.limits, next_candidate_++);
    if (!sees(chain, readings, rows) || !has_room(readings)) continue;
    ++inside;
    if (const double gained = gain(rows); gained > best_gain && is_clear(readings)) {
      best_gain = gained;
      best = readings;
    }
  }
  if (best_gain < 0) return std::unexpected(Error::kOutOfReach);
  climb(chain, best, best_gain);
  return best;
}

void SuggestionSearch::measure(const PoeChain& chain, const JointVector& readings) {
  RowBlock<3> rows;
  (void)sees(chain, readings, rows);
  for (auto& row : rows.rows) {
    for (std::size_t c = 0; c < refined_->layout.size(); ++c) row[c] /= config_.sigma_m;
  }
  information_.absorb(rows);
}

Result<void> SuggestionSearch::suggest(std::span<Suggestion> suggestions) {
  const PoeChain chain(refined_->signature, refined_->readings);
  for (Suggestion& suggestion : suggestions) {
    ARMSIG_TRY(pose, best_pose(chain, nullptr));
    suggestion.readings = pose;
    measure(chain, pose);
  }
  for (int pass = 0; pass < kExchangePasses; ++pass) {
    for (Suggestion& exchanged : suggestions) {
      information_ = refined_->information;
      for (const Suggestion& other : suggestions) {
        if (&other != &exchanged) measure(chain, other.readings);
      }
      ARMSIG_TRY(pose, best_pose(chain, &exchanged.readings));
      exchanged.readings = pose;
    }
  }
  information_ = refined_->information;
  for (Suggestion& suggestion : suggestions) {
    measure(chain, suggestion.readings);
    suggestion.predicted_rms_m = predicted_rms_m();
  }
  return {};
}

}  // namespace armsig::uncertainty
