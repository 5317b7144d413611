// SPDX-License-Identifier: MIT
#include "firmware/self_calibration_m7/story.hpp"

#include <chrono>
#include <cmath>

#include "core/base/low_discrepancy.hpp"
#include "core/identification.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/arm_r5f/world.hpp"
#include "firmware/cabinet_r5f/configuration.hpp"

namespace armsig::story {
namespace {

constexpr double kSigma_m = 0.1e-3;  // of a point, per axis
constexpr double kArc = radians(160);
constexpr auto kVisit = std::chrono::seconds(5);
constexpr auto kLongest = std::chrono::minutes(60);
// Of each joint's reading: waves a turn, and their amplitudes together.
constexpr std::array<double, 2> kWaves{1, 5};
constexpr double kAmplitude = radians(0.01);
// Of shoulder and elbow, for a metre between them and what weighs.
constexpr double kSag = 0.6e-3;

}  // namespace

Story::Story(Memory& memory)
    : arm_(arm_r5f::arm()),
      configuration_(cabinet::controller_configuration()),
      calibration_(configuration_, memory) {
  const simulated::Target& target = arm_.targets[0];
  const KnownTarget known{target.number, target.link, target.p_L};
  record_.signature =
      signature_of(arm_.arm, configuration_.sweeps.configuration, arm_.X_S0, {&known, 1});
}

void Story::begin() {
  // Without a journal there is nothing to go on with, and no error.
  (void)calibration_.begin({.accuracy_m = kAsked_m, .ends = now_ + kLongest}, {});
}

JointVector Story::readings_of_sweep(std::size_t joint, std::size_t k) const {
  JointVector q = configuration_.sweeps.configuration;
  const double share = static_cast<double>(k) / static_cast<double>(kPointsOfASweep - 1);
  q[joint] += kArc * (share - 0.5);
  return q;
}

const JointVector& Story::visit() {
  now_ += kVisit;
  return calibration_.visit().pose;
}

Vector3 Story::target_at(const JointVector& readings) const {
  JointVector q = readings;
  for (std::size_t j = 0; j < q.size(); ++j) {
    for (const double waves : kWaves) {
      q[j] += kAmplitude * std::sin(waves * readings[j] + static_cast<double>(j));
    }
  }
  const auto X_SL = simulated::link_poses(arm_, readings);
  const Vector3 down = -arm_.X_S0.R.col(2);
  for (const std::size_t j : {1U, 2U}) {
    const Vector3 lever = X_SL[kJoints].p - X_SL[j].p;
    q[j] += kSag * X_SL[j].R.col(2).dot(lever.cross(down));
  }
  return simulated::target_position(arm_, q, arm_.targets[0]);
}

controller::MeasuredPoint Story::measured_at(const JointVector& readings) {
  return {.p_S = target_at(readings) + kSigma_m * random_.normal_vector(),
          .covariance_m2 = kSigma_m * kSigma_m * Matrix3::Identity(),
          .pings = 1};
}

Story::Answer Story::answer(int k) {
  const Signature& signature = record_.signature;
  joints_.set(record_.deflections, configuration_.drawing, signature.configuration);
  FixedVector<JointLimits, kMaxJoints> limits = configuration_.drawing.limits;
  for (std::size_t j = 0; j < limits.size(); ++j) {
    const double centre = configuration_.sweeps.configuration[j];
    const double reach = configuration_.sweeps.validation_reach;
    limits[j] = {centre + reach * (limits[j].lower - centre),
                 centre + reach * (limits[j].upper - centre)};
  }
  const JointVector q = work_configuration(signature.types, limits, 1000 + k);
  const auto turned = joints_.turned(q);
  if (!turned) return {};
  const Vector3 p_L = signature.X_SL.back().inverse() * signature.targets[0].p_S;
  return {kinematics::link_pose(signature, *turned, kJoints) * p_L, target_at(q)};
}

}  // namespace armsig::story
