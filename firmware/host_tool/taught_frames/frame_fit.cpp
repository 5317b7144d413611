// SPDX-License-Identifier: MIT
#include "firmware/host_tool/taught_frames/frame_fit.hpp"

#include <Eigen/QR>

#include "core/numerics/rotations.hpp"

namespace armsig::tool {
namespace {

constexpr int kMostFrameSteps = 50;
constexpr double kSmallStep = 1e-13;  // m and rad, of a step
// Of the pivots of lengths in metres and turns; beyond it a direction is not determined.
constexpr double kRank = 1e-6;

// The coordinates that should be zero, and their derivatives by the frame: its origin along the
// axes of A, its turn about its own.
struct FrameEquations {
  Eigen::VectorXd residual;
  Eigen::MatrixXd by_frame;  // 6 columns
  Eigen::MatrixXd by_points;
};

std::size_t equation_count(const std::vector<FramePoint>& points) {
  std::size_t count = 0;
  for (const FramePoint& point : points) {
    for (const bool zero : point.zero) count += zero ? 1U : 0U;
  }
  return count;
}

FrameEquations equations(const std::vector<FramePoint>& points, const Pose& X_AW) {
  const auto count = static_cast<Eigen::Index>(equation_count(points));
  const auto columns = static_cast<Eigen::Index>(3 * points.size());
  FrameEquations of{Eigen::VectorXd(count), Eigen::MatrixXd(count, 6),
                    Eigen::MatrixXd::Zero(count, columns)};
  const Matrix3 R_WA = X_AW.R.transpose();
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vector3 p_W = R_WA * (points[k].p_A - X_AW.p);
    const Matrix3 by_turn = cross_matrix(p_W);
    for (Eigen::Index c = 0; c < 3; ++c) {
      if (!points[k].zero[static_cast<std::size_t>(c)]) continue;
      of.residual[row] = p_W[c];
      of.by_frame.row(row) << -R_WA.row(c), by_turn.row(c);
      of.by_points.block<1, 3>(row, static_cast<Eigen::Index>(3 * k)) = R_WA.row(c);
      ++row;
    }
  }
  return of;
}

// The unknowns alone: those of the turn where the origin is known.
auto unknown_columns(const FrameEquations& of, FrameOrigin origin) {
  return of.by_frame.rightCols(origin == FrameOrigin::kKnown ? 3 : 6);
}

Pose frame_moved_by(const Pose& X_AW, const Eigen::VectorXd& step) {
  Pose X = X_AW;
  if (step.size() == 6) X.p += step.head<3>();
  X.R = X.R * numerics::rotation_by(step.tail<3>());
  return X;
}

}  // namespace

double FrameFit::residual_squares() const {
  double squares = 0;
  for (const Vector3& residual : residuals_W) squares += residual.squaredNorm();
  return squares;
}

std::optional<FrameFit> fit_frame(const std::vector<FramePoint>& points, const Pose& X_start,
                                  FrameOrigin origin) {
  const std::size_t unknowns = origin == FrameOrigin::kKnown ? 3 : 6;
  const std::size_t count = equation_count(points);
  if (count < unknowns) return std::nullopt;
  FrameFit fit{.X_AW = X_start, .residuals_W = {}, .freedom = count - unknowns, .by_points = {}};
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver;
  solver.setThreshold(kRank);
  FrameEquations of = equations(points, fit.X_AW);
  for (int round = 0; round < kMostFrameSteps; ++round) {
    solver.compute(unknown_columns(of, origin));
    if (solver.rank() < static_cast<Eigen::Index>(unknowns)) return std::nullopt;
    const Eigen::VectorXd step = solver.solve(-of.residual);
    if (!step.allFinite()) return std::nullopt;
    fit.X_AW = frame_moved_by(fit.X_AW, step);
    of = equations(points, fit.X_AW);
    if (step.norm() < kSmallStep) break;
  }
  solver.compute(unknown_columns(of, origin));
  fit.by_points = Eigen::MatrixXd::Zero(6, of.by_points.cols());
  fit.by_points.bottomRows(static_cast<Eigen::Index>(unknowns)) = solver.solve(-of.by_points);
  for (const FramePoint& point : points) {
    const Vector3 p_W = fit.X_AW.inverse() * point.p_A;
    fit.residuals_W.emplace_back(point.zero[0] ? p_W.x() : 0, point.zero[1] ? p_W.y() : 0,
                                 point.zero[2] ? p_W.z() : 0);
  }
  return fit;
}

Pose frame_along(const Vector3& o_A, int main, const Vector3& along_A, int second,
                 const Vector3& beside_A) {
  Pose X_AW{Matrix3::Zero(), o_A};
  const Vector3 a = along_A.normalized();
  const Vector3 b = (beside_A - a * a.dot(beside_A)).normalized();
  X_AW.R.col(main) = a;
  X_AW.R.col(second) = b;
  const bool forward = (main + 1) % 3 == second;
  X_AW.R.col(3 - main - second) = forward ? a.cross(b) : b.cross(a);
  return X_AW;
}

}  // namespace armsig::tool
