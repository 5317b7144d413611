// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/place_mistakes.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace armsig::tool {
namespace {

constexpr double kFits = 6;  // sigma, as of a touch that is not rejected

double off_by(const PlaceTask& task, const PlaceFit& fit, const TouchRow& touch,
              std::size_t place) {
  const TouchedPlace& at = fit.state().places[place];
  const WireScale& scale = fit.state().scales[task.places[place].instrument];
  return instrument_row(at, scale, fit.state().tool_at(touch.q), touch.length_m).residual.norm();
}

// Length `k` by those believed but itself: `off` is what the touches alone have beyond the known
// ones, with covariance S.
void predict_length(const Eigen::MatrixXd& S, const Eigen::VectorXd& off,
                    const std::vector<Eigen::Index>& believed, Eigen::Index k,
                    const SocketLength& known, PredictedLength& length) {
  std::vector<Eigen::Index> others;
  for (const Eigen::Index other : believed) {
    if (other != k) others.push_back(other);
  }
  double expected = 0;
  double variance = S(k, k);
  if (!others.empty()) {
    const Eigen::VectorXd between = S(others, k);
    const Eigen::MatrixXd among = S(others, others);
    const Eigen::VectorXd gain = among.llt().solve(between);
    expected = gain.dot(Eigen::VectorXd(off(others)));
    variance -= gain.dot(between);
  }
  length.length_m = known.length_m + off[k] - expected;
  length.sigma_m = std::sqrt(std::max(variance - known.sigma_m * known.sigma_m, 0.0));
  length.off = (expected - off[k]) / std::sqrt(variance);
}

}  // namespace

std::vector<RejectedTouch> rejected_touches(const PlaceTask& task, const PlaceFit& fit) {
  std::vector<RejectedTouch> rejected;
  for (std::size_t k = 0; k < task.touches.size(); ++k) {
    if (fit.weights()[k] > 0) continue;
    const TouchRow& touch = task.touches[k];
    RejectedTouch found{touch.line, touch.place, off_by(task, fit, touch, touch.place), {}};
    double nearest = 0;
    for (std::size_t s = 0; s < task.places.size(); ++s) {
      if (task.places[s].instrument != task.places[touch.place].instrument) continue;
      const double sigma = std::sqrt(fit.scales().sigma_squared[task.places[s].instrument]);
      const double off = off_by(task, fit, touch, s);
      if (off > kFits * sigma || (found.fits && off >= nearest)) continue;
      nearest = off;
      found.fits = s;
    }
    rejected.push_back(found);
  }
  return rejected;
}

std::vector<PredictedLength> predicted_lengths(const PlaceTask& task, const PlaceFit& free) {
  const auto count = static_cast<Eigen::Index>(task.lengths.size());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(count, free.columns().size);
  Eigen::VectorXd off(count);
  std::vector<PredictedLength> all(task.lengths.size());
  for (Eigen::Index k = 0; k < count; ++k) {
    const SocketLength& known = task.lengths[static_cast<std::size_t>(k)];
    const auto& places = free.state().places;
    const LengthRow row = length_row(places[known.from], places[known.to], known.length_m);
    off[k] = row.residual_m;
    for (Eigen::Index c = 0; c < 3; ++c) {
      J(k, free.columns().place(known.to) + c) = row.by_second[c];
      J(k, free.columns().place(known.from) + c) = -row.by_second[c];
    }
  }
  Eigen::MatrixXd S = J * free.covariance() * J.transpose();
  for (Eigen::Index k = 0; k < count; ++k) {
    S(k, k) += std::pow(task.lengths[static_cast<std::size_t>(k)].sigma_m, 2);
  }
  std::vector<Eigen::Index> believed;
  for (Eigen::Index k = 0; k < count; ++k) believed.push_back(k);
  for (;;) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      predict_length(S, off, believed, static_cast<Eigen::Index>(k), task.lengths[k], all[k]);
    }
    const auto worst = std::ranges::max_element(believed, {}, [&](Eigen::Index k) {
      return std::abs(all[static_cast<std::size_t>(k)].off);
    });
    if (believed.size() < 2) break;
    PredictedLength& most = all[static_cast<std::size_t>(*worst)];
    if (std::abs(most.off) <= kContradictingLength) break;
    most.believed = false;
    believed.erase(worst);
  }
  return all;
}

}  // namespace armsig::tool
