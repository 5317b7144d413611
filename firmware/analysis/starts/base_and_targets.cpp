// SPDX-License-Identifier: MIT
#include "firmware/analysis/starts/base_and_targets.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "core/base/check.hpp"
#include "core/numerics/robust.hpp"
#include "core/numerics/rotations.hpp"
#include "firmware/analysis/starts/cube_rotations.hpp"

namespace armsig::calibration {

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix63 = Eigen::Matrix<double, 6, 3>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr std::size_t kSearchRows = 150;
constexpr double kUnweighted = std::numeric_limits<double>::infinity();
constexpr int kSearchSteps = 12;
constexpr int kPolishPasses = 12;
constexpr int kStepsOfAPass = 3;
constexpr int kMostTries = 8;
constexpr double kFirstDamping = 1e-4;
constexpr double kLeastGain = 1e-12;

// Normal equations of base (turn about `centre`, shift) and targets. Rotations keep lengths, so
// that the block of a target is its weight times the identity.
struct NormalEquations {
  double cost = 0;  // Huber's, of all rows
  Vector3 centre = Vector3::Zero();
  Matrix6 H_bb = Matrix6::Zero();
  Vector6 g_b = Vector6::Zero();
  std::array<Matrix63, kMaxTargets> H_bt;
  std::array<Vector3, kMaxTargets> g_t;
  std::array<double, kMaxTargets> weight{};
};

// Rows that are gone through many times, with the poses of their targets' links.
class SearchRows {
 public:
  void add(const Observation& row, const Pose& X_BL) { rows_.push_back({&row, X_BL}); }

  template <typename Visit>
  void for_each(Visit visit) const {
    for (const Placed& placed : rows_) visit(*placed.row, placed.X_BL);
  }

 private:
  struct Placed {
    const Observation* row = nullptr;
    Pose X_BL;
  };
  FixedVector<Placed, kSearchRows> rows_;
};

// At `at`; weights are about `scale_m` (infinite: all weigh one).
template <typename Rows>
NormalEquations assemble(const Rows& rows, double scale_m, const BaseAndTargets& at) {
  NormalEquations normal;
  normal.H_bt.fill(Matrix63::Zero());
  normal.g_t.fill(Vector3::Zero());
  normal.centre = at.X_SB.p;
  rows.for_each([&](const Observation& row, const Pose& X_BL) {
    const Vector3 x = at.X_SB * (X_BL * at.p_LT[row.target]);
    const Vector3 residual = row.p_S - x;
    const double length = residual.norm();
    const double w = numerics::huber_weight(length, scale_m);
    Eigen::Matrix<double, 3, 6> J_b;
    J_b << -cross_matrix(x - normal.centre), Matrix3::Identity();
    const Matrix3 J_t = at.X_SB.R * X_BL.R;
    normal.cost += numerics::huber_loss(length, scale_m);
    normal.H_bb += w * J_b.transpose() * J_b;
    normal.g_b += w * J_b.transpose() * residual;
    normal.H_bt[row.target] += w * J_b.transpose() * J_t;
    normal.g_t[row.target] += w * J_t.transpose() * residual;
    normal.weight[row.target] += w;
  });
  return normal;
}

BaseAndTargets moved(const NormalEquations& normal, double damping, const BaseAndTargets& from) {
  Matrix6 S = normal.H_bb;
  S.diagonal() *= 1 + damping;
  S.diagonal().array() += 1e-12 * S.trace();
  Vector6 g = normal.g_b;
  for (std::size_t t = 0; t < from.p_LT.size(); ++t) {
    if (normal.weight[t] == 0) continue;
    const double h = normal.weight[t] * (1 + damping);
    S -= normal.H_bt[t] * normal.H_bt[t].transpose() / h;
    g -= normal.H_bt[t] * normal.g_t[t] / h;
  }
  const Vector6 base = S.ldlt().solve(g);
  BaseAndTargets to = from;
  to.X_SB.R = numerics::rotation_by(base.head<3>()) * from.X_SB.R;
  to.X_SB.p += base.tail<3>();
  for (std::size_t t = 0; t < from.p_LT.size(); ++t) {
    if (normal.weight[t] == 0) continue;
    const double h = normal.weight[t] * (1 + damping);
    to.p_LT[t] += (normal.g_t[t] - normal.H_bt[t].transpose() * base) / h;
  }
  return to;
}

struct Descent {
  double cost = 0;
  bool gained = false;  // more than kLeastGain of the cost
};

// At most `steps` steps that lower the cost, until one changes it by no more than kLeastGain of it.
template <typename Rows>
Descent descend(const Rows& rows, double scale_m, int steps, BaseAndTargets& at) {
  double damping = kFirstDamping;
  NormalEquations present = assemble(rows, scale_m, at);
  bool gained = false;
  for (int step = 0; step < steps; ++step) {
    bool lower = false;
    bool settled = false;
    for (int tries = 0; tries < kMostTries && !lower && !settled; ++tries) {
      const BaseAndTargets candidate = moved(present, damping, at);
      const NormalEquations there = assemble(rows, scale_m, candidate);
      lower = there.cost < present.cost;
      settled = std::abs(present.cost - there.cost) <= kLeastGain * present.cost;
      damping *= lower ? 0.2 : 10;
      if (!lower) continue;
      at = candidate;
      present = there;
    }
    if (!lower || settled) break;
    gained = true;
  }
  return {.cost = present.cost, .gained = gained};
}

}  // namespace

double residual_scale(const DrawnRows& rows, const BaseAndTargets& at) {
  numerics::LogHistogram squares;
  rows.for_each([&](const Observation& row, const Pose& X_BL) {
    squares.add(at.residual(row, X_BL).squaredNorm());
  });
  return numerics::robust_scale_m(squares);
}

BaseAndTargets search_base_and_targets(const DrawnRows& rows, std::size_t targets) {
  Vector3 sum_S = Vector3::Zero();
  Vector3 sum_B = Vector3::Zero();
  std::size_t count = 0;
  rows.for_each([&](const Observation& row, const Pose& X_BL) {
    sum_S += row.p_S;
    sum_B += X_BL.p;
    ++count;
  });
  ARMSIG_CHECK(count > 0);
  const auto n = static_cast<double>(count);
  SearchRows some;
  rows.for_each([&](const Observation& row, const Pose& X_BL) { some.add(row, X_BL); },
                count / kSearchRows + 1);
  BaseAndTargets best;
  double least = std::numeric_limits<double>::infinity();
  for_each_cube_rotation([&](const Matrix3& R) {
    BaseAndTargets candidate{{R, sum_S / n - R * (sum_B / n)}, {}};
    candidate.p_LT.resize(targets, Vector3::Zero());
    const double squares = descend(some, kUnweighted, kSearchSteps, candidate).cost;
    if (!(squares < least)) return;
    least = squares;
    best = candidate;
  });
  return best;
}

void polish_base_and_targets(const DrawnRows& rows, BaseAndTargets& at) {
  for (int pass = 0; pass < kPolishPasses; ++pass) {
    const double scale_m = residual_scale(rows, at);
    if (!descend(rows, scale_m, kStepsOfAPass, at).gained) break;
  }
}

}  // namespace armsig::calibration
