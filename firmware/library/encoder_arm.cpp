// SPDX-License-Identifier: MIT
#include "firmware/library/encoder_arm.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/low_discrepancy.hpp"
#include "core/kinematics/forward.hpp"

namespace armsig::tool {
namespace {

constexpr double kAtLimit = 1e-9;  // beyond it by no more is at it [rad or m]
// What the inverse may leave of a reading: so near to a limit it is computed to the last digit.
constexpr double kRounding = 1e-6;
constexpr double kLastDigit = 1e-14;

}  // namespace

EncoderArm::EncoderArm(const Parts& parts)
    : parts_(parts),
      wide_(parts.chain),
      form_(kinematics::closed_form(parts.chain)),
      X_0B_(parts.X_B0.inverse()),
      X_Fn_(parts.X_nF.inverse()) {
  const double beyond = most_deflection() + kRounding;
  for (JointLimits& limits : wide_.limits) {
    limits.lower -= beyond;
    limits.upper += beyond;
  }
}

// By how much the joints turn beyond what their readings say, couplings applied.
JointVector EncoderArm::deflections_at(const JointVector& readings) const {
  JointVector by = calibration::true_readings(parts_.readings, parts_.configuration, readings);
  const JointVector coupled = effective_readings(parts_.readings.couplings, readings);
  for (std::size_t i = 0; i < by.size(); ++i) by[i] -= coupled[i];
  return by;
}

// The most over some configurations, and half as much again.
double EncoderArm::most_deflection() const {
  constexpr int kConfigurations = 64;
  constexpr double kMore = 1.5;
  if (parts_.readings.corrections.empty() && parts_.readings.deflections == nullptr) return 0;
  double most = 0;
  for (int n = 1; n <= kConfigurations; ++n) {
    JointVector readings;
    for (std::size_t i = 0; i < joint_count(); ++i) {
      const bool ends = i < parts_.limits.size() && std::isfinite(parts_.limits[i].lower) &&
                        std::isfinite(parts_.limits[i].upper);
      const JointLimits range = ends ? parts_.limits[i] : JointLimits{-kPi, kPi};
      readings.push_back(range.lower + halton(i, n) * (range.upper - range.lower));
    }
    for (const double by : deflections_at(readings)) most = std::max(most, std::abs(by));
  }
  return kMore * most;
}

Result<Pose> EncoderArm::forward(const JointVector& readings) const {
  ARMSIG_TRY(X_0n, kinematics::forward(parts_.chain,
                                       calibration::true_readings(parts_.readings,
                                                                  parts_.configuration, readings)));
  return parts_.X_B0 * X_0n * parts_.X_nF;
}

// Frames of a file are rotations to as many digits as were written.
Pose EncoderArm::last_frame(const Pose& X_BF) const {
  Pose X_0n = X_0B_ * X_BF * X_Fn_;
  X_0n.R = Eigen::Quaterniond(X_0n.R).normalized().toRotationMatrix();
  return X_0n;
}

kinematics::InverseOptions EncoderArm::options(const Vector3& p_FT) const {
  return {.p_nP = parts_.X_nF * p_FT};
}

double EncoderArm::beyond_limits(const JointVector& readings) const {
  double beyond = 0;
  for (std::size_t i = 0; i < parts_.limits.size(); ++i) {
    const auto [lower, upper] = parts_.limits[i];
    beyond = std::max({beyond, lower - readings[i], readings[i] - upper});
  }
  return beyond;
}

bool EncoderArm::inside_limits(const JointVector& readings) const {
  return beyond_limits(readings) <= kAtLimit;
}

// By how many whole turns the joint comes inside its limits; 0 where it is, and where none do.
double EncoderArm::whole_turns_inside(std::size_t joint, double reading) const {
  if (joint >= parts_.limits.size() || !parts_.chain.revolute[joint]) return 0;
  const double lower = parts_.limits[joint].lower - kAtLimit;
  const double upper = parts_.limits[joint].upper + kAtLimit;
  if (reading >= lower && reading <= upper) return 0;
  const double turns = reading < lower ? std::ceil((lower - reading) / (2 * kPi))
                                       : -std::ceil((reading - upper) / (2 * kPi));
  const double moved = reading + turns * (2 * kPi);
  return moved >= lower && moved <= upper ? turns : 0;
}

// The chain is the same at whole turns of its joints; encoders are not, and one that others are
// coupled to turns theirs too.
JointVector EncoderArm::readings_of(JointVector turned) const {
  const auto read = [&] {
    return calibration::encoder_readings(parts_.readings, parts_.configuration, turned);
  };
  JointVector readings = read();
  for (std::size_t step = 0; step < 2 * readings.size(); ++step) {
    const std::size_t i = step % readings.size();
    const double turns = whole_turns_inside(i, readings[i]);
    if (turns == 0) continue;
    turned[i] += turns * (2 * kPi);
    readings = read();
  }
  return readings;
}

// The limits of coupled joints are those of their own readings.
FoundReadings EncoderArm::judged(const kinematics::InverseSolution& solution, const Pose& X_0n,
                                 const kinematics::InverseOptions& options) const {
  FoundReadings found{solution.verdict, readings_of(solution.q), solution.rotation_error_rad,
                      solution.regularity};
  if (!is_solved(found.verdict)) return found;
  const double beyond = beyond_limits(found.readings);
  if (beyond > kAtLimit && beyond <= kRounding) {
    kinematics::InverseOptions exactly = options;
    exactly.position_tolerance_m = exactly.rotation_tolerance_rad = kLastDigit;
    exactly.max_iterations = 4;
    const auto exact = kinematics::inverse(wide_, X_0n, solution.q, exactly);
    const bool met =
        exact && exact->position_error_m <= options.position_tolerance_m &&
        exact->rotation_error_rad <= solution.rotation_error_rad + options.rotation_tolerance_rad;
    if (met) found.readings = readings_of(exact->q);
  }
  if (!inside_limits(found.readings)) {
    found.verdict = kinematics::Verdict::kJointLimit;
    return found;
  }
  for (std::size_t i = 0; i < parts_.limits.size(); ++i) {
    const auto [lower, upper] = parts_.limits[i];
    found.readings[i] = std::clamp(found.readings[i], lower, upper);
  }
  return found;
}

// Joints that can move without the flange may have stopped beyond the limit of an encoder. They are
// brought inside by limits that the deflections there have moved.
FoundReadings EncoderArm::found(const kinematics::InverseSolution& solution, const Pose& X_0n,
                                const kinematics::InverseOptions& options) const {
  constexpr int kRounds = 4;  // a limit moves by what a deflection changes
  FoundReadings found = judged(solution, X_0n, options);
  if (joint_count() <= 6 || !is_solved(solution.verdict)) return found;
  kinematics::InverseSolution at = solution;
  for (int round = 0; round < kRounds && !is_solved(found.verdict); ++round) {
    const JointVector by = deflections_at(found.readings);
    kinematics::Chain here = parts_.chain;
    for (std::size_t i = 0; i < here.limits.size(); ++i) {
      here.limits[i].lower += by[i];
      here.limits[i].upper += by[i];
    }
    const auto inside = kinematics::inverse(here, X_0n, at.q, options);
    if (!inside || !is_solved(inside->verdict)) return found;
    at = *inside;
    found = judged(at, X_0n, options);
  }
  return found;
}

Result<FoundReadings> EncoderArm::inverse(const Pose& X_BF, const JointVector& seed,
                                          const Vector3& p_FT) const {
  const JointVector turned =
      calibration::true_readings(parts_.readings, parts_.configuration, seed);
  const Pose X_0n = last_frame(X_BF);
  ARMSIG_TRY(solution, kinematics::inverse(wide_, X_0n, turned, options(p_FT)));
  return found(solution, X_0n, options(p_FT));
}

Result<EncoderArm::All> EncoderArm::solutions(const Pose& X_BF, const JointVector& reference,
                                              const Vector3& p_FT) const {
  JointVector turned;
  if (!reference.empty()) {
    turned = calibration::true_readings(parts_.readings, parts_.configuration, reference);
  }
  const Pose X_0n = last_frame(X_BF);
  ARMSIG_TRY(named, kinematics::cold_start(wide_, form_, X_0n, turned, options(p_FT)));
  All judged_ones;
  for (const kinematics::NamedSolution& one : named) {
    judged_ones.push_back(found(one.solution, X_0n, options(p_FT)));
  }
  All all;
  for (const bool solved : {true, false}) {
    for (const FoundReadings& one : judged_ones) {
      if (is_solved(one.verdict) == solved) all.push_back(one);
    }
  }
  return all;
}

}  // namespace armsig::tool
