// SPDX-License-Identifier: MIT
#include <cmath>

#include "core/arm_model/model.hpp"
#include "core/base/links.hpp"
#include "core/base/low_discrepancy.hpp"

namespace armsig::calibration {

namespace {

constexpr int kPoses = 200;
// Of the squares of a lever over these poses that must remain beside those of other origins.
constexpr double kOwnShare = 1e-9;
constexpr double kLeastSquares_m2 = 1e-9 * kPoses;

// Axes and origins by the drawing, in its base frame.
struct DrawnAxes {
  std::array<Vector3, kMaxJoints> axis;
  std::array<Vector3, kMaxFrames> origin;
};

void draw_axes(const ArmModel& model, const JointVector& effective, DrawnAxes& drawn) {
  Pose X_BL;
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    const JointModel& joint = model.joints[i];
    drawn.axis[i] = X_BL.R.col(2);
    drawn.origin[i] = X_BL.p;
    X_BL = X_BL * joint_motion(joint.type, effective[i] + joint.offset) * joint.after;
  }
  drawn.origin[model.joint_count()] = X_BL.p;
}

// z_j . ((O_k - O_j) x down), down = -z of the base; of a slide z_j . down.
double lever(const DrawnAxes& drawn, JointType type, std::size_t joint, std::size_t origin) {
  const Vector3& z = drawn.axis[joint];
  if (type != JointType::kRevolute) return -z.z();
  const Vector3 arm = drawn.origin[origin] - drawn.origin[joint];
  return z.y() * arm.x() - z.x() * arm.y();
}

using Squares = std::array<std::array<double, kMaxFrames>, kMaxFrames>;

// Cholesky's method, origin by origin: what is left of an origin's own is the pivot.
void keep_independent(std::size_t joint, std::size_t count, const Squares& squares,
                      ArmModel& model) {
  Squares factor{};
  std::array<bool, kMaxFrames> kept{};
  for (std::size_t k = joint + 1; k <= count; ++k) {
    double own = squares[k][k];
    for (std::size_t m = joint + 1; m < k; ++m) {
      if (!kept[m]) continue;
      double sum = squares[k][m];
      for (std::size_t l = joint + 1; l < m; ++l) sum -= factor[k][l] * factor[m][l];
      factor[k][m] = sum / factor[m][m];
      own -= factor[k][m] * factor[k][m];
    }
    kept[k] = own > kLeastSquares_m2 && own > kOwnShare * squares[k][k];
    if (!kept[k]) {
      factor[k].fill(0);
      continue;
    }
    factor[k][k] = std::sqrt(own);
    if (model.gravity.full()) return;
    model.gravity.push_back({static_cast<std::uint8_t>(joint), static_cast<std::uint8_t>(k), 0});
  }
}

}  // namespace

void gravity_levers(const ArmModel& model, const JointVector& effective, GravityLevers& levers) {
  DrawnAxes drawn;
  draw_axes(model, effective, drawn);
  for (std::size_t t = 0; t < model.gravity.size(); ++t) {
    const GravityTerm& term = model.gravity[t];
    levers[t] = lever(drawn, model.joints[term.joint].type, term.joint, term.origin);
  }
}

void choose_gravity_terms(const Arm& arm, ArmModel& model) {
  const std::size_t n = model.joint_count();
  const auto types = types_of(model.joints);
  std::array<Squares, kMaxJoints> squares{};
  DrawnAxes drawn;
  for (int pose = 1; pose <= kPoses; ++pose) {
    const JointVector q = evenly_spread_configuration(types, arm.limits, pose);
    draw_axes(model, effective_readings(arm, q), drawn);
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t k = j + 1; k <= n; ++k) {
        for (std::size_t m = j + 1; m <= k; ++m) {
          squares[j][k][m] += lever(drawn, types[j], j, k) * lever(drawn, types[j], j, m);
        }
      }
    }
  }
  model.gravity.clear();
  for (std::size_t j = 0; j < n; ++j) keep_independent(j, n, squares[j], model);
}

}  // namespace armsig::calibration
