// SPDX-License-Identifier: MIT
// The estimator of firmware/calibration over rows of any kind, from a start that the test chooses.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "firmware/analysis/evaluation/held_out.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::test {

inline calibration::FitRow position_row(const JointVector& readings, const Vector3& p_S,
                                        std::uint8_t target = 0) {
  calibration::FitRow row;
  row.readings = readings;
  row.p_S = p_S;
  row.target = target;
  return row;
}

inline calibration::FitRow range_row(const JointVector& readings, std::uint8_t receiver,
                                     double range_m) {
  calibration::FitRow row;
  row.readings = readings;
  row.receiver = receiver;
  row.range_m = range_m;
  return row;
}

inline constexpr calibration::ModelParts kGeometryAlone{.gravity = false, .maps = false};
inline constexpr double kRowSigma_m = 5e-5;

// Positions of all targets at random poses; the index of a row is that of its pose.
inline std::vector<calibration::FitRow> position_rows(const Cell& cell, int poses, double sigma_m,
                                                      Random& random) {
  std::vector<calibration::FitRow> rows;
  for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(poses); ++k) {
    const JointVector q = random.configuration(cell.arm);
    for (std::uint8_t t = 0; t < cell.p_tool.size(); ++t) {
      rows.push_back(position_row(q, cell.point(q, t) + random.normal_vector(sigma_m), t));
      rows.back().index = k;
    }
  }
  return rows;
}

// Model, targets and rows may be changed until engine() is first asked for.
struct EngineCase {
  using Rows = std::vector<calibration::FitRow>;

  EngineCase(const Arm& arm, const Pose& X_SB, const std::vector<Vector3>& p_L,
             const Rows& measured)
      : rows(measured) {
    *model = calibration::model_of(arm, X_SB);
    for (const Vector3& p : p_L) targets.push_back({.link = arm.joints.size(), .p_L = p});
    calibration::group_poses(rows, types_of(arm.joints));
  }

  calibration::Engine& engine() {
    if (!made_) {
      const std::size_t columns = calibration::Engine::columns(*model, targets.size());
      matrix_.resize(calibration::matrix_size(columns));
      cache_.resize(rows.size());
      made_.emplace(*model, targets, rows, cache_, matrix_, *work_);
    }
    return *made_;
  }

  [[nodiscard]] calibration::Problem problem() {
    engine();
    return {*model, targets, rows, cache_, matrix_, *work_, 0};
  }

  // Poses held out of the fit to everything, which was made before.
  [[nodiscard]] Result<calibration::HeldOutScore> held_out(const calibration::ModelParts& parts) {
    calibration::deal_folds(rows);
    const auto rejected = std::make_unique<bool[]>(rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k) rejected[k] = rows[k].weight == 0;
    std::vector<calibration::RowScore> scores(rows.size());
    std::vector<float> order(rows.size());
    return calibration::score_held_out(problem(), parts, engine().scales(),
                                       {rejected.get(), rows.size()}, scores, order);
  }

  [[nodiscard]] calibration::ChainFrames frames(const JointVector& readings) const {
    calibration::ChainFrames at;
    calibration::evaluate_chain(*model, readings, targets[0].link, at);
    return at;
  }
  [[nodiscard]] Vector3 predict(const JointVector& readings) const {
    return frames(readings).X_SL * targets[0].p_L;
  }

  std::unique_ptr<calibration::ArmModel> model = std::make_unique<calibration::ArmModel>();
  std::vector<calibration::ModelTarget> targets;
  Rows rows;

 private:
  std::vector<calibration::ChainFrames> cache_;
  std::vector<double> matrix_;
  std::unique_ptr<calibration::WorkspaceFor<kMaxJoints>> work_ =
      std::make_unique<calibration::WorkspaceFor<kMaxJoints>>();
  std::optional<calibration::Engine> made_;
};

}  // namespace armsig::test
