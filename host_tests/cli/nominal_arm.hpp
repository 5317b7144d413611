// SPDX-License-Identifier: MIT
// How well an arm as drawn fits rows, with the best base and target there are: what any model that
// is written must predict better. It shares no code with the fit but the product of the chain.
#pragma once

#include <vector>

#include <Eigen/Dense>

#include "core/base/links.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "host_tests/cli/files.hpp"

namespace armsig::cli {

struct DrawnRow {
  Pose X_BF;  // flange
  Vector3 p_S;
};

inline std::vector<DrawnRow> drawn_rows(const Arm& arm, const Csv& csv) {
  std::vector<DrawnRow> rows;
  for (std::size_t k = 0; k < csv.rows.size(); ++k) {
    JointVector q;
    for (std::size_t j = 1; j <= arm.joints.size(); ++j) {
      q.push_back(radians(csv.number(k, "q" + std::to_string(j) + "_deg")));
    }
    const Vector3 p_mm(csv.number(k, "x_mm"), csv.number(k, "y_mm"), csv.number(k, "z_mm"));
    rows.push_back({dh_frames(arm.joints, q).back(), 1e-3 * p_mm});
  }
  return rows;
}

// Base by Procrustes, target by the mean, in turn.
inline double nominal_mean_m(const std::string& known_arm, const Csv& csv) {
  const auto arm = tool::read_arm(known_arm);
  if (!arm) return 0;
  const std::vector<DrawnRow> rows = drawn_rows(arm->arm, csv);
  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::Matrix3Xd drawn(3, count);
  Eigen::Matrix3Xd measured(3, count);
  Vector3 target = Vector3::Zero();
  double mean_m = 0;
  for (int turn = 0; turn < 300; ++turn) {
    for (Eigen::Index k = 0; k < count; ++k) {
      drawn.col(k) = rows[static_cast<std::size_t>(k)].X_BF * target;
      measured.col(k) = rows[static_cast<std::size_t>(k)].p_S;
    }
    const Eigen::Matrix4d X_SB = Eigen::umeyama(drawn, measured, false);
    const Matrix3 R = X_SB.topLeftCorner<3, 3>();
    const Eigen::Matrix3Xd left = measured - ((R * drawn).colwise() + X_SB.topRightCorner<3, 1>());
    mean_m = left.colwise().norm().mean();
    Vector3 step = Vector3::Zero();
    for (Eigen::Index k = 0; k < count; ++k) {
      step += (R * rows[static_cast<std::size_t>(k)].X_BF.R).transpose() * left.col(k);
    }
    target += step / static_cast<double>(count);
  }
  return mean_m;
}

}  // namespace armsig::cli
