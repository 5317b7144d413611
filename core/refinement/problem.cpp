// SPDX-License-Identifier: MIT
#include "core/refinement/problem.hpp"

#include <cmath>

#include "core/refinement/robust.hpp"
#include "core/refinement/row.hpp"

namespace armsig::refinement {

namespace {

// 1 sigma of a row as the problem uses it.
double sigma_of(const Observation& row, const Noise& noise) {
  return row.sigma_m > 0 ? row.sigma_m : noise.unstated_m;
}

// Sigmas are compared with the robust scale: stated ones are widened by what the residuals show.
double gate_factor(const Observation& row, const Noise& noise) {
  return row.sigma_m > 0 ? noise.stated_factor : 1.0;
}

// A noise of exactly zero (noiseless data) would divide by zero; a picometre is below any sensor.
constexpr double kLeastNoise_m = 1e-12;

}  // namespace

Problem::Problem(const Signature& start, std::span<const Observation> log,
                 const RefinementConfig& config, std::span<RowOutcome> outcomes, Refined& estimate)
    : start_(start),
      log_(log),
      config_(config),
      outcomes_(outcomes),
      estimate_(estimate),
      chain_(estimate.signature, estimate.readings) {
  for (RowOutcome& outcome : outcomes_) outcome = {};
  // The reduced rows are tied to the readings as they are now.
  if (!config.compress_sweeps || !config.request.readings.empty()) return;
  for (std::size_t k = 0; k < log_.size() && !sweeps_.full();) {
    const std::size_t count = sweep_length(log_, k, estimate_.readings);
    // A joint beyond the target's link does not move it: no path.
    const bool moved = log_[k].sweep <= start.targets[log_[k].target].link;
    CompressedSweep sweep;
    if (count > 0 && moved &&
        compress_sweep(log_, k, count, chain_, start.types[log_[k].sweep - 1], outcomes_, sweep)) {
      sweeps_.push_back(sweep);
    }
    k += std::max<std::size_t>(count, 1);
  }
  sweep_squares_.resize(sweeps_.size());
}

template <typename Single, typename Sweep>
void Problem::for_each_unit(Single single, Sweep sweep) const {
  std::size_t next = 0;
  for (std::size_t k = 0; k < log_.size(); ++k) {
    if (next < sweeps_.size() && sweeps_[next].first_row == k) {
      sweep(next);
      k += sweeps_[next].row_count - 1;
      ++next;
    } else if (log_[k].use == RowUse::kFit) {
      single(k);
    }
  }
}

void Problem::evaluate() {
  chain_ = Chain(estimate_.signature, estimate_.readings);
  evaluate_priors();
  for_each_unit(
      [&](std::size_t k) {
        const Observation& row = log_[k];
        const Target& target = estimate_.signature.targets[row.target];
        outcomes_[k].residual_m = residual_length(
            estimate_, config_.receivers, row, chain_.point(chain_.motion(row.readings), target));
      },
      [&](std::size_t s) {
        const CompressedSweep& sweep = sweeps_[s];
        sweep_squares_[s] = sweep_residual(sweep, path_of(sweep)).squaredNorm();
      });
}

Noise Problem::noise() const {
  LogHistogram stated;
  LogHistogram unstated;
  std::size_t scalars = 0;
  for_each_unit(
      [&](std::size_t k) {
        const Observation& row = log_[k];
        const double squares = outcomes_[k].residual_m * outcomes_[k].residual_m;
        const double unit = thresholds(row).median;
        scalars += row.kind == ObservationKind::kPosition ? 3 : 1;
        if (row.sigma_m > 0) {
          stated.add(squares / (unit * row.sigma_m * row.sigma_m));
        } else {
          unstated.add(squares / unit);
        }
      },
      [&](std::size_t s) {
        // Reduced rows keep only their mean square: it stands for each of them.
        const CompressedSweep& sweep = sweeps_[s];
        const auto numbers = static_cast<double>(3 * sweep.used);
        const double mean = (sweep.residual_squares + sweep_squares_[s]) / numbers;
        (sweep.sigma_stated ? stated : unstated).add(mean, sweep.used);
        scalars += 3 * sweep.used;
      });
  // Fitted residuals are smaller than the noise by the unknowns they were fitted with.
  const auto rows = static_cast<double>(scalars);
  const auto unknowns = static_cast<double>(estimate_.layout.size());
  const double freedom = rows / std::max(rows - unknowns, 0.1 * rows);
  return {std::max(1.0, std::sqrt(stated.median() * freedom)),
          std::max(kLeastNoise_m, std::sqrt(unstated.median() * freedom))};
}

double Problem::cost(const Noise& noise) const {
  double sum = 0;
  for (std::size_t i = 0; i < estimate_.layout.size(); ++i) {
    sum += prior_residuals_[i] * prior_residuals_[i];
  }
  for_each_unit(
      [&](std::size_t k) {
        const Observation& row = log_[k];
        const double factor = gate_factor(row, noise);
        const double length = outcomes_[k].residual_m / sigma_of(row, noise);
        sum += factor * factor * robust_loss(length / factor, thresholds(row));
      },
      [&](std::size_t s) {
        const double sigma = sweeps_[s].sigma_stated ? 1.0 : noise.unstated_m;
        sum += sweep_squares_[s] / (sigma * sigma);
      });
  return sum;
}

void Problem::linearise(const Noise& noise) {
  estimate_.information.reset(estimate_.layout.size());
  motion_.fill(0);
  radius_.fill(0);
  add_priors();
  for_each_unit(
      [&](std::size_t k) {
        const Observation& row = log_[k];
        const double sigma = sigma_of(row, noise);
        const double length = outcomes_[k].residual_m / (sigma * gate_factor(row, noise));
        const double weight = robust_weight(length, thresholds(row));
        if (weight == 0) return;
        Linearised at;
        absorb_row(estimate_, config_.receivers, chain_, row, std::sqrt(weight) / sigma,
                   estimate_.information, at);
        for (std::size_t i = 0; i < estimate_.signature.targets[row.target].link; ++i) {
          if (const double moved = at.motion.joints[i].moved; moved != 0) {
            note(i, moved, at.jacobian.motion[i].norm());
          }
        }
      },
      [&](std::size_t s) {
        add_sweep(sweeps_[s], sweeps_[s].sigma_stated ? 1.0 : 1.0 / noise.unstated_m);
      });
}

void Problem::note(std::size_t joint, double moved, double radius) {
  motion_[joint] = std::max(motion_[joint], std::abs(moved));
  radius_[joint] = std::max(radius_[joint], radius);
}

double Problem::judge_rows(const Noise& noise) {
  FitQuality& quality = estimate_.quality;
  quality.rows_used = 0;
  quality.rows_rejected = 0;
  quality.scalars = 0;
  double squares = 0;
  double variances = 0;
  double weighted = 0;
  std::size_t next = 0;
  for (std::size_t k = 0; k < log_.size(); ++k) {
    const Observation& row = log_[k];
    RowOutcome& outcome = outcomes_[k];
    while (next < sweeps_.size() && k >= sweeps_[next].first_row + sweeps_[next].row_count) ++next;
    const bool in_sweep = next < sweeps_.size() && k >= sweeps_[next].first_row;
    if (in_sweep) {
      const CompressedSweep& sweep = sweeps_[next];
      if (k == sweep.first_row) {
        const SweptPath path = path_of(sweep);
        Matrix3 path_S = path.rows * path.X_SF.R.transpose();
        path_S.row(0) += path.X_SF.p;
        sweep_residuals(log_.subspan(k, sweep.row_count), sweep, chain_,
                        (1 + estimate_.scale) * path_S, outcomes_.subspan(k, sweep.row_count));
      }
    } else {
      outcome.residual_m = residual_length(
          estimate_, config_.receivers, row,
          chain_.point(chain_.motion(row.readings), estimate_.signature.targets[row.target]));
    }
    const double sigma = sigma_of(row, noise);
    if (!in_sweep || row.use != RowUse::kFit) {
      outcome.weight =
          robust_weight(outcome.residual_m / (sigma * gate_factor(row, noise)), thresholds(row));
      outcome.rejected = outcome.weight == 0;
    }
    if (row.use != RowUse::kFit) continue;
    if (outcome.rejected) {
      ++quality.rows_rejected;
      continue;
    }
    ++quality.rows_used;
    quality.scalars += row.kind == ObservationKind::kPosition ? 3 : 1;
    squares += outcome.residual_m * outcome.residual_m;
    variances += sigma * sigma;
    weighted += outcome.weight * outcome.residual_m * outcome.residual_m / (sigma * sigma);
    if (!(row.sigma_m > 0)) quality.sigma_is_estimated = true;
  }
  if (quality.rows_used == 0) return 0;
  quality.rms_m = std::sqrt(squares / static_cast<double>(quality.rows_used));
  quality.sigma_m = std::sqrt(variances / static_cast<double>(quality.rows_used));
  return weighted;
}

}  // namespace armsig::refinement
