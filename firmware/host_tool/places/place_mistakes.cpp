// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/place_mistakes.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace armsig::tool {
namespace {

constexpr double kFits = 6;  // sigma, as of a touch that is not rejected
// Of a push: the least advantage in nats, and the least touches before and after it.
constexpr double kWorthPush = 40;
constexpr std::size_t kTouchesBeside = 3;
constexpr Eigen::Index kMotions = 6;

using Motion = Eigen::Matrix<double, kMotions, 1>;
using MotionSquares = Eigen::Matrix<double, kMotions, kMotions>;

// How a turn and a shift of the arm move a point.
Eigen::Matrix<double, 3, kMotions> moved_by(const Vector3& p_B) {
  Eigen::Matrix<double, 3, kMotions> by;
  for (Eigen::Index c = 0; c < 3; ++c) {
    by.col(c) = Vector3::Unit(c).cross(p_B);
    by.col(3 + c) = Vector3::Unit(c);
  }
  return by;
}

// Sums over the touches after a step, whitened.
struct AfterStep {
  explicit AfterStep(Eigen::Index unknowns) : with_fit(Eigen::MatrixXd::Zero(unknowns, kMotions)) {}

  void add(const PlaceScalar& scalar, const Motion& by_motion, double weight) {
    squares += weight * by_motion * by_motion.transpose();
    pull -= weight * scalar.residual * by_motion;
    for (const auto& [c, value] : scalar.J) with_fit.row(c) += weight * value * by_motion;
  }
  // What the fit leaves of the squares.
  [[nodiscard]] MotionSquares left(const Eigen::MatrixXd& covariance) const {
    return squares - with_fit.transpose() * covariance * with_fit;
  }

  MotionSquares squares = MotionSquares::Zero();
  Motion pull = Motion::Zero();
  Eigen::MatrixXd with_fit;
};

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

std::optional<BasePush> find_push(const PlaceTask& task, const PlaceFit& fit) {
  AfterStep after(fit.columns().size);
  double squares = 0;
  double numbers = 0;
  for (const PlaceScalar& scalar : fit.touches()) {
    const double weight = fit.weights()[scalar.touch] / fit.variance_of(scalar);
    squares += weight * scalar.residual * scalar.residual;
    numbers += fit.weights()[scalar.touch];
  }
  std::optional<BasePush> found;
  double most = kWorthPush;
  std::size_t end = fit.touches().size();
  MotionSquares moved = MotionSquares::Zero();
  for (std::size_t k = task.touches.size(); k-- > kTouchesBeside;) {
    const TouchRow& touch = task.touches[k];
    const Vector3 p_B = fit.state().tool_at(touch.q);
    const TouchedPlace& at = fit.state().places[touch.place];
    const InstrumentRow row =
        instrument_row(at, fit.state().scales[at.instrument], p_B, touch.length_m);
    const Eigen::Matrix<double, 3, kMotions> by = moved_by(p_B);
    moved += by.transpose() * by;
    end -= static_cast<std::size_t>(row.scalars);
    for (Eigen::Index i = 0; i < row.scalars && fit.weights()[k] > 0; ++i) {
      const PlaceScalar& scalar = fit.touches()[end + static_cast<std::size_t>(i)];
      after.add(scalar, (row.by_point.row(i) * by).transpose(), 1 / fit.variance_of(scalar));
    }
    const std::size_t count = task.touches.size() - k;
    if (count < kTouchesBeside) continue;
    const Motion step = after.left(fit.covariance()).ldlt().solve(after.pull);
    const double gain = std::clamp(step.dot(after.pull) / squares, 0.0, 1 - 1e-9);
    const double nats = -numbers / 2 * std::log(1 - gain) - kMotions / 2.0 * std::log(numbers) -
                        std::log(static_cast<double>(task.touches.size()));
    if (!(nats > most)) continue;
    most = nats;
    found = BasePush{touch.line, std::sqrt(step.dot(moved * step) / static_cast<double>(count))};
  }
  return found;
}

std::optional<double> gain_off(const PlaceFit& fit, std::size_t instrument) {
  const Eigen::Index column = fit.columns().scales[instrument];
  if (column < 0) return std::nullopt;
  const double variance = fit.prior_variance(column) - fit.covariance()(column, column);
  if (!(variance > 0)) return std::nullopt;
  return fit.state().scales[instrument].gain / std::sqrt(variance);
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
