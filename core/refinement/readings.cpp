// SPDX-License-Identifier: MIT
#include "core/refinement/readings.hpp"

#include <cmath>

namespace armsig::refinement {

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

JointVector true_readings(const ReadingModel& model, const JointVector& configuration,
                          const JointVector& readings) {
  JointVector turned = effective_readings(model.couplings, readings);
  for (std::size_t i = 0; i < turned.size(); ++i) {
    turned[i] = configuration[i] + corrected_reading(model, i, turned[i]) -
                corrected_reading(model, i, configuration[i]);
  }
  return turned;
}

JointVector encoder_readings(const ReadingModel& model, const JointVector& configuration,
                             const JointVector& turned) {
  JointVector effective = turned;
  // The corrections' slope is their size: every pass takes another two digits.
  constexpr int kPasses = 10;
  for (std::size_t i = 0; !model.corrections.empty() && i < effective.size(); ++i) {
    const double wanted =
        turned[i] - configuration[i] + corrected_reading(model, i, configuration[i]);
    for (int pass = 0; pass < kPasses; ++pass) {
      effective[i] += wanted - corrected_reading(model, i, effective[i]);
    }
  }
  return readings_for(model.couplings, effective);
}

}  // namespace armsig::refinement
