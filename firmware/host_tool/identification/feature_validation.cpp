// SPDX-License-Identifier: MIT
#include "firmware/host_tool/identification/feature_validation.hpp"

#include <algorithm>
#include <cmath>

#include "core/calibration/fit_row.hpp"
#include "core/kinematics/s_model_chain.hpp"

namespace armsig::tool {
namespace {

// Mixed poses say more of an arm than its sweeps, once there are as many as two a fold.
constexpr std::size_t kEnoughMixed = 2 * calibration::kFolds;
// Residuals beyond so many times their median are gross outliers: for the lengths of errors of
// three coordinates, 5.9 sigma.
constexpr double kGate = 3.8;

CrossValidation summary(std::vector<double> residuals_m) {
  CrossValidation result;
  if (residuals_m.empty()) return result;
  const auto middle = residuals_m.begin() + static_cast<std::ptrdiff_t>(residuals_m.size() / 2);
  std::ranges::nth_element(residuals_m, middle);
  const double gate_m = kGate * *middle;
  for (const double residual_m : residuals_m) {
    if (residual_m > gate_m) continue;
    ++result.rows;
    result.mean_m += residual_m;
    result.rms_m += residual_m * residual_m;
    result.largest_m = std::max(result.largest_m, residual_m);
  }
  result.mean_m /= static_cast<double>(result.rows);
  result.rms_m = std::sqrt(result.rms_m / static_cast<double>(result.rows));
  return result;
}

}  // namespace

FeatureValidation::FeatureValidation(const Arm& nominal, const std::string& file)
    : folds_(calibration::kFolds, SweepSet(nominal, file)) {}

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
    features::Method method,
    const std::function<std::optional<Signature>(const SweptArm&)>& signature_from) {
  models_.clear();
  dealt_.clear();
  for (const SweepSet& fold : folds_) {
    const auto swept = fold.finish(method);
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
  (row.sweep == 0 ? mixed_residuals_m_ : swept_residuals_m_).push_back(residual_m);
}

CrossValidation FeatureValidation::result() const {
  return summary(mixed_residuals_m_.size() >= kEnoughMixed ? mixed_residuals_m_
                                                           : swept_residuals_m_);
}

}  // namespace armsig::tool
