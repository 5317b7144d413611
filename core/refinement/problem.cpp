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
    : start_(start), log_(log), config_(config), outcomes_(outcomes), estimate_(estimate) {
  for (RowOutcome& outcome : outcomes_) outcome = {};
  // The reduced rows are tied to the readings as they are now.
  if (!config.compress_sweeps || !config.request.readings.empty()) return;
  const Chain chain(estimate_.signature, estimate_.readings);
  for (std::size_t k = 0; k < log_.size() && !sweeps_.full();) {
    const std::size_t count = sweep_length(log_, k, estimate_.readings);
    CompressedSweep sweep;
    if (count > 0 &&
        compress_sweep(log_, k, count, chain, start.types[log_[k].sweep - 1], outcomes_, sweep)) {
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

template <typename Visit>
void Problem::for_each_node(const CompressedSweep& sweep, const Chain& chain, Visit visit) const {
  JointMotion motion = chain.motion(log_[sweep.first_row].readings);
  for (int node = 0; node < 3; ++node) {
    chain.move(motion, sweep.joint, sweep.nodes[static_cast<std::size_t>(node)]);
    visit(node, motion);
  }
}

Matrix3 Problem::node_positions(const CompressedSweep& sweep, const Chain& chain) const {
  Matrix3 p_nodes;
  for_each_node(sweep, chain, [&](int node, const JointMotion& motion) {
    p_nodes.row(node) = chain.point(motion, estimate_.signature.targets[sweep.target]);
  });
  return p_nodes;
}

void Problem::evaluate() {
  const Chain chain(estimate_.signature, estimate_.readings);
  for_each_unit(
      [&](std::size_t k) {
        const Observation& row = log_[k];
        const Target& target = estimate_.signature.targets[row.target];
        outcomes_[k].residual_m = residual_length(estimate_, config_.receivers, row,
                                                  chain.point(chain.motion(row.readings), target));
      },
      [&](std::size_t s) {
        const CompressedSweep& sweep = sweeps_[s];
        const Matrix3 predicted = sweep.W * node_positions(sweep, chain);
        sweep_squares_[s] = (sweep.Z - (1 + estimate_.scale) * predicted).squaredNorm();
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
  double sum = prior_squares();
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
  const Chain chain(estimate_.signature, estimate_.readings);
  for_each_unit(
      [&](std::size_t k) {
        const Observation& row = log_[k];
        const double sigma = sigma_of(row, noise);
        const double length = outcomes_[k].residual_m / (sigma * gate_factor(row, noise));
        const double weight = robust_weight(length, thresholds(row));
        if (weight == 0) return;
        Linearised at;
        absorb_row(estimate_, config_.receivers, chain, row, std::sqrt(weight) / sigma,
                   estimate_.information, at);
        note(at.motion, estimate_.signature.targets[row.target].link, at.jacobian);
      },
      [&](std::size_t s) {
        add_sweep(sweeps_[s], chain, sweeps_[s].sigma_stated ? 1.0 : 1.0 / noise.unstated_m);
      });
}

void Problem::note(const JointMotion& motion, std::size_t link, const PointJacobian& jacobian) {
  for (std::size_t i = 0; i < link; ++i) {
    if (motion.joints[i].moved == 0) continue;
    motion_[i] = std::max(motion_[i], std::abs(motion.joints[i].moved));
    radius_[i] = std::max(radius_[i], jacobian.motion[i].norm());
  }
}

void Problem::add_sweep(const CompressedSweep& sweep, const Chain& chain, double weight) {
  const Target& target = estimate_.signature.targets[sweep.target];
  const Layout& layout = estimate_.layout;
  const double scaled = 1 + estimate_.scale;
  // The unknowns that these rows involve, in the order of the layout.
  const JointMotion at_first = chain.motion(log_[sweep.first_row].readings);
  FixedVector<std::uint8_t, kMaxParameters> columns;
  std::array<std::uint8_t, kMaxParameters> places;
  const auto involve = [&](std::size_t first, std::size_t count) {
    for (std::size_t column = first; column < first + count; ++column) {
      places[column] = static_cast<std::uint8_t>(columns.size());
      columns.push_back(static_cast<std::uint8_t>(column));
    }
  };
  for (std::size_t i = 0; i < target.link; ++i) {
    if (i != sweep.joint && at_first.joints[i].moved == 0) continue;
    involve(layout.axis[i], start_.types[i] == JointType::kRevolute ? 4 : 2);
  }
  involve(layout.target[sweep.target], 3);
  if (layout.scale != kNoColumn) involve(layout.scale, 1);
  const std::size_t right_hand_side = columns.size();

  RowBlock<9> block;
  block.clear(right_hand_side);
  Matrix3 residual = sweep.Z;
  for_each_node(sweep, chain, [&](int node, const JointMotion& motion) {
    PointJacobian jacobian;
    chain.point_and_jacobian(motion, target, jacobian);
    note(motion, target.link, jacobian);
    std::array<double, 3> weights;
    for (int k = 0; k < 3; ++k) {
      const double share = sweep.W(k, node);
      residual.row(k) -= scaled * share * jacobian.p_S;
      weights[k] = weight * scaled * share;
      if (layout.scale == kNoColumn) continue;
      for (int c = 0; c < 3; ++c) {
        block.rows[3 * k + c][places[layout.scale]] += weight * share * jacobian.p_S[c];
      }
    }
    add_derivatives(layout, estimate_.signature, chain, motion, sweep.target, jacobian, weights,
                    places, block);
  });
  for (int k = 0; k < 3; ++k) {
    for (int c = 0; c < 3; ++c) block.rows[3 * k + c][right_hand_side] = weight * residual(k, c);
  }
  estimate_.information.absorb({columns.data(), columns.size()}, block);
}

double Problem::judge_rows(const Noise& noise) {
  const Chain chain(estimate_.signature, estimate_.readings);
  FitQuality& quality = estimate_.quality;
  quality.rows_used = 0;
  quality.rows_rejected = 0;
  quality.scalars = 0;
  double squares = 0;
  double variances = 0;
  double weighted = 0;
  std::size_t next = 0;
  Matrix3 coefficients = Matrix3::Zero();  // of the present sweep
  for (std::size_t k = 0; k < log_.size(); ++k) {
    const Observation& row = log_[k];
    RowOutcome& outcome = outcomes_[k];
    while (next < sweeps_.size() && k >= sweeps_[next].first_row + sweeps_[next].row_count) ++next;
    const bool in_sweep = next < sweeps_.size() && k >= sweeps_[next].first_row;
    if (in_sweep) {
      const CompressedSweep& sweep = sweeps_[next];
      if (k == sweep.first_row) coefficients = sweep.from_nodes * node_positions(sweep, chain);
      outcome.residual_m =
          residual_length(estimate_, config_.receivers, row,
                          coefficients.transpose() * sweep_regressors(sweep, chain, row.readings));
    } else {
      outcome.residual_m = residual_length(
          estimate_, config_.receivers, row,
          chain.point(chain.motion(row.readings), estimate_.signature.targets[row.target]));
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
