// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/common_scale.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace armsig::tool {
namespace {

// What a workshop's shifts are worth before any is seen: so many of this size.
constexpr double kUsual = 4;
constexpr double kUsualShift_m = 0.5e-3;
constexpr double kUsualShare = 0.5e-3;  // of the reach, where that is more
// Residuals hang together, as model errors do: so many numbers' worth of them, halved.
constexpr double kIndependent = 15;
constexpr double kWorthAsking = 4;  // of evidence
constexpr int kMostSteps = 6;
constexpr double kSettled = 2e-4;  // of the factor, in a step
// The common normal between two axes has a length and a place along the first.
constexpr double kShiftsOfAxis = 2;

double shift_squares(const NearFit& fit) {
  double squares = 0;
  for (const Deviation& joint : fit.joints) squares += joint.shift_m * joint.shift_m;
  return squares;
}

}  // namespace

std::optional<CommonScale> common_scale(const Evidence& evidence, const NearFit& fit,
                                        const ArmLimits& limits, double start) {
  if (fit.joints.size() < 2) return std::nullopt;
  const auto axes = static_cast<double>(fit.joints.size() - 1);
  const double wider = limits.least_shift_m / ArmLimits{}.least_shift_m;  // as the file allows
  const double usual_m = wider * std::max(kUsualShift_m, kUsualShare * fit.reach_m);
  const double usual = kUsual * usual_m * usual_m;
  const double before = shift_squares(fit);
  const double numbers = (kShiftsOfAxis * axes + kUsual) / 2;
  const bool slides = std::ranges::any_of(evidence.arm.joints, [](const DhJoint& joint) {
    return joint.type == JointType::kPrismatic;
  });
  // Without a slide, shifts that are gone altogether are the most that there can be.
  if (!slides && numbers * std::log((before + usual) / usual) < kWorthAsking) return std::nullopt;
  // The way from deviations to a factor is curved: it is gone in steps, each from the drawing.
  Evidence scaled = evidence;
  scaled.free_scale = true;
  for (EvidenceRow& row : scaled.rows) row.p_S /= start;
  CommonScale found;
  found.factor = start;
  for (int step = 0; step < kMostSteps; ++step) {
    auto with = fit_near(scaled, limits);
    if (!with) return std::nullopt;
    found.factor *= with->scale;
    found.fit = std::move(*with);
    if (std::abs(found.fit.scale - 1) < kSettled) break;
    for (EvidenceRow& row : scaled.rows) row.p_S /= found.fit.scale;
  }
  // Lengths of what was seen, as those of the fit without the factor.
  for (double* length : {&found.fit.sigma_m, &found.fit.best_rms_m, &found.fit.clipped_m}) {
    *length *= found.factor;
  }
  const double after = shift_squares(found.fit);
  found.before_m = std::sqrt(before / axes);
  found.after_m = std::sqrt(after / axes);
  found.evidence = numbers * std::log((before + usual) / (after + usual));
  // What is left of the rows tells as well where a slide's reading says how long a millimetre is.
  found.evidence += kIndependent * std::log(std::max(kComputed_m, fit.best_rms_m) /
                                            std::max(kComputed_m, found.fit.best_rms_m));
  found.undone = std::move(scaled);
  return found;
}

}  // namespace armsig::tool
