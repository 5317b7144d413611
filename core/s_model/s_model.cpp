// SPDX-License-Identifier: MIT
#include "core/s_model/s_model.hpp"

#include <cmath>

namespace armsig::s_model {
namespace {

// Below this the sign of a drawing's alpha says nothing about the sign of the real one.
constexpr double kDrawnParallelSine = 1e-3;

bool asks_for_alpha(Branch branch) {
  return branch == Branch::kPositiveAlpha || branch == Branch::kNegativeAlpha;
}

bool asks_for_negative(Branch branch) {
  return branch == Branch::kNegativeAlpha || branch == Branch::kNegativeA;
}

// Rot(z, beta), alpha = 0 or pi and Rot(z, gamma) share one degree of freedom: beta is laid along
// the common normal.
Parameters from_parallel_axes(const Pose& B, Branch branch) {
  Parameters s;
  const bool antiparallel = B.R(2, 2) < 0;
  s.alpha_rad = antiparallel ? kPi : 0.0;
  s.d_m = B.p.z();
  const double distance_m = std::hypot(B.p.x(), B.p.y());
  if (distance_m >= kCoaxialMetres) {
    const bool negative = !asks_for_alpha(branch) && asks_for_negative(branch);
    s.a_m = negative ? -distance_m : distance_m;
    s.beta_rad = negative ? std::atan2(-B.p.y(), -B.p.x()) : std::atan2(B.p.y(), B.p.x());
  }
  // R11 + R22 and R21 - R12 (antiparallel: R11 - R22 and R21 + R12) instead of one of each, so that
  // the small tilt that is dropped here does not turn the frame.
  const double sign = antiparallel ? -1.0 : 1.0;
  const double total = std::atan2(B.R(1, 0) - sign * B.R(0, 1), B.R(0, 0) + sign * B.R(1, 1));
  s.gamma_rad = wrap_angle(sign * (total - s.beta_rad));
  return s;
}

}  // namespace

Branch branch_of(const DhJoint& row) {
  if (std::abs(std::sin(row.alpha_rad)) > kDrawnParallelSine) {
    return std::sin(row.alpha_rad) < 0 ? Branch::kNegativeAlpha : Branch::kPositiveAlpha;
  }
  return row.a_m < 0 ? Branch::kNegativeA : Branch::kPositiveA;
}

Parameters from_transform(const Pose& B, Branch branch) {
  // Third column of (4): (s_beta s_alpha, -c_beta s_alpha, c_alpha).
  const double sine = std::hypot(B.R(0, 2), B.R(1, 2));
  if (sine < kParallelSine) return from_parallel_axes(B, branch);

  double s_beta = B.R(0, 2) / sine;
  double c_beta = -B.R(1, 2) / sine;
  double s_alpha = sine;
  double a_m = c_beta * B.p.x() + s_beta * B.p.y();
  const bool is_negative = !asks_for_alpha(branch) && a_m < 0;
  if (is_negative != asks_for_negative(branch)) {
    s_beta = -s_beta;
    c_beta = -c_beta;
    s_alpha = -s_alpha;
    a_m = -a_m;
  }

  Parameters s;
  s.beta_rad = std::atan2(s_beta, c_beta);
  s.a_m = a_m;
  s.alpha_rad = std::atan2(s_alpha, B.R(2, 2));
  // gamma from Rot(z, -beta) B and not from the third row of B: near parallel axes beta alone is
  // uncertain by eps / sine, but this gamma carries the opposite error and the product stays exact.
  s.gamma_rad = std::atan2(-(c_beta * B.R(0, 1) + s_beta * B.R(1, 1)),
                           c_beta * B.R(0, 0) + s_beta * B.R(1, 0));
  s.b_m = (s_beta * B.p.x() - c_beta * B.p.y()) / s_alpha;
  // With the rounded cosine of the rounded alpha, which is what the product is made of.
  s.d_m = B.p.z() - s.b_m * std::cos(s.alpha_rad);
  return s;
}

Pose to_transform(const Parameters& s) {
  const Matrix3 R_beta = rotation_z(s.beta_rad);
  const double b_sine = s.b_m * std::sin(s.alpha_rad);
  const double b_cosine = s.b_m * std::cos(s.alpha_rad);
  return {R_beta * rotation_x(s.alpha_rad) * rotation_z(s.gamma_rad),
          R_beta * Vector3(s.a_m, -b_sine, s.d_m + b_cosine)};
}

bool is_parallel(const Parameters& parameters) {
  return parameters.alpha_rad == 0.0 || parameters.alpha_rad == kPi;
}

}  // namespace armsig::s_model
