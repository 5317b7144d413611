// SPDX-License-Identifier: MIT
#include "firmware/host_tool/reading/range_scale.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "core/measurement/range_fit.hpp"
#include "core/numerics/quantiles.hpp"
#include "firmware/host_tool/reading/ranging.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kMostScales = 4096;
constexpr std::size_t kFewestScales = 12;
constexpr std::size_t kFewestRanges = 4;
constexpr int kScaleSteps = 6;
// A row whose geometry leaves its factor more open says nothing.
constexpr double kLargestSigma = 0.02;
// Factors beyond it are no air's: 60 K.
constexpr double kLargestExcess = 0.1;
constexpr double kHuberOfScale = 3;
constexpr int kRobustRounds = 20;
// Chance gives a few; what is named is far beyond that.
constexpr double kEvidenceOfScale = 40;
// Mean loss of the rows about the polynomial; 1 where the noise is as stated.
constexpr double kExplainedLoss = 4;
constexpr double kWorkshopAirCelsius = 20;
constexpr double kIcePointKelvin = 273.15;

using Coefficients = Eigen::Vector3d;
using Vector4 = Eigen::Matrix<double, 4, 1>;
using Matrix4 = Eigen::Matrix<double, 4, 4>;

measurement::Spheres spheres_of(const MeasurementRow& row, const SensorDescription& sensor,
                                double scale) {
  measurement::Spheres spheres;
  const double sigma_m = row.sigma_m.value_or(sensor.range_sigma_m);
  for (std::size_t k = 0; k < row.ranges_m.size(); ++k) {
    if (!row.ranges_m[k]) continue;
    spheres.push_back({.centre_S = sensor.receivers_S[k],
                       .radius_m = scale * *row.ranges_m[k],
                       .sigma_m = std::hypot(sigma_m, sensor.unknown_offset_m)});
  }
  return spheres;
}

bool faces_targets(const SensorDescription& sensor, const Vector3& p_S) {
  if (!sensor.facing_S) return true;
  Vector3 centre_S = Vector3::Zero();
  for (const Vector3& receiver_S : sensor.receivers_S) centre_S += receiver_S;
  centre_S /= static_cast<double>(sensor.receivers_S.size());
  return (p_S - centre_S).dot(*sensor.facing_S) > 0;
}

// Where the ranges nearly meet, on the side of the receivers where targets are.
std::optional<Vector3> start_of(const measurement::Spheres& spheres,
                                const SensorDescription& sensor) {
  std::optional<Vector3> best_S;
  double least = 0;
  for (const measurement::PointFit& fit : measurement::fit_point(spheres)) {
    if (!fit.p_S.allFinite() || !faces_targets(sensor, fit.p_S)) continue;
    if (best_S && fit.chi_square >= least) continue;
    best_S = fit.p_S;
    least = fit.chi_square;
  }
  return best_S;
}

struct PointAndScale {
  double excess = 0;
  double sigma = 0;
  double chi_square = 0;
};

// Gauss-Newton on the point and the factor: measured is (1 + excess) times the distance.
std::optional<PointAndScale> point_and_scale(const measurement::Spheres& spheres, Vector3 p_S) {
  PointAndScale found;
  for (int step = 0; step < kScaleSteps; ++step) {
    Matrix4 H = Matrix4::Zero();
    Vector4 g = Vector4::Zero();
    found.chi_square = 0;
    for (const measurement::Sphere& sphere : spheres) {
      const Vector3 way = p_S - sphere.centre_S;
      const double distance_m = way.norm();
      Vector4 row;
      row << (1 + found.excess) * way / distance_m, distance_m;
      row /= sphere.sigma_m;
      const double left = (sphere.radius_m - (1 + found.excess) * distance_m) / sphere.sigma_m;
      H += row * row.transpose();
      g += row * left;
      found.chi_square += left * left;
    }
    const Eigen::LDLT<Matrix4> factor(H);
    const Vector4 change = factor.solve(g);
    if (!change.allFinite()) return std::nullopt;
    found.sigma = std::sqrt(factor.solve(Vector4::Unit(3))[3]);
    if (step + 1 == kScaleSteps) break;
    p_S += change.head<3>();
    found.excess += change[3];
  }
  return found;
}

bool is_usable(const PointAndScale& found, std::size_t ranges) {
  if (!(found.sigma < kLargestSigma) || !(std::abs(found.excess) < kLargestExcess)) return false;
  const std::size_t freedom = ranges - kFewestRanges;
  return freedom == 0 || found.chi_square < numerics::kChiSquare9999[freedom - 1];
}

double huber_loss(double in_sigma) {
  const double size = std::abs(in_sigma);
  return size < kHuberOfScale ? size * size : kHuberOfScale * (2 * size - kHuberOfScale);
}

double place_of(std::size_t line, std::size_t first, std::size_t last) {
  const double span = std::max(1.0, static_cast<double>(last) - static_cast<double>(first));
  return 2 * (static_cast<double>(line) - static_cast<double>(first)) / span - 1;
}

Coefficients polynomials(double place) { return {1, place, (3 * place * place - 1) / 2}; }

}  // namespace

double RangeScale::excess(std::size_t line) const {
  const Coefficients values = polynomials(place_of(line, first_line, last_line));
  return Coefficients(coefficients.data()).dot(values);
}

bool RangeScale::drifts() const { return evidence_of_drift > kEvidenceOfScale; }

// Ranges were computed for air of one speed of sound and flew in air of another: they are too long
// by the ratio, which goes with the root of the absolute temperature.
double RangeScale::warmer_k(std::size_t line) const {
  return (kIcePointKelvin + first_air_c) * (std::pow(1 + excess(line), -2) - 1);
}

std::string RangeScale::in_words() const {
  const double first_ppm = 1e6 * excess(first_line);
  if (!drifts()) {
    return fmt::format(
        "all ranges are too long by {:+.0f} ppm, as in air {:+.1f} K warmer than they were "
        "computed for",
        first_ppm, warmer_k(first_line));
  }
  return fmt::format(
      "the ranges are too long by {:+.0f} ppm in line {} and by {:+.0f} ppm in line {}, as in air "
      "that has grown {:+.1f} K warmer, where air_c says {:+.1f} K",
      first_ppm, first_line, 1e6 * excess(last_line), last_line,
      warmer_k(last_line) - warmer_k(first_line), last_air_c - first_air_c);
}

void RangeScaleFit::add(const MeasurementRow& row, double scale) {
  if (passed_++ % stride_ != 0 || row.ranges_m.size() != sensor_.receivers_S.size()) return;
  const measurement::Spheres spheres = spheres_of(row, sensor_, scale);
  if (spheres.size() < kFewestRanges) return;
  const auto start_S = start_of(spheres, sensor_);
  if (!start_S) return;
  const auto found = point_and_scale(spheres, *start_S);
  if (!found || !is_usable(*found, spheres.size())) return;
  if (rows_.empty()) first_line_ = row.line;
  last_line_ = row.line;
  if (!first_air_c_) first_air_c_ = row.air_c;
  if (row.air_c) last_air_c_ = row.air_c;
  rows_.push_back({.line = row.line, .excess = found->excess, .sigma = found->sigma});
  if (rows_.size() == kMostScales) thin();
}

void RangeScaleFit::thin() {
  for (std::size_t k = 0; 2 * k < rows_.size(); ++k) rows_[k] = rows_[2 * k];
  rows_.resize(rows_.size() / 2);
  stride_ *= 2;
}

std::optional<CommonRangeScale> RangeScaleFit::common() const {
  if (rows_.size() < kFewestScales) return std::nullopt;
  CommonRangeScale scale;
  for (int round = 0; round < kRobustRounds; ++round) {
    double weights = 0;
    double sum = 0;
    for (const RowScale& row : rows_) {
      const double left = std::abs(row.excess - scale.excess) / row.sigma;
      const double weight = kHuberOfScale / std::max(kHuberOfScale, left) / (row.sigma * row.sigma);
      weights += weight;
      sum += weight * row.excess;
    }
    scale = {.excess = sum / weights, .sigma = 1 / std::sqrt(weights)};
  }
  return scale;
}

// NOLINTNEXTLINE(readability-function-size): one fit, its steps in their order
std::optional<RangeScale> RangeScaleFit::result() const {
  if (rows_.size() < kFewestScales) return std::nullopt;
  // The polynomial of so many terms, by Huber's weights; what is lost about it.
  const auto fitted = [&](int terms, Coefficients& x) {
    x.setZero();
    double lost = 0;
    for (int round = 0; round <= kRobustRounds; ++round) {
      Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
      Eigen::Vector3d g = Eigen::Vector3d::Zero();
      lost = 0;
      for (const RowScale& row : rows_) {
        const Coefficients values = polynomials(place_of(row.line, first_line_, last_line_));
        const double left = (row.excess - values.dot(x)) / row.sigma;
        lost += huber_loss(left);
        const double weight =
            std::min(1.0, kHuberOfScale / std::max(kHuberOfScale, std::abs(left))) /
            (row.sigma * row.sigma);
        H += weight * values * values.transpose();
        g += weight * values * row.excess;
      }
      if (terms == 0 || round == kRobustRounds) break;
      const Eigen::VectorXd solved = H.topLeftCorner(terms, terms).ldlt().solve(g.head(terms));
      x.head(terms) = solved;
    }
    return lost;
  };
  Coefficients none;
  Coefficients one;
  Coefficients all;
  const double lost_without = fitted(0, none);
  const double lost_by_one = fitted(1, one);
  const double lost_by_all = fitted(3, all);
  const auto count = static_cast<double>(rows_.size());
  const double of_a_term = std::log(count) / 2;
  RangeScale scale{.first_line = first_line_,
                   .last_line = last_line_,
                   .evidence = (lost_without - lost_by_one) / 2 - of_a_term,
                   .evidence_of_drift = (lost_by_one - lost_by_all) / 2 - 2 * of_a_term,
                   .first_air_c = first_air_c_.value_or(kWorkshopAirCelsius),
                   .last_air_c = last_air_c_.value_or(kWorkshopAirCelsius)};
  const bool drifts = scale.drifts();
  if (!drifts && scale.evidence < kEvidenceOfScale) return std::nullopt;
  if ((drifts ? lost_by_all : lost_by_one) > kExplainedLoss * count) return std::nullopt;
  const Coefficients& best = drifts ? all : one;
  std::ranges::copy(best, scale.coefficients.begin());
  return scale;
}

}  // namespace armsig::tool
