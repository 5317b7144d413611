// SPDX-License-Identifier: MIT
#include "firmware/host_tool/programs/configuration.hpp"

#include <cmath>
#include <utility>

#include "core/base/links.hpp"

namespace armsig::tool {
namespace {

// A target has so many digits that its readings are known to this; a configuration is the same on
// both sides of where its words change.
constexpr double kOfATarget_rad = radians(0.02);

// `q` with whole turns added to its joints wherever the limits leave room: visit(readings).
template <typename Visit>
void with_whole_turns(const EncoderArm& arm, const JointVector& q, std::size_t joint,
                      const Visit& visit) {
  if (joint == q.size()) {
    visit(q);
    return;
  }
  for (const double turn : {0.0, -2 * kPi, 2 * kPi}) {
    JointVector turned = q;
    turned[joint] += turn;
    if (arm.inside_limits(turned)) with_whole_turns(arm, turned, joint + 1, visit);
  }
}

Chosen nearest_before(const EncoderArm::All& all, const JointVector& before) {
  if (before.empty()) {
    return {std::nullopt,
            "the arm's configuration is not known there: --seed with the readings where the "
            "program begins"};
  }
  for (const FoundReadings& found : all) {
    if (is_solved(found.verdict)) return {found.readings, ""};
  }
  return {std::nullopt, std::string(describe(Uncorrected::kNominalReach))};
}

}  // namespace

Stance stance_of(const Arm& nominal, const Matrix3& R_0C, const JointVector& q) {
  const auto X_0F = dh_frames(nominal.joints, effective_readings(nominal, q));
  // Joint 1 turns the forward direction about its axis.
  const Vector3 forward = rotation_z(q[0]) * R_0C.col(0);
  const Vector3 up = R_0C.col(2);
  const Vector3 lower = X_0F[2].p - X_0F[1].p;
  const Vector3 upper = X_0F[4].p - X_0F[2].p;
  return {forward.dot(X_0F[4].p),
          up.dot(lower) * forward.dot(upper) - forward.dot(lower) * up.dot(upper)};
}

bool in_one_configuration(const Arm& nominal, const Matrix3& R_0C, const JointVector& one,
                          const JointVector& other) {
  const Stance stance_one = stance_of(nominal, R_0C, one);
  const Stance stance_other = stance_of(nominal, R_0C, other);
  const auto part = [](double reading, double turn) { return std::floor(reading / turn - 0.5); };
  const auto half_turns = [&](std::size_t i) {
    return part(one[i], 2 * kPi) == part(other[i], 2 * kPi);
  };
  return (stance_one.front < 0) == (stance_other.front < 0) &&
         (stance_one.ahead < 0) == (stance_other.ahead < 0) && (one[4] < 0) == (other[4] < 0) &&
         part(one[3], kPi) == part(other[3], kPi) && half_turns(0) && half_turns(3) &&
         half_turns(5);
}

Chosen chosen_readings(const ControllerView& controller, const Language& language,
                       const ProgramTarget& target, const Pose& X_BF, const JointVector& before) {
  const EncoderArm& arm = controller.compensation->nominal();
  const auto all = arm.solutions(X_BF, before, target.X_FT.p);
  if (!all || all->empty()) {
    return {std::nullopt, std::string(describe(Uncorrected::kNominalReach))};
  }
  if (target.configuration.empty() || language.matches == nullptr) {
    return nearest_before(*all, before);
  }
  Chosen chosen;
  double nearest = HUGE_VAL;
  for (const FoundReadings& found : *all) {
    if (!is_solved(found.verdict) && found.verdict != kinematics::Verdict::kJointLimit) continue;
    with_whole_turns(arm, found.readings, 0, [&](const JointVector& q) {
      const Stance stance = stance_of(*controller.nominal, controller.X_0C.R, q);
      if (!language.matches(target.configuration, q, stance, kOfATarget_rad)) return;
      const double change = largest_change(before.empty() ? JointVector(q.size()) : before, q);
      if (change >= nearest) return;
      nearest = change;
      chosen.readings = q;
    });
  }
  if (chosen.readings || (target.linear && !before.empty())) {
    return chosen.readings ? chosen : nearest_before(*all, before);
  }
  chosen.why_not = "the nominal model reaches it, but not with " +
                   language.in_words(target.configuration) +
                   ": is it the model of this arm, with --base and --flange?";
  if (target.linear) chosen.why_not += " If so, --seed with the readings before it";
  return chosen;
}

}  // namespace armsig::tool
