// SPDX-License-Identifier: MIT
// Base and targets of an arm of known drawing from the rows of all targets at once, wherever on the
// arm each one is. The sweep of a target on the last link alone says nothing of the axes before.
#pragma once

#include <optional>
#include <span>

#include "core/base/links.hpp"
#include "core/calibration/observation.hpp"
#include "core/calibration/readings.hpp"
#include "core/signature.hpp"

namespace armsig::calibration {

// The position rows of a log whose use is kFit, those of one target or of all, with the arm's
// frames in its base by the drawing. What it is given must outlive it.
class DrawnRows {
 public:
  DrawnRows(const Arm& arm, std::span<const Observation> log, std::span<const Target> targets,
            std::optional<std::size_t> only = {})
      : arm_(arm), log_(log), targets_(targets), only_(only) {}

  [[nodiscard]] DrawnRows of(std::size_t target) const {
    DrawnRows rows(arm_, log_, targets_, target);
    rows.X_BL_ = X_BL_;
    return rows;
  }

  // Keeps in `memory` the poses that for_each() visits, which are then found once. Precondition:
  // `memory` is as long as the log, and outlives this.
  void keep_poses(std::span<Pose> memory) {
    for_each([&](const Observation& row, const Pose& X_BL) {
      memory[static_cast<std::size_t>(&row - log_.data())] = X_BL;
    });
    X_BL_ = memory;
  }

  // visit(row, X_BF), Denavit-Hartenberg frames 0 ... n, for every `stride`-th row.
  template <typename Visit>
  void for_each_frames(Visit visit, std::size_t stride = 1) const {
    for_each_row(
        [&](const Observation& row) {
          visit(row, dh_frames(arm_.joints, effective_readings(arm_, row.readings)));
        },
        stride);
  }
  // visit(row, X_BL), with the pose of its target's link.
  template <typename Visit>
  void for_each(Visit visit, std::size_t stride = 1) const {
    if (!X_BL_.empty()) {
      for_each_row(
          [&](const Observation& row) {
            visit(row, X_BL_[static_cast<std::size_t>(&row - log_.data())]);
          },
          stride);
      return;
    }
    for_each_frames([&](const Observation& row,
                        const auto& X_BF) { visit(row, X_BF[targets_[row.target].link]); },
                    stride);
  }

 private:
  template <typename Visit>
  void for_each_row(Visit visit, std::size_t stride) const {
    std::size_t count = 0;
    for (const Observation& row : log_) {
      if (row.use != RowUse::kFit || row.kind != ObservationKind::kPosition) continue;
      if ((only_ && row.target != *only_) || count++ % stride != 0) continue;
      visit(row);
    }
  }

  const Arm& arm_;
  std::span<const Observation> log_;
  std::span<const Target> targets_;
  std::optional<std::size_t> only_;
  std::span<const Pose> X_BL_;  // kept, by the row's place in the log
};

// Where the base is, and every target in its link; zero where it was not observed.
struct BaseAndTargets {
  Pose X_SB;
  FixedVector<Vector3, kMaxTargets> p_LT;

  // Of a position row, its target's link at X_BL.
  [[nodiscard]] Vector3 residual(const Observation& row, const Pose& X_BL) const {
    return row.p_S - X_SB * (X_BL * p_LT[row.target]);
  }
};

// Robust scale of the residual lengths of all rows, per axis [m].
[[nodiscard]] double residual_scale(const DrawnRows& rows, const BaseAndTargets& at);

// The best of the minima that the 24 rotations of a cube lead to, by the plain sum of squares over
// some hundred rows. `targets` is how many there are. Precondition: at least one row.
[[nodiscard]] BaseAndTargets search_base_and_targets(const DrawnRows& rows, std::size_t targets);

// The nearest minimum over all rows, reweighted by Huber's weights until gross outliers have lost
// their say: Levenberg-Marquardt, the targets eliminated from the normal equations.
void polish_base_and_targets(const DrawnRows& rows, BaseAndTargets& at);

}  // namespace armsig::calibration
