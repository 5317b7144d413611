// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/base_search.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "core/numerics/rotations.hpp"
#include "firmware/analysis/starts/cube_rotations.hpp"

namespace armsig::tool {
namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

constexpr int kDescentSteps = 25;
constexpr int kRobustPasses = 4;
constexpr std::size_t kMostPlaces = 3;
constexpr double kSamePlace_rad = 0.3;
// Minima whose RMS is so many times the best one's are not worth a fit.
constexpr double kWorthTrying = 2.5;
constexpr double kRidge = 1e-7;

// The sum of squares as a quadratic in (columns of M; c; u_1, u_2, ...).
struct Normal {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  double squares = 0;
  Vector3 mean_S = Vector3::Zero();
  double weight = 0;
};

Normal normal_of(std::span<const PlacedRow> rows, std::size_t targets,
                 const std::vector<double>& weights) {
  Normal normal;
  const auto size = static_cast<Eigen::Index>(12 + 3 * targets);
  normal.H = Eigen::MatrixXd::Zero(size, size);
  normal.g = Eigen::VectorXd::Zero(size);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    normal.weight += weights[k];
    normal.mean_S += weights[k] * rows[k].p_S;
  }
  normal.mean_S /= normal.weight;
  // A row's derivatives are y_1 I, y_2 I, y_3 I, -I and -R: their products need no sum of 15 x 15.
  Eigen::Matrix4d shared = Eigen::Matrix4d::Zero();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const PlacedRow& row = rows[k];
    const Vector3 y = row.p_S - normal.mean_S;
    const Eigen::Vector4d v(y.x(), y.y(), y.z(), -1);
    const Eigen::Vector4d w = weights[k] * v;
    const auto at = static_cast<Eigen::Index>(12 + 3 * row.target);
    shared += w * v.transpose();
    for (Eigen::Index j = 0; j < 4; ++j) {
      normal.H.block<3, 3>(3 * j, at) -= w[j] * row.X_BL.R;
      normal.g.segment<3>(3 * j) += w[j] * row.X_BL.p;
    }
    normal.H.diagonal().segment<3>(at).array() += weights[k];
    normal.g.segment<3>(at) -= weights[k] * (row.X_BL.R.transpose() * row.X_BL.p);
    normal.squares += weights[k] * row.X_BL.p.squaredNorm();
  }
  for (Eigen::Index i = 0; i < 4; ++i) {
    for (Eigen::Index j = 0; j < 4; ++j) {
      normal.H.block<3, 3>(3 * i, 3 * j).diagonal().setConstant(shared(i, j));
    }
  }
  normal.H.triangularView<Eigen::StrictlyLower>() = normal.H.transpose();
  return normal;
}

// m^T S m - 2 b^T m + constant, with what is linear at its best.
struct Reduced {
  Matrix9 S;
  Vector9 b;
  double constant = 0;
  Eigen::MatrixXd from_m;  // linear unknowns = offset - from_m m
  Eigen::VectorXd offset;

  [[nodiscard]] double at(const Matrix3& M) const {
    const Vector9 m = M.reshaped();
    return m.dot(S * m) - 2 * b.dot(m) + constant;
  }
};

Reduced reduced_of(const Normal& normal) {
  const Eigen::Index linear = normal.H.rows() - 9;
  Eigen::MatrixXd L = normal.H.bottomRightCorner(linear, linear);
  L.diagonal().array() += kRidge * normal.weight;
  const Eigen::LDLT<Eigen::MatrixXd> solver(L);
  const Eigen::MatrixXd C = normal.H.bottomLeftCorner(linear, 9);
  Reduced reduced;
  reduced.from_m = solver.solve(C);
  reduced.offset = solver.solve(normal.g.tail(linear));
  reduced.S = normal.H.topLeftCorner<9, 9>() - C.transpose() * reduced.from_m;
  reduced.b = normal.g.head<9>() - C.transpose() * reduced.offset;
  reduced.constant = normal.squares - normal.g.tail(linear).dot(reduced.offset);
  return reduced;
}

void descend(const Reduced& reduced, Matrix3& M) {
  double damping = 1e-3;
  double squares = reduced.at(M);
  for (int step = 0; step < kDescentSteps; ++step) {
    Eigen::Matrix<double, 9, 3> J;
    for (Eigen::Index j = 0; j < 3; ++j) J.block<3, 3>(3 * j, 0) = -cross_matrix(M.col(j));
    const Vector9 m = M.reshaped();
    const Vector3 gradient = J.transpose() * (reduced.S * m - reduced.b);
    Matrix3 H = J.transpose() * reduced.S * J;
    H.diagonal().array() += damping * H.trace() + 1e-12;
    const Vector3 w = -H.ldlt().solve(gradient);
    if (!(w.norm() > 1e-10)) return;
    const Matrix3 next = numerics::rotation_by(w) * M;
    const double there = reduced.at(next);
    if (there < squares) {
      M = next;
      squares = there;
      damping *= 0.2;
    } else {
      damping *= 8;
    }
  }
}

BasePlace place_at(const Normal& normal, const Reduced& reduced, const Matrix3& M,
                   std::size_t targets) {
  const Vector9 m = M.reshaped();
  const Eigen::VectorXd linear = reduced.offset - reduced.from_m * m;
  BasePlace place;
  place.X_SB.R = M.transpose();
  place.X_SB.p = normal.mean_S + M.transpose() * linear.head<3>();
  for (std::size_t t = 0; t < targets; ++t) {
    place.p_LT.emplace_back(linear.segment<3>(static_cast<Eigen::Index>(3 + 3 * t)));
  }
  place.rms_m = std::sqrt(std::max(0.0, reduced.at(M)) / normal.weight);
  return place;
}

// The minima reached from `starts`, the best first, as many as are worth a fit.
std::vector<BasePlace> distinct_places(const Normal& normal, const Reduced& reduced,
                                       const std::vector<Matrix3>& starts, std::size_t targets) {
  std::vector<std::pair<double, Matrix3>> minima;
  for (Matrix3 M : starts) {
    descend(reduced, M);
    minima.emplace_back(reduced.at(M), M);
  }
  std::ranges::sort(minima, {}, [](const auto& minimum) { return minimum.first; });
  std::vector<BasePlace> places;
  for (const auto& [squares, M] : minima) {
    const bool known = std::ranges::any_of(places, [&](const BasePlace& place) {
      return angle_between(place.X_SB.R.transpose(), M) < kSamePlace_rad;
    });
    if (known) continue;
    BasePlace place = place_at(normal, reduced, M, targets);
    if (!places.empty() && place.rms_m > kWorthTrying * places.front().rms_m + 1e-3) break;
    places.push_back(std::move(place));
    if (places.size() == kMostPlaces) break;
  }
  return places;
}

// Robust weights at a place: gross outliers lose their say.
void weigh(std::span<const PlacedRow> rows, const BasePlace& place, std::vector<double>& weights) {
  std::vector<double> lengths;
  for (const PlacedRow& row : rows) {
    lengths.push_back((row.p_S - place.X_SB * (row.X_BL * place.p_LT[row.target])).norm());
  }
  std::vector<double> sorted = lengths;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  const double limit = 2 * *middle + 1e-9;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    weights[k] = std::min(1.0, std::pow(limit / lengths[k], 2));
  }
}

}  // namespace

std::vector<BasePlace> find_base(std::span<const PlacedRow> rows, std::size_t targets) {
  std::vector<BasePlace> places;
  if (rows.empty()) return places;
  std::vector<double> weights(rows.size(), 1.0);
  std::vector<Matrix3> starts;
  calibration::for_each_cube_rotation([&](const Matrix3& R) { starts.push_back(R); });
  for (int pass = 0; pass < kRobustPasses; ++pass) {
    const Normal normal = normal_of(rows, targets, weights);
    const Reduced reduced = reduced_of(normal);
    places = distinct_places(normal, reduced, starts, targets);
    weigh(rows, places.front(), weights);
    starts.clear();  // from where they are, once weights have changed
    for (const BasePlace& place : places) starts.emplace_back(place.X_SB.R.transpose());
  }
  return places;
}

}  // namespace armsig::tool
