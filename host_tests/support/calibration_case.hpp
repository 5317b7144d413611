// SPDX-License-Identifier: MIT
// The estimator of firmware/calibration over a log, with the memory that it needs.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/signature_of_model.hpp"
#include "firmware/analysis/evaluation/held_out.hpp"
#include "firmware/analysis/starts/start.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::test {

class Calibration {
 public:
  // One target on the last link. `relative`: the covariances of the rows over `stated_variance`;
  // none: all alike, and nothing stated.
  Calibration(const Arm& arm, const Log& log, const calibration::ModelParts& parts,
              std::span<const Matrix3> relative = {}, double stated_variance = 0)
      : parts_(parts), rows_(log.size()), cache_(log.size()) {
    Target target;
    target.link = arm.joints.size();
    const auto fitted = calibration::fit_base_and_tool(arm, log, {&target, 1});
    if (!fitted) return;
    *model_ = calibration::model_of(arm, fitted->X_SB);
    if (parts.gravity) calibration::choose_gravity_terms(arm, *model_);
    targets_ = {{.link = target.link, .p_L = fitted->p_LT[0]}};
    *start_ = *model_;
    start_targets_ = targets_;
    const auto types = types_of(arm.joints);
    for (std::size_t k = 0; k < log.size(); ++k) {
      rows_[k].readings = log[k].readings;
      rows_[k].p_S = log[k].p_S;
      rows_[k].sweep = static_cast<std::uint8_t>(log[k].sweep);
      rows_[k].index = static_cast<std::uint32_t>(k);
      if (relative.empty()) continue;
      const auto at = [&](Eigen::Index i, Eigen::Index j) {
        return static_cast<float>(relative[k](i, j));
      };
      rows_[k].relative = {at(0, 0), at(0, 1), at(0, 2), at(1, 1), at(1, 2), at(2, 2)};
    }
    calibration::group_poses(rows_, types);
    calibration::deal_folds(rows_);
    matrix_.resize(calibration::matrix_size(calibration::Engine::columns(*model_, 1)));
    engine_ =
        std::make_unique<calibration::Engine>(*model_, targets_, rows_, cache_, matrix_, *work_);
    engine_->set_stated_variance(stated_variance);
  }

  std::optional<calibration::FitSummary> fit() {
    if (engine_ == nullptr) return std::nullopt;
    const auto done = engine_->run(parts_);
    return done ? std::optional(*done) : std::nullopt;
  }

  void hold_out_everything() {
    for (calibration::FitRow& row : rows_) row.held_out = true;
  }

  // The same by steps of `work` each; their number.
  std::size_t fit_by_steps(std::size_t work) {
    engine_->begin(parts_);
    std::size_t steps = 1;
    while (engine_->step(work)) ++steps;
    return steps;
  }

  // After fit(): axes, target and their covariance in the frames of the drawing.
  bool put_into(calibration::Refined& refined, const Arm& arm, const Log& log) const {
    Target target;
    target.link = arm.joints.size();
    const calibration::BaseAndTool drawn{start_->X_SB, {{start_targets_[0].p_L}}, 0};
    refined = {};
    refined.signature = calibration::drawn_signature(arm, drawn, log, {&target, 1});
    refined.readings.couplings = arm.couplings;
    std::vector<double> scratch(calibration::kMaxParameters * calibration::kMaxParameters);
    if (!calibration::geometry_to_signature(*model_, targets_, *engine_, refined, {}, scratch)) {
      return false;
    }
    double squares = 0;
    for (const calibration::FitRow& row : rows_) {
      if (row.weight == 0) continue;
      squares += row.residual.squaredNorm();
      ++refined.quality.rows_used;
    }
    refined.quality.rms_m = std::sqrt(squares / static_cast<double>(refined.quality.rows_used));
    refined.quality.sigma_m = std::sqrt(engine_->scales().sigma_squared);
    return true;
  }

  // After fit(); the engine then knows the last fold only.
  std::optional<calibration::HeldOutScore> held_out() {
    const auto rejected = std::make_unique<bool[]>(rows_.size());
    for (std::size_t k = 0; k < rows_.size(); ++k) rejected[k] = rows_[k].weight == 0;
    std::vector<calibration::RowScore> scores(rows_.size());
    std::vector<float> order(rows_.size());
    auto model = std::make_unique<calibration::ArmModel>(*start_);
    std::vector<calibration::ModelTarget> targets = start_targets_;
    const auto score = calibration::score_held_out(
        {*model, targets, rows_, cache_, matrix_, *work_, 0}, parts_, engine_->scales(),
        {rejected.get(), rows_.size()}, scores, order);
    return score ? std::optional(*score) : std::nullopt;
  }

  [[nodiscard]] Vector3 predict(const JointVector& readings,
                                calibration::Engine::Stated* stated = nullptr) const {
    calibration::ChainFrames frames;
    calibration::evaluate_chain(*model_, readings, targets_[0].link, frames);
    if (stated != nullptr) *stated = engine_->covariance_at(frames, 0, {1, 0, 0, 1, 0, 1});
    return frames.X_SL * targets_[0].p_L;
  }

  [[nodiscard]] const calibration::ArmModel& model() const { return *model_; }
  [[nodiscard]] const calibration::Engine& engine() const { return *engine_; }
  [[nodiscard]] const std::vector<calibration::FitRow>& rows() const { return rows_; }
  [[nodiscard]] const calibration::ModelTarget& target() const { return targets_[0]; }

 private:
  calibration::ModelParts parts_;
  std::vector<calibration::FitRow> rows_;
  std::vector<calibration::ChainFrames> cache_;
  std::vector<double> matrix_;
  std::vector<calibration::ModelTarget> targets_;
  std::vector<calibration::ModelTarget> start_targets_;
  std::unique_ptr<calibration::ArmModel> model_ = std::make_unique<calibration::ArmModel>();
  std::unique_ptr<calibration::ArmModel> start_ = std::make_unique<calibration::ArmModel>();
  std::unique_ptr<calibration::WorkspaceFor<kMaxJoints>> work_ =
      std::make_unique<calibration::WorkspaceFor<kMaxJoints>>();
  std::unique_ptr<calibration::Engine> engine_;
};

// The signature of an arm like `drawing`, from positions of one target on its last link.
inline bool calibrate(const Arm& drawing, const Log& log, calibration::Refined& refined) {
  Calibration calibration(drawing, log, {.gravity = false, .maps = false});
  return calibration.fit() && calibration.put_into(refined, drawing, log);
}

// What an arm does beside its geometry.
struct Misbehaviour {
  double wave_rad = 0;   // amplitude of each joint's reading error, some waves a turn
  double sag_rad_m = 0;  // of joint 2 and 3 by the tool's lever about them
  double phase = 0.3;
};

// Where the target of such an arm really is. The truth is independent of the code under test.
inline Vector3 misbehaving_point(const Cell& cell, const JointVector& readings,
                                 const Misbehaviour& m) {
  constexpr std::array<double, kMaxJoints> kWaves{3, 7, 12, 5, 9, 4, 6, 8};
  JointVector q = readings;
  for (std::size_t j = 0; j < q.size(); ++j) {
    q[j] += m.wave_rad * std::sin(kWaves[j] * readings[j] + m.phase + static_cast<double>(j));
  }
  const Vector3 tip = cell.frame(readings, q.size()).p;
  for (std::size_t j = 1; j < 3 && j < q.size(); ++j) {
    const Pose X_SJ = cell.frame(readings, j);
    const Vector3 down = -cell.X_SB.R.col(2);
    q[j] += m.sag_rad_m * X_SJ.R.col(2).dot((tip - X_SJ.p).cross(down));
  }
  return cell.point(q, 0);
}

}  // namespace armsig::test
