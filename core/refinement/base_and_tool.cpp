// SPDX-License-Identifier: MIT
#include "core/refinement/base_and_tool.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/refinement/robust.hpp"
#include "core/refinement/row.hpp"

namespace armsig::refinement {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector12 = Eigen::Matrix<double, 12, 1>;

constexpr int kStarts = 64;
constexpr int kMaxSteps = 60;
constexpr int kRobustPasses = 12;
constexpr std::size_t kFewestRows = 4;
// Mean square about the mean below which nothing moved: rounding, in metres or unit vectors.
constexpr double kAtRest = 1e-20;

// Weighted moments of one target's rows about their means.
struct Moments {
  double weight = 0;
  Vector3 mean_p = Vector3::Zero();
  Vector12 mean_g = Vector12::Zero();
  double pp = 0;
  Eigen::Matrix<double, 3, 12> pg = Eigen::Matrix<double, 3, 12>::Zero();
  Eigen::Matrix<double, 12, 12> gg = Eigen::Matrix<double, 12, 12>::Zero();

  // Incremental (Welford), so that a base metres away costs no digits.
  void add(const Vector3& p, const Vector12& g, double w) {
    if (w <= 0) return;
    weight += w;
    const Vector3 dp = p - mean_p;
    const Vector12 dg = g - mean_g;
    mean_p += w / weight * dp;
    mean_g += w / weight * dg;
    const double left = w * (1 - w / weight);
    pp += left * dp.squaredNorm();
    pg.noalias() += left * dp.lazyProduct(dg.transpose());
    gg.noalias() += left * dg.lazyProduct(dg.transpose());
  }
};

// Y with y_k = Y(u) g_k = t_k + R_k u.
Eigen::Matrix<double, 3, 12> combination(const Vector3& u) {
  Eigen::Matrix<double, 3, 12> Y;
  Y << Matrix3::Identity(), u.x() * Matrix3::Identity(), u.y() * Matrix3::Identity(),
      u.z() * Matrix3::Identity();
  return Y;
}

struct Candidate {
  Matrix3 R = Matrix3::Identity();
  Vector3 u = Vector3::Zero();
  double squares = 0;
};

// Sum of squares, its gradient (halved) and Gauss-Newton matrix by (rotation vector in S, u).
struct Local {
  double squares = 0;
  Vector6 gradient;
  Matrix6 hessian;
};

double squares_at(const Moments& m, const Matrix3& R, const Vector3& u) {
  const Eigen::Matrix<double, 3, 12> Y = combination(u);
  const Matrix3 yy = Y * m.gg * Y.transpose();
  const Matrix3 py = m.pg * Y.transpose();
  return m.pp + yy.trace() - 2 * (R.transpose() * py).trace();
}

Local local_at(const Moments& m, const Matrix3& R, const Vector3& u) {
  const Eigen::Matrix<double, 3, 12> Y = combination(u);
  const Eigen::Matrix<double, 3, 12> yg = Y * m.gg;
  const Matrix3 yy = yg * Y.transpose();
  const Matrix3 py = m.pg * Y.transpose();
  Local local;
  local.squares = m.pp + yy.trace() - 2 * (R.transpose() * py).trace();
  // e = p - R y; de = -w x (R y) - R R_k du.
  const Matrix3 S = R * yy * R.transpose();
  local.hessian.topLeftCorner<3, 3>() = S.trace() * Matrix3::Identity() - S;
  const Matrix3 C = R * py.transpose();  // sum of (R y) p^T
  local.gradient.head<3>() << -(C(1, 2) - C(2, 1)), -(C(2, 0) - C(0, 2)), -(C(0, 1) - C(1, 0));
  for (int j = 0; j < 3; ++j) {
    const Matrix3 yj = yg.middleCols<3>(3 + 3 * j);  // sum of y (R_k e_j)^T
    const Vector3 cross(yj(1, 2) - yj(2, 1), yj(2, 0) - yj(0, 2), yj(0, 1) - yj(1, 0));
    local.hessian.block<3, 1>(0, 3 + j) = R * cross;
    local.hessian.block<1, 3>(3 + j, 0) = (R * cross).transpose();
    for (int i = 0; i < 3; ++i) {
      local.hessian(3 + i, 3 + j) = m.gg.block<3, 3>(3 + 3 * i, 3 + 3 * j).trace();
    }
    local.gradient[3 + j] = yj.trace() - (R.transpose() * m.pg.middleCols<3>(3 + 3 * j)).trace();
  }
  return local;
}

// The best u for a given rotation; directions of u that the poses hardly show stay short.
Vector3 tool_for(const Moments& m, const Matrix3& R) {
  const Local local = local_at(m, R, Vector3::Zero());
  Matrix3 H = local.hessian.bottomRightCorner<3, 3>();
  H.diagonal().array() += 1e-6 * m.weight;
  const Vector3 g = local.gradient.tail<3>();
  return -(H.inverse() * g);
}

void polish(const Moments& m, Candidate& candidate) {
  double damping = 1e-3;
  candidate.squares = squares_at(m, candidate.R, candidate.u);
  for (int i = 0; i < kMaxSteps; ++i) {
    const Local local = local_at(m, candidate.R, candidate.u);
    Matrix6 H = local.hessian;
    for (int k = 0; k < 6; ++k) H(k, k) += damping * H(k, k) + 1e-9 * m.weight;
    const Vector6 x = -H.ldlt().solve(local.gradient);
    const double angle = x.head<3>().norm();
    Candidate next = candidate;
    if (angle > 0) {
      const Vector3 axis = x.head<3>() / angle;
      next.R = rotation_about(axis, angle) * candidate.R;
    }
    next.u += x.tail<3>();
    next.squares = squares_at(m, next.R, next.u);
    if (next.squares < candidate.squares) {
      candidate = next;
      damping = std::max(0.1 * damping, 1e-12);
      if (x.norm() < 1e-10) break;
    } else {
      damping *= 10;
      if (damping > 1e6) break;
    }
  }
}

// Rotations spread evenly over SO(3): the super-Fibonacci spiral (Alexa, CVPR 2022).
Matrix3 spread_rotation(int k) {
  constexpr double kPsi = 1.533751168755204288118041;
  const double s = k + 0.5;
  const double share = s / kStarts;
  const double alpha = 2 * kPi * s / std::sqrt(2.0);
  const double beta = 2 * kPi * s / kPsi;
  const double r = std::sqrt(share);
  const double t = std::sqrt(1 - share);
  return Eigen::Quaterniond(r * std::sin(alpha), r * std::cos(alpha), t * std::sin(beta),
                            t * std::cos(beta))
      .toRotationMatrix();
}

Candidate search(const Moments& m) {
  Candidate best;
  for (int k = 0; k < kStarts; ++k) {
    Candidate candidate;
    candidate.R = spread_rotation(k);
    candidate.u = tool_for(m, candidate.R);
    polish(m, candidate);
    if (k == 0 || candidate.squares < best.squares) best = candidate;
  }
  return best;
}

// The log as the fit wants it: rows of one target, each with the target's link by the drawing.
class Rows {
 public:
  Rows(const Arm& arm, std::span<const Observation> log, std::span<const Target> targets)
      : arm_(arm), log_(log), targets_(targets), readings_{arm.couplings, {}} {}

  template <typename Visit>
  void for_each(std::size_t target, Visit visit) const {
    for (const Observation& row : log_) {
      if (row.use != RowUse::kFit || row.kind != ObservationKind::kPosition || row.target != target) continue;
      const JointVector coupled = coupled_readings(readings_, row.readings);
      visit(row, drawn_frames(arm_, coupled)[targets_[target].link]);
    }
  }

 private:
  const Arm& arm_;
  std::span<const Observation> log_;
  std::span<const Target> targets_;
  ReadingModel readings_;
};

Vector12 link_vector(const Pose& X_BL) {
  Vector12 g;
  g << X_BL.p, X_BL.R.col(0), X_BL.R.col(1), X_BL.R.col(2);
  return g;
}

double huber(double residual, double scale) {
  return residual <= 2 * scale ? 1 : 2 * scale / residual;
}

// Robust scale of the residual lengths, per axis.
double residual_scale(const Rows& rows, std::size_t target, const Pose& X_SB, const Vector3& u) {
  LogHistogram squares;
  rows.for_each(target, [&](const Observation& row, const Pose& X_BL) {
    squares.add((row.p_S - X_SB * (X_BL * u)).squaredNorm());
  });
  return std::sqrt(squares.median() / kMedianChiSquare3);
}

// A further target, once the base is known: the mean of where its rows put it, robustly.
Vector3 place_target(const Rows& rows, std::size_t target, const Pose& X_SB) {
  Vector3 u = Vector3::Zero();
  const Pose X_BS = X_SB.inverse();
  for (int pass = 0; pass < kRobustPasses; ++pass) {
    const double scale = residual_scale(rows, target, X_SB, u);
    double weight = 0;
    Vector3 sum = Vector3::Zero();
    rows.for_each(target, [&](const Observation& row, const Pose& X_BL) {
      const Vector3 seen = X_BL.inverse() * (X_BS * row.p_S);
      const double w = pass == 0 ? 1 : huber((seen - u).norm(), scale);
      weight += w;
      sum += w * seen;
    });
    if (weight > 0) u = sum / weight;
  }
  return u;
}

}  // namespace

FixedVector<Pose, kMaxFrames> drawn_frames(const Arm& arm, const JointVector& coupled) {
  FixedVector<Pose, kMaxFrames> X_BL;
  X_BL.push_back({});
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const DhJoint& joint = arm.joints[i];
    const bool revolute = joint.type == JointType::kRevolute;
    const Matrix3 R_z = rotation_z(joint.theta_rad + (revolute ? coupled[i] : 0));
    const Vector3 p(joint.a_m, 0, joint.d_m + (revolute ? 0 : coupled[i]));
    X_BL.push_back(X_BL.back() * Pose{R_z * rotation_x(joint.alpha_rad), R_z * p});
  }
  return X_BL;
}

Judged<BaseAndTool> fit_base_and_tool(const Arm& arm, std::span<const Observation> log,
                                      std::span<const Target> targets) {
  ARMSIG_CHECK(targets.size() <= kMaxTargets);
  std::array<std::size_t, kMaxTargets> rows_of{};
  for (std::size_t k = 0; k < log.size(); ++k) {
    const Observation& row = log[k];
    if (row.use != RowUse::kFit || row.kind != ObservationKind::kPosition) continue;
    ARMSIG_CHECK(row.target < targets.size() && row.readings.size() == arm.joints.size());
    if (!is_finite(row)) {
      return std::unexpected(Refusal{Error::kNotFinite, static_cast<double>(k), 0});
    }
    ++rows_of[row.target];
  }
  std::size_t main = 0;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    if (targets[t].link != arm.joints.size()) continue;
    if (targets[main].link != arm.joints.size() || rows_of[t] > rows_of[main]) main = t;
  }
  if (targets[main].link != arm.joints.size()) rows_of[main] = 0;
  if (rows_of[main] < kFewestRows) {
    return std::unexpected(Refusal{Error::kTooFewPoints, static_cast<double>(rows_of[main]),
                                   static_cast<double>(kFewestRows)});
  }

  const Rows rows(arm, log, targets);
  BaseAndTool found;
  Candidate best;
  double scale = 0;
  for (int pass = 0; pass < kRobustPasses; ++pass) {
    Moments moments;
    rows.for_each(main, [&](const Observation& row, const Pose& X_BL) {
      const double residual = (row.p_S - found.X_SB * (X_BL * best.u)).norm();
      moments.add(row.p_S, link_vector(X_BL), pass == 0 ? 1 : huber(residual, scale));
    });
    if (moments.gg.trace() <= kAtRest * moments.weight) return std::unexpected(Refusal{Error::kJointDidNotMove, 0, 0});
    if (moments.pp <= kAtRest * moments.weight) return std::unexpected(Refusal{Error::kCoincidentPoints, 0, 0});
    // Outliers may have hidden the true basin from the first search.
    if (pass == 0 || pass == kRobustPasses / 2) {
      best = search(moments);
    } else {
      polish(moments, best);
    }
    const Vector3 mean_y = combination(best.u) * moments.mean_g;
    found.X_SB = {best.R, moments.mean_p - best.R * mean_y};
    scale = residual_scale(rows, main, found.X_SB, best.u);
  }
  found.p_LT.resize(targets.size(), Vector3::Zero());
  double weight = 0;
  double squares = 0;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    if (rows_of[t] == 0) continue;
    found.p_LT[t] = t == main ? best.u : place_target(rows, t, found.X_SB);
    rows.for_each(t, [&](const Observation& row, const Pose& X_BL) {
      const double residual = (row.p_S - found.X_SB * (X_BL * found.p_LT[t])).norm();
      if (huber(residual, scale) < 0.5) return;
      weight += 1;
      squares += residual * residual;
    });
  }
  found.rms_m = weight > 0 ? std::sqrt(squares / weight) : 0;
  if (!found.X_SB.p.allFinite() || !best.u.allFinite()) {
    return std::unexpected(Refusal{Error::kNotConverged, found.rms_m, 0});
  }
  return found;
}

}  // namespace armsig::refinement
