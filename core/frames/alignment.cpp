// SPDX-License-Identifier: MIT
#include "core/frames/alignment.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/SVD>

namespace armsig::frames {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// Cost, and on request its Gauss-Newton equations in (turn about `pivot` times size, translation),
// so that all six unknowns are lengths.
struct Equations {
  double cost_m2 = 0;
  Matrix6 hessian = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
};

bool is_revolute(const AxisLine& line) { return line.type == JointType::kRevolute; }

Vector3 mean_point(const AxisLines& lines) {
  Vector3 sum = Vector3::Zero();
  double count = 0;
  for (const AxisLine& line : lines) {
    if (!is_revolute(line)) continue;
    sum += line.point;
    count += 1;
  }
  return count > 0 ? Vector3(sum / count) : sum;
}

Equations equations(const AxisLines& lines_A, const AxisLines& lines_B, const Pose& X_AB,
                    const Vector3& pivot_A, double size_m) {
  Equations sums;
  const auto add = [&sums](const Eigen::Matrix<double, 3, 6>& jacobian, const Vector3& residual) {
    sums.cost_m2 += residual.squaredNorm();
    sums.hessian += jacobian.transpose() * jacobian;
    sums.gradient += jacobian.transpose() * residual;
  };
  for (std::size_t i = 0; i < lines_A.size(); ++i) {
    const Vector3 direction_A = X_AB.R * lines_B[i].direction;
    Eigen::Matrix<double, 3, 6> jacobian;
    jacobian << -cross_matrix(direction_A), Matrix3::Zero();
    add(jacobian, size_m * (direction_A - lines_A[i].direction));
    if (!is_revolute(lines_A[i])) continue;
    const Vector3 point_A = X_AB * lines_B[i].point;
    const Matrix3 across =
        Matrix3::Identity() - lines_A[i].direction * lines_A[i].direction.transpose();
    jacobian << across * -cross_matrix((point_A - pivot_A) / size_m), across;
    add(jacobian, across * (point_A - lines_A[i].point));
  }
  return sums;
}

// X_AB after a turn about the pivot and a translation, both in A.
Pose moved(const Pose& X_AB, const Vector3& pivot_A, const Vector3& turn_rad,
           const Vector3& translation) {
  const double angle_rad = turn_rad.norm();
  const Matrix3 turn = angle_rad > 0 ? rotation_about(turn_rad / angle_rad, angle_rad)
                                     : Matrix3(Matrix3::Identity());
  // By way of the quaternion, which keeps the product of many turns a rotation.
  const Matrix3 R = Eigen::Quaterniond(turn * X_AB.R).normalized().toRotationMatrix();
  return {R, pivot_A + turn * (X_AB.p - pivot_A) + translation};
}

struct Descent {
  Pose X_AB;
  double cost_m2 = 0;
};

Descent descend(const AxisLines& lines_A, const AxisLines& lines_B, const Pose& start) {
  constexpr int kMaxSteps = 30;
  constexpr int kMaxHalvings = 8;
  constexpr double kDeterminedFraction = 1e-4;  // the square of one part in a hundred
  constexpr double kNegligibleStep = 1e-13;     // of the size of the arm
  constexpr double kNoWorse = 1.0 + 1e-12;      // a cost that differs by rounding is no worse
  const double size_m = arm_size(lines_A);
  const Vector3 mean_B = mean_point(lines_B);
  Descent best{start, 0};
  for (int step_count = 0; step_count < kMaxSteps; ++step_count) {
    const Vector3 pivot_A = best.X_AB * mean_B;
    const Equations here = equations(lines_A, lines_B, best.X_AB, pivot_A, size_m);
    best.cost_m2 = here.cost_m2;
    Eigen::JacobiSVD<Matrix6> svd(here.hessian, Eigen::ComputeFullU | Eigen::ComputeFullV);
    svd.setThreshold(kDeterminedFraction);
    Vector6 step = svd.solve(Vector6(-here.gradient));
    bool improved = false;
    for (int halving = 0; halving < kMaxHalvings && !improved; ++halving, step *= 0.5) {
      const Pose X_AB = moved(best.X_AB, pivot_A, step.head<3>() / size_m, step.tail<3>());
      const double cost_m2 = equations(lines_A, lines_B, X_AB, pivot_A, size_m).cost_m2;
      if (cost_m2 > here.cost_m2 * kNoWorse) continue;
      improved = true;
      best = {X_AB, cost_m2};
    }
    if (!improved || step.norm() < kNegligibleStep * size_m) break;
  }
  return best;
}

}  // namespace

double Alignment::worst_angle_rad() const {
  double worst = 0;
  for (const Misalignment& joint : joints) worst = std::max(worst, joint.angle_rad);
  return worst;
}

double Alignment::worst_distance_m() const {
  double worst = 0;
  for (const Misalignment& joint : joints) worst = std::max(worst, joint.distance_m);
  return worst;
}

Alignment align(const AxisLines& lines_A, const AxisLines& lines_B) {
  ARMSIG_CHECK(!lines_A.empty() && lines_A.size() == lines_B.size());
  constexpr int kStarts = 24;
  constexpr double kClearlyBetter = 1e-6;  // of the size squared: two starts that found one minimum
  const double equal_cost_m2 = kClearlyBetter * arm_size(lines_A) * arm_size(lines_A);
  Descent best;
  for (int i = 0; i < kStarts; ++i) {
    // z to one of six sides of a cube, then a quarter turn about it.
    const int side = i / 4;
    const Matrix3 tilt = side < 4
                             ? rotation_x(side * kPi / 2)
                             : rotation_about(Vector3::UnitY(), (side == 4 ? 1 : -1) * kPi / 2);
    const Matrix3 R_AB = tilt * rotation_z((i % 4) * kPi / 2);
    const Pose start{R_AB, mean_point(lines_A) - R_AB * mean_point(lines_B)};
    const Descent found = descend(lines_A, lines_B, start);
    if (i == 0 || found.cost_m2 < best.cost_m2 - equal_cost_m2) best = found;
  }

  Alignment alignment{best.X_AB, {}, best.cost_m2};
  for (std::size_t i = 0; i < lines_A.size(); ++i) {
    const Vector3 direction_A = best.X_AB.R * lines_B[i].direction;
    Misalignment left;
    left.angle_rad = std::atan2(direction_A.cross(lines_A[i].direction).norm(),
                                direction_A.dot(lines_A[i].direction));
    if (is_revolute(lines_A[i])) {
      const Vector3 apart = best.X_AB * lines_B[i].point - lines_A[i].point;
      left.distance_m = lines_A[i].direction.cross(apart).norm();
    }
    alignment.joints.push_back(left);
  }
  return alignment;
}

}  // namespace armsig::frames
