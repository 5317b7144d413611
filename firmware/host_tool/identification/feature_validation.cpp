// SPDX-License-Identifier: MIT
#include "firmware/host_tool/identification/feature_validation.hpp"

#include <algorithm>
#include <cmath>

#include "core/calibration/fit_row.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {
namespace {

// Mixed poses say more of an arm than its sweeps, once there are as many as two a fold.
constexpr std::size_t kEnoughMixed = 2 * calibration::kFolds;
// Each set is judged by its own median: a sweep that is missed as a whole holds no blunders.
CrossValidation summary(const std::map<std::pair<std::size_t, int>, std::vector<double>>& sets_m) {
  CrossValidation result;
  double mean = 0;
  double squares = 0;
  double mean_kept = 0;
  double squares_kept = 0;
  for (const auto& [of, lengths_m] : sets_m) {
    const double gate_m = blunder_gate_m(lengths_m);
    for (const double length_m : lengths_m) {
      ++result.rows;
      mean += length_m;
      squares += length_m * length_m;
      result.largest_m = std::max(result.largest_m, length_m);
      if (length_m > gate_m) {
        ++result.far_off;
      } else {
        mean_kept += length_m;
        squares_kept += length_m * length_m;
      }
    }
  }
  if (result.rows == 0) return result;
  const auto rows = static_cast<double>(result.rows);
  const auto kept = static_cast<double>(result.rows - result.far_off);
  result.mean_m = mean / rows;
  result.rms_m = std::sqrt(squares / rows);
  result.mean_kept_m = mean_kept / kept;
  result.rms_kept_m = std::sqrt(squares_kept / kept);
  return result;
}

std::size_t rows_of(const std::map<std::pair<std::size_t, int>, std::vector<double>>& sets_m) {
  std::size_t rows = 0;
  for (const auto& [of, lengths_m] : sets_m) rows += lengths_m.size();
  return rows;
}

}  // namespace

FeatureValidation::FeatureValidation(const Arm& nominal, const std::string& file,
                                     features::Method method)
    : folds_(calibration::kFolds, SweepSet(nominal, file, method)) {}

std::size_t FeatureValidation::deal(const LocatedRow& row) {
  return dealt_[{row.sweep, row.target}]++ % calibration::kFolds;
}

void FeatureValidation::learn(const LocatedRow& row) {
  const std::size_t left_out = row.sweep == 0 ? calibration::kFolds : deal(row);
  for (std::size_t fold = 0; fold < folds_.size(); ++fold) {
    // What is wrong with a row, the set of all rows has said already.
    if (fold != left_out) static_cast<void>(folds_[fold].add(row));
  }
}

bool FeatureValidation::settle(
    const std::function<std::optional<Signature>(const SweptArm&)>& signature_from) {
  models_.clear();
  dealt_.clear();
  for (const SweepSet& fold : folds_) {
    const auto swept = fold.finish();
    if (!swept) return false;
    const auto model = signature_from(*swept);
    if (!model) return false;
    models_.push_back(*model);
  }
  return true;
}

void FeatureValidation::score(const LocatedRow& row) {
  const Signature& model = models_[row.sweep == 0 ? 0 : deal(row)];
  const auto* target = std::ranges::find(model.targets, row.target, &Target::number);
  if (target == model.targets.end()) return;
  const double residual_m = (row.p_S - kinematics::target_position(model, row.q, *target)).norm();
  auto& set_m =
      row.sweep == 0 ? mixed_residuals_m_[{}] : swept_residuals_m_[{row.sweep, row.target}];
  set_m.push_back(residual_m);
}

CrossValidation FeatureValidation::result() const {
  return summary(rows_of(mixed_residuals_m_) >= kEnoughMixed ? mixed_residuals_m_
                                                             : swept_residuals_m_);
}

}  // namespace armsig::tool
