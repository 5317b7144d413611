// SPDX-License-Identifier: MIT
#include "firmware/analysis/differences/differences.hpp"

#include <cmath>

#include "core/base/joint_range.hpp"
#include "core/frames/alignment.hpp"
#include "core/frames/link_frames.hpp"
#include "core/identification.hpp"
#include "core/kinematics/s_model_chain.hpp"

namespace armsig::differences {
namespace {

using calibration::kNoColumn;
using calibration::Refined;
using calibration::StateVector;

// A deviation whose derivatives by all lines are below this is one of the choice that
// axis_deviations() makes, not of the arm.
constexpr double kLeastDerivative = 0.05;

// The configuration in the middle of the limits: the same whatever was measured where.
JointVector middle_of(const Arm& drawing) {
  JointVector q;
  for (const JointLimits& limits : drawing.limits) q.push_back(middle_of(limits));
  return q;
}

// Where the drawing stands, by its axes laid over those of the arm, and its tool.
struct Laid {
  Pose X_SD;
  Vector3 p_nT;
};

Laid laid(const Arm& drawing, const Signature& signature, const Target& tool) {
  const JointVector q = effective_readings(drawing, middle_of(drawing));
  const frames::KnownLinkFrames drawn = frames::link_frames(drawing.joints, q);
  FixedVector<Pose, kMaxFrames> X_SL;
  for (std::size_t k = 0; k <= signature.joint_count(); ++k) {
    X_SL.push_back(kinematics::link_pose(signature, q, k));
  }
  const Pose X_SD =
      frames::align(frames::axis_lines(X_SL, signature.types), frames::axis_lines(drawing, q)).X_AB;
  const Vector3 p_S = kinematics::target_position(signature, q, tool);
  return {X_SD, (X_SD * drawn.X_0L.back()).inverse() * p_S};
}

double sigma_of(const Refined& estimate, StateVector gradient) {
  if (estimate.layout.size() == 0) return 0;
  return std::sqrt(estimate.information.variance(gradient));
}

// The derivative of a deviation by the unknowns of the estimate.
StateVector by_unknowns(const Refined& estimate, const LineDerivatives& by_lines) {
  StateVector gradient{};
  if (estimate.layout.size() == 0) return gradient;
  for (std::size_t i = 0; i < estimate.signature.joint_count(); ++i) {
    const bool revolute = estimate.signature.types[i] == JointType::kRevolute;
    for (std::size_t c = 0; c < (revolute ? 4U : 2U); ++c) {
      gradient[estimate.layout.axis[i] + c] = by_lines[i * kLineColumns + c];
    }
  }
  return gradient;
}

// The errors of joint i's reading: what its lines, found at the signature configuration, hold of
// them belongs to the reading, not to the zero.
void move_zero_to_reading_nought(const Refined& estimate, std::size_t i, double& zero,
                                 StateVector& gradient) {
  const double q = estimate.signature.configuration[i];
  zero -= calibration::corrected_reading(estimate.readings, i, q) - q;
  if (estimate.layout.size() == 0) return;
  const auto hang_on = [&](std::size_t column, double derivative) {
    if (column != kNoColumn) gradient[column] -= derivative;
  };
  hang_on(estimate.layout.gain[i], q);
  if (estimate.layout.first[i] != kNoColumn) {
    hang_on(estimate.layout.first[i], std::cos(q));
    hang_on(estimate.layout.first[i] + 1, std::sin(q));
  }
  if (estimate.layout.second[i] != kNoColumn) {
    hang_on(estimate.layout.second[i], std::cos(2 * q));
    hang_on(estimate.layout.second[i] + 1, std::sin(2 * q));
  }
}

double amplitude_sigma(const Refined& estimate, std::size_t column, double cosine, double sine) {
  const double amplitude = std::hypot(cosine, sine);
  if (estimate.layout.size() == 0 || column == kNoColumn || amplitude == 0) return 0;
  StateVector gradient{};
  gradient[column] = cosine / amplitude;
  gradient[column + 1] = sine / amplitude;
  return sigma_of(estimate, gradient);
}

void add_reading_errors(const Refined& estimate, std::size_t i, const Effects& effects,
                        Differences& found) {
  if (estimate.readings.corrections.empty()) return;
  const calibration::ReadingCorrection& c = estimate.readings.corrections[i];
  const auto add = [&](Cause cause, double value, double sigma) {
    if (value == 0) return;
    found.all.push_back(
        {i, cause, value, sigma, effects.of[i * kCauses + static_cast<std::size_t>(cause)]});
  };
  const bool known = estimate.layout.size() > 0;
  double gain_sigma = 0;
  if (known && estimate.layout.gain[i] != kNoColumn) {
    StateVector gradient{};
    gradient[estimate.layout.gain[i]] = 1;
    gain_sigma = sigma_of(estimate, gradient);
  }
  add(Cause::kScale, c.gain, gain_sigma);
  add(Cause::kOnceATurn, std::hypot(c.cos_1, c.sin_1),
      amplitude_sigma(estimate, known ? estimate.layout.first[i] : kNoColumn, c.cos_1, c.sin_1));
  add(Cause::kTwiceATurn, std::hypot(c.cos_2, c.sin_2),
      amplitude_sigma(estimate, known ? estimate.layout.second[i] : kNoColumn, c.cos_2, c.sin_2));
}

void add_bends(const Effects& effects, std::size_t i, Differences& found) {
  const auto add = [&](Cause cause, double largest) {
    const Effect& effect = effects.of[i * kCauses + static_cast<std::size_t>(cause)];
    if (largest > 0) found.all.push_back({i, cause, largest, 0, effect});
  };
  add(Cause::kMap, effects.largest.more_by_map[i]);
  add(Cause::kGravity, effects.largest.more_by_gravity[i]);
}

// Whether the lines tell a deviation: its derivatives, a turn of an axis counted as what it does at
// the arm's length.
bool is_told(const LineDerivatives& by_lines, bool is_angle, double size_m) {
  double squares = 0;
  for (std::size_t c = 0; c < by_lines.size(); ++c) {
    const bool by_angle = c % kLineColumns < 2;
    double derivative = by_lines[c];
    if (is_angle && !by_angle) derivative *= size_m;
    if (!is_angle && by_angle) derivative /= size_m;
    squares += derivative * derivative;
  }
  return squares > kLeastDerivative * kLeastDerivative;
}

bool is_angle(Deviation which, JointType type) {
  switch (which) {
    case Deviation::kTiltX:
    case Deviation::kTiltY:
      return true;
    case Deviation::kShiftX:
    case Deviation::kShiftY:
      return false;
    case Deviation::kZero:
      return type == JointType::kRevolute;
  }
  return false;
}

struct Compared {
  DeviatingChain chain;
  AxisDeviations deviations;
  std::array<double, kMaxJoints * kDeviations> sigmas{};
};

Result<Compared> compared(const Arm& drawing, const Refined& estimate, std::size_t tool) {
  const Signature& signature = estimate.signature;
  const std::size_t n = signature.joint_count();
  ARMSIG_CHECK(drawing.joints.size() == n && drawing.limits.size() == n);
  const Target& target = signature.targets[tool];
  const Laid start = laid(drawing, signature, target);
  Compared result{};
  result.chain.axes = drawn_axes(drawing, start.p_nT);
  ARMSIG_TRY(deviations, axis_deviations(result.chain.axes, signature, start.X_SD));
  result.deviations = deviations;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < kDeviations; ++k) {
      const std::size_t index = i * kDeviations + k;
      StateVector gradient = by_unknowns(estimate, deviations.by_lines[index]);
      if (static_cast<Deviation>(k) == Deviation::kZero) {
        move_zero_to_reading_nought(estimate, i, result.deviations.values[index], gradient);
      }
      result.sigmas[index] = sigma_of(estimate, gradient);
    }
  }
  result.chain.values = result.deviations.values;
  result.chain.readings = estimate.readings;
  result.chain.X_SD = deviations.X_SD;
  result.chain.p_T = hand_pose(result.chain, signature.configuration).inverse() * target.p_S;
  return result;
}

}  // namespace

Result<Differences> differences(const Arm& drawing, const Refined& estimate, std::size_t tool,
                                const Bendings& bendings) {
  ARMSIG_TRY(found, compared(drawing, estimate, tool));
  found.chain.bendings = bendings;
  const Signature& signature = estimate.signature;
  const Effects effects = difference_effects(found.chain, drawing.limits);
  const double size_m = frames::arm_size(frames::axis_lines(signature));
  Differences differences{.axes = found.chain.axes, .all = {}, .total_rms_m = effects.total_rms_m};
  for (std::size_t i = 0; i < signature.joint_count(); ++i) {
    for (std::size_t k = 0; k < kDeviations; ++k) {
      const std::size_t index = i * kDeviations + k;
      const bool angle = is_angle(static_cast<Deviation>(k), signature.types[i]);
      if (!is_told(found.deviations.by_lines[index], angle, size_m)) continue;
      differences.all.push_back({i, static_cast<Cause>(k), found.deviations.values[index],
                                 found.sigmas[index], effects.of[i * kCauses + k]});
    }
    add_reading_errors(estimate, i, effects, differences);
    add_bends(effects, i, differences);
  }
  return differences;
}

Result<Signature> fitted_drawing(const Arm& drawing, const Refined& estimate, std::size_t tool) {
  ARMSIG_TRY(found, compared(drawing, estimate, tool));
  const FittedBase fitted = fitted_base(found.chain, drawing.limits);
  // The tool in the drawing's last frame, by way of the base with all joints at zero.
  Pose X_0T;
  for (const DrawnAxis& axis : found.chain.axes) X_0T = X_0T * axis.X_before;
  const std::size_t n = drawing.joints.size();
  const Pose X_0n = frames::link_frames(drawing.joints, JointVector(n)).X_0L.back();
  const Target& target = estimate.signature.targets[tool];
  const KnownTarget known{target.number, n, X_0n.inverse() * (X_0T * fitted.p_T)};
  return signature_of(drawing, estimate.signature.configuration, fitted.X_SD, std::span(&known, 1));
}

}  // namespace armsig::differences
