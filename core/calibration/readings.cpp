// SPDX-License-Identifier: MIT
#include "core/calibration/readings.hpp"

#include <cmath>

#include "core/calibration/model.hpp"

namespace armsig::calibration {

double corrected(const ReadingCorrection& c, double coupled) {
  double result = coupled + c.gain * coupled;
  if (c.cos_1 != 0 || c.sin_1 != 0) {
    result += c.cos_1 * std::cos(coupled) + c.sin_1 * std::sin(coupled);
  }
  if (c.cos_2 != 0 || c.sin_2 != 0) {
    result += c.cos_2 * std::cos(2 * coupled) + c.sin_2 * std::sin(2 * coupled);
  }
  return result;
}

double ReadingCorrection::* term_of(const Parameter& parameter) {
  using C = ReadingCorrection;
  if (parameter.kind == ParameterKind::kReadingGain) return &C::gain;
  if (parameter.kind == ParameterKind::kReadingFirst) {
    return parameter.component == 0 ? &C::cos_1 : &C::sin_1;
  }
  return parameter.component == 0 ? &C::cos_2 : &C::sin_2;
}

double turn_by(const Parameter& parameter, double coupled) {
  if (parameter.kind == ParameterKind::kReadingGain) return coupled;
  const double angle = parameter.kind == ParameterKind::kReadingSecond ? 2 * coupled : coupled;
  return parameter.component == 0 ? std::cos(angle) : std::sin(angle);
}

Deflections deflections_at(const ReadingModel& model, const JointVector& readings) {
  Deflections deflections{};
  if (model.deflections != nullptr) {
    calibration::deflections(*model.deflections, readings, deflections);
  }
  return deflections;
}

JointVector true_readings(const ReadingModel& model, const JointVector& configuration,
                          const JointVector& readings) {
  JointVector turned = effective_readings(model.couplings, readings);
  const Deflections there = deflections_at(model, readings);
  const Deflections at_rest = deflections_at(model, readings_for(model.couplings, configuration));
  for (std::size_t i = 0; i < turned.size(); ++i) {
    turned[i] = configuration[i] + corrected_reading(model, i, turned[i]) -
                corrected_reading(model, i, configuration[i]) + there[i] - at_rest[i];
  }
  return turned;
}

JointVector encoder_readings(const ReadingModel& model, const JointVector& configuration,
                             const JointVector& turned) {
  // The slopes of corrections and deflections are their size: every pass takes another two digits.
  constexpr int kPasses = 10;
  JointVector effective = turned;
  const bool exact = model.corrections.empty() && model.deflections == nullptr;
  for (int pass = 0; !exact && pass < kPasses; ++pass) {
    const JointVector now =
        true_readings(model, configuration, readings_for(model.couplings, effective));
    for (std::size_t i = 0; i < effective.size(); ++i) effective[i] += turned[i] - now[i];
  }
  return readings_for(model.couplings, effective);
}

}  // namespace armsig::calibration
