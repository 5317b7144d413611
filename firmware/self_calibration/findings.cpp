// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/findings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/calibration/engine_detail.hpp"

namespace armsig::controller {

Motions motions_at(const calibration::ArmModel& model, const calibration::ChainFrames& frames,
                   const Vector3& p_L) {
  Motions motions;
  motions.fill(Vector3::Zero());
  const Vector3 p_S = frames.X_SL * p_L;
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    motions[i] =
        calibration::motion_of(model.joints[i].type == JointType::kRevolute, frames.X_SJ[i], p_S);
  }
  return motions;
}

void Prediction::add(const calibration::Engine& engine, const calibration::ChainFrames& frames,
                     const JointVector& readings, const Covered& covered, const Motions& motions,
                     const HalfPlays& play) {
  ++poses;
  const calibration::Engine::Stated stated = engine.covariance_at(frames, 0, {1, 0, 0, 1, 0, 1});
  model_m2 += stated.model.trace();
  for (std::size_t i = 0; i < play.size(); ++i) {
    (covered.has(i, readings[i]) ? maps_m2 : uncovered_m2)[i] += stated.maps[i];
    const double lever_m2 = motions[i].squaredNorm();
    levers_m2[i] += lever_m2;
    plays_m2[i] += play[i].squared() * lever_m2;
    play_m2 += play[i].squared() * lever_m2;
  }
}

Covered::Covered() {
  lower.fill(std::numeric_limits<double>::infinity());
  upper.fill(-std::numeric_limits<double>::infinity());
}

void Covered::add(const JointVector& readings) {
  for (std::size_t i = 0; i < readings.size(); ++i) {
    lower[i] = std::min(lower[i], readings[i]);
    upper[i] = std::max(upper[i], readings[i]);
  }
}

Budget budget_of(const Prediction& prediction, const JointTypes& types, double model_m) {
  const auto poses = static_cast<double>(prediction.poses);
  double maps_m2 = 0;
  const auto part = [&](const PerJoint& squares) {
    Budget::Part whole;
    double sum = 0;
    for (std::size_t i = 0; i < types.size(); ++i) {
      sum += squares[i];
      if (squares[i] > squares[whole.joint]) whole.joint = i;
    }
    whole.length_m = std::sqrt(sum / poses);
    whole.of_joint_m = std::sqrt(squares[whole.joint] / poses);
    return whole;
  };
  Budget budget;
  budget.maps = part(prediction.maps_m2);
  budget.uncovered = part(prediction.uncovered_m2);
  budget.play = part(prediction.plays_m2);
  for (std::size_t i = 0; i < types.size(); ++i) {
    maps_m2 += prediction.maps_m2[i] + prediction.uncovered_m2[i];
    const double lever_m = std::sqrt(prediction.levers_m2[i] / poses);
    const bool first = budget.lever_m == 0;
    if (types[i] == JointType::kRevolute && (first || lever_m < budget.lever_m)) {
      budget.lever_m = lever_m;
      budget.shortest = i;
    }
  }
  budget.geometry_m = std::sqrt(std::max(prediction.model_m2 - maps_m2, 0.0) / poses);
  budget.unexplained_m = std::sqrt(std::max(model_m * model_m - prediction.model_m2 / poses, 0.0));
  return budget;
}

double Findings::predicted_m() const { return std::hypot(model_m, play_m); }

double Findings::times_more(double accuracy_m) const {
  const double room_m2 = accuracy_m * accuracy_m - play_m * play_m;
  return room_m2 > 0 ? model_m * model_m / room_m2 : std::numeric_limits<double>::infinity();
}

}  // namespace armsig::controller
