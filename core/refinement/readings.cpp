// SPDX-License-Identifier: MIT
#include "core/refinement/readings.hpp"

#include <cmath>

namespace armsig::refinement {

JointVector coupled_readings(const ReadingModel& model, const JointVector& readings) {
  JointVector coupled = readings;
  for (const JointCoupling& coupling : model.couplings) {
    coupled[coupling.joint] += coupling.ratio * readings[coupling.from];
  }
  return coupled;
}

double corrected_reading(const ReadingModel& model, std::size_t joint, double coupled) {
  if (model.corrections.empty()) return coupled;
  const ReadingCorrection& c = model.corrections[joint];
  double corrected = coupled + c.gain * coupled;
  if (c.cos_1 != 0 || c.sin_1 != 0) {
    corrected += c.cos_1 * std::cos(coupled) + c.sin_1 * std::sin(coupled);
  }
  if (c.cos_2 != 0 || c.sin_2 != 0) {
    corrected += c.cos_2 * std::cos(2 * coupled) + c.sin_2 * std::sin(2 * coupled);
  }
  return corrected;
}

}  // namespace armsig::refinement
