// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/place_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

using calibration::kDeviations;
using calibration::kKnots;
using calibration::kSplines;

namespace {

// 1 sigma of the priors, as docs/model.md, section 8, has them.
constexpr double kTool_m = 0.3;
constexpr double kFarAway_m = 3;
constexpr double kRotation = 2e-3;
constexpr double kShift_m = 1e-3;
constexpr double kZero = 10e-3;
constexpr double kExactGain = 1e-6;  // much less is rounding beside what touches tell
// Lengths of the proximal term where the prior is no measure of a step.
constexpr double kProximal_m = 5e-3;
constexpr int kMostTries = 7;
constexpr double kGoodGain = 0.75;
constexpr double kPoorGain = 0.25;
// When the rounds end.
constexpr int kLeastRounds = 4;
constexpr double kHarmlessStep = 0.03;
constexpr double kHarmlessChange = 0.002;

constexpr double squared(double x) { return x * x; }

}  // namespace

PlaceFit::PlaceFit(const PlaceTask& task, const PlaceState& start, const PlaceParts& parts,
                   const PlaceScales* scales)
    : task_(task),
      state_(start),
      parts_(parts),
      columns_(task, state_, parts),
      rows_(task, state_, columns_),
      x_(Eigen::VectorXd::Zero(columns_.size)),
      weights_(task.touches.size(), 1.0),
      determined_(task.instruments.size(), 0.0) {
  for (Eigen::Index c = 0; c < 3; ++c) x_[c] = state_.tool.p_L[c] - task.tool_F[c];
  for (Eigen::Index c = 3; c < columns_.gravity; ++c) {
    const auto k = static_cast<std::size_t>(c - 3);
    x_[c] = state_.arm.joints[k / kDeviations].deviation[k % kDeviations];
  }
  for (Eigen::Index c = columns_.gravity; c < columns_.geometry; ++c) {
    x_[c] = state_.arm.gravity[static_cast<std::size_t>(c - columns_.gravity)].coefficient;
  }
  for (const auto& [joint, first] : columns_.maps) {
    for (std::size_t k = 0; k < kKnots; ++k) {
      x_[first + static_cast<Eigen::Index>(k)] = state_.arm.joints[joint].map[k];
    }
  }
  for (std::size_t i = 0; i < columns_.scales.size(); ++i) {
    if (columns_.scales[i] < 0) continue;
    x_[columns_.scales[i]] = state_.scales[i].gain;
    x_[columns_.scales[i] + 1] = state_.scales[i].zero_m - task.instruments[i].zero_m;
  }
  linearise();
  if (scales != nullptr) {
    scales_ = *scales;
  } else {
    // From above: what tool and places alone leave.
    for (const double scale : robust_scales()) scales_.sigma_squared.push_back(squared(scale));
  }
}

double PlaceFit::prior_variance(Eigen::Index column) const {
  if (column < 3) return usual_variance(column);
  if (column < columns_.gravity) {
    const auto kind = static_cast<std::size_t>(column - 3) % kDeviations;
    const calibration::Scales& prior = scales_.prior;
    return usual_variance(column) * (kind < 2   ? prior.rotation
                                     : kind < 4 ? prior.shift
                                                : prior.zero);
  }
  if (column < columns_.geometry) {
    const auto& term = state_.arm.gravity[static_cast<std::size_t>(column - columns_.gravity)];
    return scales_.prior.gravity *
           squared(calibration::map_unit(state_.arm.joints[term.joint].type));
  }
  for (std::size_t i = 0; i < columns_.scales.size(); ++i) {
    const Instrument& instrument = task_.instruments[i];
    if (column == columns_.scales[i]) return squared(std::max(instrument.gain_sigma, kExactGain));
    if (columns_.scales[i] >= 0 && column == columns_.scales[i] + 1) {
      return squared(instrument.zero_sigma_m);
    }
  }
  return squared(kFarAway_m);
}

double PlaceFit::usual_variance(Eigen::Index column) {
  if (column < 3) return squared(kTool_m);
  const auto kind = static_cast<std::size_t>(column - 3) % kDeviations;
  return squared(kind < 2 ? kRotation : kind < 4 ? kShift_m : kZero);
}

double PlaceFit::proximal_variance(Eigen::Index column) const {
  const bool held = column >= 3 && column < columns_.geometry;
  return squared(trust_) * (held ? prior_variance(column) : squared(kProximal_m));
}

double PlaceFit::variance_of(const PlaceScalar& scalar) const {
  return scales_.sigma_squared[instrument_of(scalar.touch)];
}

std::size_t PlaceFit::rejected() const {
  return static_cast<std::size_t>(std::ranges::count(weights_, 0.0));
}

void PlaceFit::linearise() {
  touches_ = rows_.touches();
  lengths_ = rows_.lengths();
}

void PlaceFit::add_squares(const PlaceScalar& scalar, double weight, Eigen::MatrixXd& matrix) {
  for (std::size_t a = 0; a < scalar.J.size(); ++a) {
    const auto [i, value] = scalar.J[a];
    for (std::size_t b = a; b < scalar.J.size(); ++b) {
      const auto [j, other] = scalar.J[b];
      matrix(std::max(i, j), std::min(i, j)) += weight * value * other;
    }
  }
}

double PlaceFit::variance_by(const PlaceScalar& scalar, const Eigen::MatrixXd& covariance) {
  double sum = 0;
  for (const auto& [i, value] : scalar.J) {
    for (const auto& [j, other] : scalar.J) sum += value * other * covariance(i, j);
  }
  return sum;
}

// The lower triangle; `trust` above zero: with the proximal term.
Eigen::MatrixXd PlaceFit::information_there(double trust) const {
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(columns_.size, columns_.size);
  for (const PlaceScalar& scalar : touches_) {
    if (weights_[scalar.touch] == 0) continue;
    add_squares(scalar, weights_[scalar.touch] / variance_of(scalar), H);
  }
  for (const PlaceScalar& scalar : lengths_) add_squares(scalar, 1, H);
  const std::array<double, kSplines> Q = calibration::map_prior();
  for (const auto& [joint, first] : columns_.maps) {
    for (std::size_t k = 0; k < kKnots; ++k) {
      for (std::size_t d = 0; d < kSplines; ++d) {
        const auto i = first + static_cast<Eigen::Index>(k);
        const auto j = first + static_cast<Eigen::Index>((k + d) % kKnots);
        H(std::max(i, j), std::min(i, j)) += Q[d] / scales_.prior.map[joint];
      }
    }
  }
  for (Eigen::Index c = 0; c < columns_.size; ++c) {
    if (c >= columns_.geometry && c < columns_.places) continue;
    H(c, c) += 1 / prior_variance(c);
    if (trust > 0) H(c, c) += 1 / proximal_variance(c);
  }
  return H;
}

// Of the cost's fall, by the unknowns.
Eigen::VectorXd PlaceFit::gradient() const {
  Eigen::VectorXd g = Eigen::VectorXd::Zero(columns_.size);
  const auto pull = [&](const PlaceScalar& scalar, double weight) {
    for (const auto& [c, value] : scalar.J) g[c] -= weight * value * scalar.residual;
  };
  for (const PlaceScalar& scalar : touches_) {
    pull(scalar, weights_[scalar.touch] / variance_of(scalar));
  }
  for (const PlaceScalar& scalar : lengths_) pull(scalar, 1);
  for (Eigen::Index c = 0; c < columns_.size; ++c) {
    if (c >= columns_.geometry && c < columns_.places) continue;
    g[c] -= x_[c] / prior_variance(c);
  }
  for (const auto& [joint, first] : columns_.maps) {
    for (std::size_t k = 0; k < kKnots; ++k) {
      g[first + static_cast<Eigen::Index>(k)] -=
          calibration::map_prior_times(state_.arm.joints[joint].map, k) / scales_.prior.map[joint];
    }
  }
  return g;
}

double PlaceFit::prior_squares() const {
  double sum = 0;
  for (Eigen::Index c = 0; c < columns_.size; ++c) {
    if (c >= columns_.geometry && c < columns_.places) continue;
    sum += squared(x_[c]) / prior_variance(c);
  }
  for (const auto& [joint, first] : columns_.maps) {
    sum += calibration::map_prior_squares(state_.arm.joints[joint].map) / scales_.prior.map[joint];
  }
  return sum;
}

double PlaceFit::cost() const {
  double sum = prior_squares();
  const std::vector<double> residuals = rows_.touch_residuals();
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    sum += weights_[touches_[k].touch] * squared(residuals[k]) / variance_of(touches_[k]);
  }
  for (const double residual : rows_.length_residuals()) sum += squared(residual);
  return sum;
}

// One step, as long as the cost allows.
void PlaceFit::descend() {
  const Eigen::VectorXd g = gradient();
  const double before = cost();
  // Kept, for a step back is no way back: the directions in which a plane tilts turn with it.
  const PlaceState kept = state_;
  for (int tries = 0; tries < kMostTries; ++tries) {
    const Eigen::LLT<Eigen::MatrixXd> factor(information_there(trust_));
    const Eigen::VectorXd step = factor.solve(g);
    rows_.move(step, 1);
    x_ += step;
    const double after = cost();
    double squares = 0;
    for (const PlaceScalar& scalar : touches_) {
      squares += squared(scalar.times(step)) / variance_of(scalar);
    }
    moved_ = std::sqrt(squares / static_cast<double>(touches_.size()));
    if (after <= before) {
      const Eigen::VectorXd H_step = information_there(0).selfadjointView<Eigen::Lower>() * step;
      const double expected = 2 * step.dot(g) - step.dot(H_step);
      const double gain = (before - after) / std::max(expected, 1e-300);
      trust_ *= gain > kGoodGain ? 3 : gain < kPoorGain ? 0.5 : 1;
      break;
    }
    state_ = kept;
    x_ -= step;
    trust_ /= 5;
  }
  linearise();
}

void PlaceFit::round() {
  std::vector<double> before = scales_.sigma_squared;
  weigh();
  descend();
  invert();
  update_scales();
  update_sigmas();
  ++rounds_;
  converged_ = rounds_ >= kLeastRounds && moved_ < kHarmlessStep;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double change = std::abs(std::log(scales_.sigma_squared[i] / before[i]));
    converged_ = converged_ && change < kHarmlessChange;
  }
}

void PlaceFit::run(int most_rounds) {
  while (rounds_ < most_rounds && !converged_) round();
  weigh();
  descend();
  invert();
  update_sigmas();
  conclude();
}

}  // namespace armsig::tool
