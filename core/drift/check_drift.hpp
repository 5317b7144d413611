// SPDX-License-Identifier: MIT
// Is the arm still the one that was identified? Residuals on poses that were not used, against what
// the stored covariance and the sensor's noise allow together (docs/model.md, section 6).
#pragma once

#include <span>

#include "core/calibration/refined.hpp"

namespace armsig::drift {

enum class DriftVerdict : std::uint8_t {
  kConsistent,
  kDrifted,      // a displacement of one link, the base or the target explains the residuals best
  kSensorWorse,  // larger noise explains them best
};
[[nodiscard]] std::string_view describe(DriftVerdict verdict);

struct DriftReport {
  DriftVerdict verdict = DriftVerdict::kConsistent;
  double chi_square = 0;  // r^T (sigma^2 I + J P J^T)^-1 r over all rows together
  std::size_t freedom = 0;
  double allowed = 0;  // what chi_square stays below in 999 of 1,000 healthy checks
  // kDrifted: the link that most likely moved against the one before it; 0 the base against the
  // sensor, n the last link with its target. The zero of joint i shows as link i or, just as well,
  // i - 1.
  std::size_t link = 0;
  double noise_factor = 1;        // kSensorWorse: so many times the stated sigma
  std::size_t rows = 0;           // used
  std::size_t rows_rejected = 0;  // gross outliers among them, see RowOutcome::rejected
  double mean_m = 0;              // of the residual lengths of the rows used
  double rms_m = 0;
  double largest_m = 0;
};

// Judges every row of `log` whose use is not kIgnore. Rows without a stated sigma take that of the
// refinement; to either comes what the refinement left unexplained. `scratch` is for work.
// Errors: kNotFinite (index of the row); kTooFewPoints (rows used, 1); kTooManyOutliers (rows
// rejected, rows allowed).
[[nodiscard]] Judged<DriftReport> check_drift(const calibration::Refined& refined,
                                              std::span<const calibration::Observation> log,
                                              const calibration::Receivers& receivers,
                                              std::span<calibration::RowOutcome> outcomes,
                                              calibration::SquareRootFactor& scratch);

}  // namespace armsig::drift
