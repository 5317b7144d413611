// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "core/base/links.hpp"
#include "core/base/low_discrepancy.hpp"
#include "core/calibration/gravity_choice.hpp"

namespace armsig::calibration {

namespace {

constexpr int kPoses = 200;
constexpr int kPosesAStep = 10;
// Of the squares of a lever over these poses that must remain beside those of other origins.
constexpr double kOwnShare = 1e-9;
constexpr double kLeastSquares_m2 = 1e-9 * kPoses;

// Axes and origins by the nominal rows, in frame 0.
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

// z_j . ((O_k - O_j) x down), down = -up_0; of a prismatic joint z_j . down.
double lever(const DrawnAxes& drawn, const ArmModel& model, std::size_t joint, std::size_t origin) {
  const Vector3& z = drawn.axis[joint];
  if (model.joints[joint].type != JointType::kRevolute) return -z.dot(model.up_0);
  return z.cross(model.up_0).dot(drawn.origin[origin] - drawn.origin[joint]);
}

// Cholesky's method, origin by origin: what is left of an origin's own is the pivot.
void keep_independent(std::size_t joint, std::size_t most, const LeverSquares& squares,
                      ArmModel& model) {
  const std::size_t count = model.joint_count();
  LeverSquares factor{};
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
    if (model.gravity.size() == most) return;
    model.gravity.push_back({static_cast<std::uint8_t>(joint), static_cast<std::uint8_t>(k), 0});
  }
}

}  // namespace

void gravity_levers(const ArmModel& model, const JointVector& effective, GravityLevers& levers) {
  DrawnAxes drawn;
  draw_axes(model, effective, drawn);
  for (std::size_t t = 0; t < model.gravity.size(); ++t) {
    const GravityTerm& term = model.gravity[t];
    levers[t] = lever(drawn, model, term.joint, term.origin);
  }
}

GravityChoice::GravityChoice(const Arm& arm, ArmModel& model, std::size_t most)
    : arm_(arm), model_(model), most_(std::min(most, kMaxGravityTerms)) {
  model.gravity.clear();
}

bool GravityChoice::step() {
  if (joint_ == model_.joint_count()) return false;
  const JointTypes types = types_of(model_.joints);
  for (int n = 0; n < kPosesAStep; ++n) add_pose(types);
  if (poses_ < kPoses) return true;
  keep_independent(joint_, most_, squares_, model_);
  squares_ = {};
  poses_ = 0;
  return ++joint_ < model_.joint_count();
}

void GravityChoice::add_pose(const JointTypes& types) {
  DrawnAxes drawn;
  const JointVector q = evenly_spread_configuration(types, arm_.limits, ++poses_);
  draw_axes(model_, effective_readings(arm_, q), drawn);
  std::array<double, kMaxFrames> levers{};
  for (std::size_t k = joint_ + 1; k <= types.size(); ++k) {
    levers[k] = lever(drawn, model_, joint_, k);
    for (std::size_t m = joint_ + 1; m <= k; ++m) squares_[k][m] += levers[k] * levers[m];
  }
}

void choose_gravity_terms(const Arm& arm, ArmModel& model) {
  GravityChoice choice(arm, model);
  while (choice.step()) {
  }
}

}  // namespace armsig::calibration
