// SPDX-License-Identifier: MIT
#include "core/drift/check_drift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/calibration/row.hpp"
#include "core/drift/displacement.hpp"
#include "core/numerics/quantiles.hpp"
#include "core/numerics/robust.hpp"

namespace armsig::drift {

using calibration::Observation;
using calibration::PoeChain;
using calibration::Receivers;
using calibration::Refined;
using calibration::RowOutcome;
using calibration::RowUse;
using calibration::SquareRootFactor;
using numerics::LogHistogram;

namespace {

// Healthy residuals carry the stored uncertainty too: only what is far beyond the gate of the noise
// alone is an outlier.
constexpr double kOutlierFactor = 2;
// Rows that may be rejected before there is nothing left to judge.
constexpr double kRejectedShare = 0.3;
// Sizes of a drift that are weighed against larger noise: a tenth of a millimetre and milliradian
// for a warm arm, thirty for a collision.
constexpr std::array<double, 6> kDriftSizes{1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2};

double sigma_of(const Refined& refined, const Observation& row) {
  return std::hypot(row.sigma_m > 0 ? row.sigma_m : refined.quality.sigma_m,
                    refined.quality.unexplained_m);
}

struct Evidence {
  double chi_square = 0;
  double log_determinant = 0;  // of the residuals' covariance over that of the noise alone
};

// Takes all rows into the factor of a prior and reads off r^T S^-1 r and ln |S|.
Evidence evidence(const Refined& refined, std::span<const Observation> log,
                  const Receivers& receivers, std::span<const RowOutcome> outcomes,
                  SquareRootFactor& factor) {
  const PoeChain chain(refined.signature, refined.readings);
  const double before = factor.log_determinant();
  for (std::size_t k = 0; k < log.size(); ++k) {
    if (log[k].use == RowUse::kIgnore || outcomes[k].rejected) continue;
    calibration::absorb_row(refined, receivers, chain, log[k], 1 / sigma_of(refined, log[k]),
                            factor);
  }
  return {factor.residual_squares(), 2 * (factor.log_determinant() - before)};
}

// Residuals, and which of them are far outside even the spread of all.
void find_outliers(const Refined& refined, std::span<const Observation> log,
                   const Receivers& receivers, std::span<RowOutcome> outcomes) {
  const PoeChain chain(refined.signature, refined.readings);
  LogHistogram squares;
  for (std::size_t k = 0; k < log.size(); ++k) {
    const Observation& row = log[k];
    outcomes[k] = {};
    outcomes[k].residual_m = calibration::residual_length(
        refined, receivers, row,
        chain.point(chain.motion(row.readings), refined.signature.targets[row.target]));
    if (row.use == RowUse::kIgnore) continue;
    const double in_sigma = outcomes[k].residual_m / sigma_of(refined, row);
    squares.add(in_sigma * in_sigma / calibration::thresholds(row).median);
  }
  const double scale = std::max(1.0, std::sqrt(squares.median()));
  for (std::size_t k = 0; k < log.size(); ++k) {
    const double in_sigma = outcomes[k].residual_m / sigma_of(refined, log[k]);
    if (in_sigma <= kOutlierFactor * scale * calibration::thresholds(log[k]).gate) continue;
    outcomes[k].weight = 0;
    outcomes[k].rejected = true;
  }
}

void summarise(std::span<const Observation> log, std::span<const RowOutcome> outcomes,
               DriftReport& report) {
  for (std::size_t k = 0; k < log.size(); ++k) {
    if (log[k].use == RowUse::kIgnore) continue;
    if (outcomes[k].rejected) {
      ++report.rows_rejected;
      continue;
    }
    const double residual = outcomes[k].residual_m;
    ++report.rows;
    report.freedom += log[k].kind == calibration::ObservationKind::kPosition ? 3 : 1;
    report.mean_m += residual;
    report.rms_m += residual * residual;
    report.largest_m = std::max(report.largest_m, residual);
  }
  if (report.rows == 0) return;
  report.mean_m /= static_cast<double>(report.rows);
  report.rms_m = std::sqrt(report.rms_m / static_cast<double>(report.rows));
}

// Minus twice the log-likelihood of that link's displacement, at its best size, that explains the
// residuals best.
struct Displacement {
  std::size_t link = 0;
  double likelihood = std::numeric_limits<double>::infinity();
};

Displacement likeliest_displacement(const Refined& refined, std::span<const Observation> log,
                                    const Receivers& receivers,
                                    std::span<const RowOutcome> outcomes,
                                    SquareRootFactor& scratch) {
  Displacement best;
  for (std::size_t link = 0; link <= refined.signature.joint_count(); ++link) {
    for (const double size : kDriftSizes) {
      displaced_prior(refined, link, size, scratch);
      const Evidence moved = evidence(refined, log, receivers, outcomes, scratch);
      const double likelihood = moved.chi_square + moved.log_determinant;
      if (likelihood < best.likelihood) best = {link, likelihood};
    }
  }
  return best;
}

}  // namespace

std::string_view describe(DriftVerdict verdict) {
  switch (verdict) {
    case DriftVerdict::kConsistent:
      return "consistent";
    case DriftVerdict::kDrifted:
      return "drifted";
    case DriftVerdict::kSensorWorse:
      return "sensor worse than stated";
  }
  return "unknown";
}

Judged<DriftReport> check_drift(const Refined& refined, std::span<const Observation> log,
                                const Receivers& receivers, std::span<RowOutcome> outcomes,
                                SquareRootFactor& scratch) {
  ARMSIG_CHECK(outcomes.size() == log.size());
  for (std::size_t k = 0; k < log.size(); ++k) {
    if (!calibration::is_finite(log[k])) {
      return std::unexpected(Refusal{Error::kNotFinite, static_cast<double>(k), 0});
    }
  }
  find_outliers(refined, log, receivers, outcomes);
  DriftReport report;
  summarise(log, outcomes, report);
  if (report.rows == 0) return std::unexpected(Refusal{Error::kTooFewPoints, 0, 1});
  const double allowed_rows =
      kRejectedShare * static_cast<double>(report.rows + report.rows_rejected);
  if (static_cast<double>(report.rows_rejected) > allowed_rows) {
    return std::unexpected(
        Refusal{Error::kTooManyOutliers, static_cast<double>(report.rows_rejected), allowed_rows});
  }

  scratch = refined.information;
  const Evidence healthy = evidence(refined, log, receivers, outcomes, scratch);
  const auto freedom = static_cast<double>(report.freedom);
  report.chi_square = healthy.chi_square;
  report.allowed = numerics::chi_square_quantile(freedom, numerics::kCheckRefused,
                                                 refined.quality.noise_freedom);
  if (report.chi_square <= report.allowed) return report;

  // Minus twice the log-likelihood of larger noise, at its best size.
  const double noise_variance = healthy.chi_square / freedom;
  const double worse_noise = freedom * (1 + std::log(noise_variance)) + healthy.log_determinant;
  const Displacement moved = likeliest_displacement(refined, log, receivers, outcomes, scratch);
  report.link = moved.link;
  const bool drifted = moved.likelihood < worse_noise;
  report.verdict = drifted ? DriftVerdict::kDrifted : DriftVerdict::kSensorWorse;
  if (!drifted) report.noise_factor = std::sqrt(noise_variance);
  return report;
}

}  // namespace armsig::drift
