// SPDX-License-Identifier: MIT
// How well features predict rows that they were not fitted to, in constant memory but for one
// number a row: the rows are read twice, once to fit and once to score.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/host_tool/reading/sweeps.hpp"
#include "firmware/host_tool/signature/cross_validation.hpp"

namespace armsig::tool {

class FeatureValidation {
 public:
  FeatureValidation(const Arm& nominal, const std::string& file, features::Method method);

  // First reading: the rows of sweeps are dealt to folds in turn; each fold's model sees all
  // others.
  void learn(const LocatedRow& row);
  // Fits the models of all folds. False where rows are too few to leave some of them out.
  [[nodiscard]] bool settle(
      const std::function<std::optional<Signature>(const SweptArm&)>& signature_from);
  // Second reading of the same rows in the same order: a row of a sweep is scored by the model that
  // has not seen it, a row of a mixed pose, which no model has seen, by the first.
  void score(const LocatedRow& row);

  // Over the mixed poses where there are enough of them, otherwise over the rows of the sweeps.
  [[nodiscard]] CrossValidation result() const;

 private:
  // The fold of the next row of a sweep's target.
  std::size_t deal(const LocatedRow& row);

  std::vector<SweepSet> folds_;
  std::vector<Signature> models_;
  using OfSweep = std::pair<std::size_t, int>;  // a sweep and its target
  std::map<OfSweep, std::size_t> dealt_;
  std::map<OfSweep, std::vector<double>> swept_residuals_m_;
  std::map<OfSweep, std::vector<double>> mixed_residuals_m_;  // of all targets, one entry
};

}  // namespace armsig::tool
