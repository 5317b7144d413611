// SPDX-License-Identifier: MIT
#include "firmware/host_tool/taught_frames/taught_frames.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/taught_frames/tip_fit.hpp"

namespace armsig::tool {
namespace {

// Residuals with fewer degrees of freedom give no sigma.
constexpr std::size_t kLeastFreedom = 3;
// A sigma that is stated is doubted where the residuals are so many times larger.
constexpr double kTooLarge = 3;
// A touch is named where the others agree so many times better without it.
constexpr double kOneAlone = 6;
constexpr double kWorthNaming_m = 0.3e-3;
constexpr double kTurnToJudge = radians(10);  // of those that are left

TeachNoise teach_noise(const std::vector<SolvedFrame>& found, double stated_m,
                       std::vector<std::string>& warnings) {
  TeachNoise teach;
  double squares = 0;
  for (const SolvedFrame& frame : found) {
    squares += frame.residual_squares;
    teach.freedom += frame.freedom;
  }
  const double residual_m =
      teach.freedom > 0 ? std::sqrt(squares / static_cast<double>(teach.freedom)) : 0;
  if (stated_m > 0) {
    teach.source = TeachSource::kStated;
    teach.sigma_m = stated_m;
    if (teach.freedom >= kLeastFreedom && residual_m > kTooLarge * stated_m) {
      warnings.push_back(
          fmt::format("the points miss by {:.3f} mm, 1 sigma, where --teach-sigma-mm says {:.3f}",
                      1e3 * residual_m, 1e3 * stated_m));
    }
    return teach;
  }
  const bool enough = teach.freedom >= kLeastFreedom;
  teach.source = enough ? TeachSource::kResiduals : TeachSource::kAssumed;
  teach.sigma_m = enough ? residual_m : kAssumedTeach_m;
  return teach;
}

// What one point's position alone does to a frame, of all rows.
Eigen::Matrix<double, 6, 6> by_positions(const Eigen::MatrixXd& by_rows) {
  Eigen::Matrix<double, 6, 6> squares = Eigen::Matrix<double, 6, 6>::Zero();
  for (Eigen::Index k = 0; k < by_rows.cols(); k += 6) {
    squares += by_rows.middleCols<3>(k) * by_rows.middleCols<3>(k).transpose();
  }
  return squares;
}

double touch_noise_m(const std::vector<Pose>& X_CE) {
  const TipFit fit = fit_tip(X_CE);
  return std::sqrt(fit.residual_squares() / static_cast<double>(3 * X_CE.size() - 6));
}

// The touch without which those of a tool agree much better; four or more touches tell.
void name_outlier(const TaughtTask& task, const TaughtFrame& frame, const std::vector<Pose>& X_CE,
                  std::vector<std::string>& warnings) {
  std::vector<std::size_t> tips;
  for (const std::size_t k : frame.rows) {
    if (task.rows[k].point->axis < 0) tips.push_back(k);
  }
  if (frame.kind != TaughtFrameKind::kTool || tips.size() < 4) return;
  const auto poses_but = [&](std::size_t left_out) {
    std::vector<Pose> poses;
    for (const std::size_t k : tips) {
      if (k != left_out) poses.push_back(X_CE[k]);
    }
    return poses;
  };
  const double all_m = touch_noise_m(poses_but(task.rows.size()));
  if (all_m < kWorthNaming_m) return;
  for (const std::size_t k : tips) {
    const std::vector<Pose> others = poses_but(k);
    if (least_turned(others).angle_rad < kTurnToJudge || kOneAlone * touch_noise_m(others) > all_m)
      continue;
    const TipFit fit = fit_tip(others);
    warnings.push_back(fmt::format(
        "line {}: {:.2f} mm off the tip that the other touches of {} "
        "agree on; touch it again",
        task.rows[k].line, 1e3 * (X_CE[k] * fit.t_E - fit.tip_C).norm(), in_quotes(frame.name)));
  }
}

}  // namespace

Vector3 FoundFrame::origin_sigma_m() const {
  return covariance.topLeftCorner<3, 3>().diagonal().cwiseSqrt();
}

Vector3 FoundFrame::turn_sigma_rad() const {
  return covariance.bottomRightCorner<3, 3>().diagonal().cwiseSqrt();
}

Read<TaughtFrames> taught_frames(const TaughtTask& task, const TaughtPoses& poses,
                                 const PoseDerivatives* derivatives, double teach_sigma_m) {
  ARMSIG_TRY(found, solved_frames(task, poses.found_X_CE));
  ARMSIG_TRY(nominal, solved_frames(task, poses.nominal_X_CE));
  TaughtFrames result;
  result.teach = teach_noise(found, teach_sigma_m, result.warnings);
  result.signature_counts = derivatives != nullptr;
  double square_m2 = result.teach.sigma_m * result.teach.sigma_m;
  // The residuals have it in them.
  if (derivatives != nullptr && result.teach.source != TeachSource::kResiduals) {
    square_m2 += derivatives->unexplained_m * derivatives->unexplained_m;
  }
  for (std::size_t f = 0; f < found.size(); ++f) {
    name_outlier(task, task.frames[f], poses.found_X_CE, result.warnings);
    FoundFrame frame;
    frame.found = std::move(found[f]);
    frame.nominal = std::move(nominal[f]);
    frame.covariance = square_m2 * by_positions(frame.found.by_rows);
    if (derivatives != nullptr) {
      Eigen::Matrix<double, 6, 3> by_tip = frame.found.by_tip;
      if (task.tip.frame) by_tip.setZero();  // the rows have what the tip does
      frame.covariance += derivatives->covariance_of(frame.found.by_rows, by_tip);
    }
    frame.apart_m = (frame.nominal.X.p - frame.found.X.p).norm();
    frame.turned_rad = angle_between(frame.nominal.X.R, frame.found.X.R);
    result.frames.push_back(std::move(frame));
  }
  return result;
}

}  // namespace armsig::tool
