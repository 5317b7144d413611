// SPDX-License-Identifier: MIT
// Weights of the touches, sigma of the instruments and scales of the priors; what the fit is worth.
#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/calibration/engine_detail.hpp"
#include "core/calibration/prior_scale.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"
#include "firmware/host_tool/diagnosis/triangle.hpp"
#include "firmware/host_tool/places/place_fit.hpp"

namespace armsig::tool {

using calibration::kKnots;
using calibration::kSplines;
using calibration::PriorGroup;

namespace {

// As in the engine (outliers.cpp): the median length of three normal coordinates, and of one; soft
// weights and rejection in robust sigma. The start is robust: two rounds of soft weights do.
constexpr double kOfThree = 1.538;
constexpr double kOfOne = 0.6745;
constexpr double kSoftSigmas = 4;
constexpr double kRejectedBeyond = 6;
constexpr int kSoftRounds = 2;
constexpr double kLeastFreeShare = 0.05;

constexpr double square_of(double x) { return x * x; }

}  // namespace

// Of a number, by the median of every instrument's residuals.
std::vector<double> PlaceFit::robust_scales() const {
  std::vector<std::vector<double>> lengths(task_.instruments.size());
  std::vector<double> numbers(task_.instruments.size(), 0);
  std::vector<double> squares(task_.touches.size(), 0);
  std::vector<std::size_t> scalars(task_.touches.size(), 0);
  for (const PlaceScalar& scalar : touches_) {
    squares[scalar.touch] += square_of(scalar.residual);
    ++scalars[scalar.touch];
  }
  for (std::size_t k = 0; k < squares.size(); ++k) {
    const std::size_t i = instrument_of(k);
    lengths[i].push_back(std::sqrt(squares[k]) / (scalars[k] == 3 ? kOfThree : kOfOne));
    numbers[i] += static_cast<double>(scalars[k]);
  }
  std::vector<double> scales;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const double free = std::max(numbers[i] - determined_[i], kLeastFreeShare * numbers[i]);
    scales.push_back(lengths[i].empty()
                         ? 1
                         : std::max(std::sqrt(calibration::kLeastVariance),
                                    median_of(lengths[i]) * std::sqrt(numbers[i] / free)));
  }
  return scales;
}

// Softly, then by rejection: every touch is judged anew in every round.
void PlaceFit::weigh() {
  const std::vector<double> scales = robust_scales();
  std::vector<double> squares(task_.touches.size(), 0);
  for (const PlaceScalar& scalar : touches_) {
    squares[scalar.touch] += square_of(scalar.residual);
  }
  std::vector<std::size_t> kept(task_.places.size(), 0);
  for (std::size_t k = 0; k < squares.size(); ++k) {
    const std::size_t i = instrument_of(k);
    const double length = std::sqrt(squares[k]);
    if (rounds_ < kSoftRounds) {
      weights_[k] = 1 / square_of(1 + square_of(length / (kSoftSigmas * scales[i])));
    } else {
      weights_[k] = length <= kRejectedBeyond * scales[i] ? 1 : 0;
    }
    kept[task_.touches[k].place] += weights_[k] > 0 ? 1U : 0U;
  }
  // A place that would lose all of its touches keeps them.
  for (std::size_t k = 0; k < squares.size(); ++k) {
    if (kept[task_.touches[k].place] == 0) weights_[k] = 1;
  }
}

void PlaceFit::invert() {
  information_ = information_there(0);
  const Eigen::LLT<Eigen::MatrixXd> factor(information_);
  covariance_ = square_of_lower(inverse_of_lower(factor.matrixLLT()));
}

void PlaceFit::foresee(const std::vector<std::size_t>& touches) {
  std::ranges::fill(weights_, 0.0);
  for (const std::size_t touch : touches) weights_[touch] = 1;
  invert();
}

void PlaceFit::update_scales() {
  std::array<PriorGroup, 4> groups{};
  const std::array<double*, 4> scales{&scales_.prior.rotation, &scales_.prior.shift,
                                      &scales_.prior.zero, &scales_.prior.gravity};
  for (Eigen::Index c = 3; c < columns_.geometry; ++c) {
    const auto kind = static_cast<std::size_t>(c - 3) % calibration::kDeviations;
    const std::size_t group = c >= columns_.gravity ? 3 : kind < 2 ? 0 : kind < 4 ? 1 : 2;
    const double unit = prior_variance(c) / *scales[group];
    groups[group].squares += square_of(x_[c]) / unit;
    groups[group].trace += covariance_(c, c) / unit;
    groups[group].unknowns += 1;
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    calibration::update_scale(groups[g], *scales[g], calibration::kUsualUnknowns);
  }
  const std::array<double, kSplines> Q = calibration::map_prior();
  for (const auto& [joint, first] : columns_.maps) {
    PriorGroup group;
    group.squares = calibration::map_prior_squares(state_.arm.joints[joint].map);
    group.unknowns = static_cast<double>(kKnots);
    for (std::size_t k = 0; k < kKnots; ++k) {
      for (std::size_t d = 0; d < kSplines; ++d) {
        const double c = covariance_(first + static_cast<Eigen::Index>(k),
                                     first + static_cast<Eigen::Index>((k + d) % kKnots));
        group.trace += (d == 0 ? 1 : 2) * Q[d] * c;
      }
    }
    calibration::update_scale(group, scales_.prior.map[joint], calibration::kUsualUnknowns);
  }
}

void PlaceFit::update_sigmas() {
  const std::size_t count = task_.instruments.size();
  std::vector<double> squares(count, 0);
  std::vector<double> numbers(count, 0);
  determined_.assign(count, 0);
  for (const PlaceScalar& scalar : touches_) {
    const double weight = weights_[scalar.touch];
    if (weight == 0) continue;
    const std::size_t i = instrument_of(scalar.touch);
    squares[i] += weight * square_of(scalar.residual);
    numbers[i] += weight;
    determined_[i] += weight * variance_by(scalar, covariance_) / variance_of(scalar);
  }
  freedom_ = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (numbers[i] == 0) continue;
    const double free = std::max(numbers[i] - determined_[i], kLeastFreeShare * numbers[i]);
    scales_.sigma_squared[i] = std::max(squares[i] / free, calibration::kLeastVariance);
    freedom_ += free;
  }
}

double PlaceFit::log_prior_information() const {
  static const double of_map = [] {
    const std::array<double, kSplines> Q = calibration::map_prior();
    const auto count = static_cast<Eigen::Index>(kKnots);
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index k = 0; k < count; ++k) {
      for (std::size_t d = 0; d < kSplines; ++d) {
        const Eigen::Index other = (k + static_cast<Eigen::Index>(d)) % count;
        P(k, other) = P(other, k) = Q[d];
      }
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(P);
    return 2 * factor.matrixLLT().diagonal().array().log().sum();
  }();
  double sum = 0;
  for (Eigen::Index c = 0; c < columns_.size; ++c) {
    if (c >= columns_.geometry && c < columns_.places) continue;
    sum -= std::log(prior_variance(c));
  }
  for (const auto& [joint, first] : columns_.maps) {
    sum += of_map - static_cast<double>(kKnots) * std::log(scales_.prior.map[joint]);
  }
  return sum;
}

// Logarithm of the evidence, as docs/model.md, section 13, has it.
void PlaceFit::conclude() {
  invert();
  const Eigen::LLT<Eigen::MatrixXd> factor(information_);
  double sum =
      cost() + 2 * factor.matrixLLT().diagonal().array().log().sum() - log_prior_information();
  for (const PlaceScalar& scalar : touches_) {
    if (weights_[scalar.touch] > 0) sum += std::log(2 * kPi * variance_of(scalar));
  }
  log_evidence_ = -sum / 2;
}

}  // namespace armsig::tool
