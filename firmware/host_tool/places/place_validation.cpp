// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/place_validation.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Dense>

namespace armsig::tool {
namespace {

// One placement: its numbers, and the unknowns of its places.
struct LeftOutPlacement {
  std::vector<const PlaceScalar*> scalars;
  std::map<int, Eigen::Index> own;  // columns of its places
};

// What is left of its touches where only its places are fitted to them.
struct PlacementErrors {
  Eigen::VectorXd errors;  // places by ordinary least squares
  double squares = 0;      // whitened, places by generalised least squares
  Eigen::Index freedom = 0;
};

LeftOutPlacement placement_of(const PlaceTask& task, const PlaceFit& fit,
                              const std::vector<std::size_t>& of, std::size_t number) {
  LeftOutPlacement left;
  for (const PlaceScalar& scalar : fit.touches()) {
    const std::size_t place = task.touches[scalar.touch].place;
    if (of[place] != number || fit.weights()[scalar.touch] == 0) continue;
    left.scalars.push_back(&scalar);
    for (int c = 0; c < 3; ++c) {
      const int column = static_cast<int>(fit.columns().place(place)) + c;
      left.own.emplace(column, static_cast<Eigen::Index>(left.own.size()));
    }
  }
  return left;
}

// The information without the placement, its known lengths too.
Eigen::MatrixXd information_without(const PlaceTask& task, const PlaceFit& fit,
                                    const LeftOutPlacement& left,
                                    const std::vector<std::size_t>& of, std::size_t number,
                                    Eigen::VectorXd& gradient) {
  Eigen::MatrixXd H = fit.information();
  const auto take = [&](const PlaceScalar& scalar, double weight) {
    PlaceFit::add_squares(scalar, -weight, H);
    for (const auto& [c, value] : scalar.J) gradient[c] += weight * value * scalar.residual;
  };
  for (const PlaceScalar* scalar : left.scalars) take(*scalar, 1 / fit.variance_of(*scalar));
  for (std::size_t k = 0; k < fit.lengths().size(); ++k) {
    if (of[task.lengths[k].from] == number) take(fit.lengths()[k], 1);
  }
  return H;
}

PlacementErrors errors_of(const PlaceTask& task, const PlaceFit& fit,
                          const std::vector<std::size_t>& of, std::size_t number) {
  const LeftOutPlacement left = placement_of(task, fit, of, number);
  const auto count = static_cast<Eigen::Index>(left.scalars.size());
  const auto own = static_cast<Eigen::Index>(left.own.size());
  if (count <= own) return {};
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(fit.columns().size);
  const Eigen::LLT<Eigen::MatrixXd> factor(
      information_without(task, fit, left, of, number, gradient));
  const Eigen::VectorXd step = factor.solve(gradient);
  // Derivatives by all other unknowns, and by its own places.
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(count, fit.columns().size);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(count, own);
  Eigen::VectorXd e(count);
  Eigen::VectorXd variances(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const PlaceScalar& scalar = *left.scalars[static_cast<std::size_t>(k)];
    for (const auto& [c, value] : scalar.J) {
      if (const auto at = left.own.find(c); at != left.own.end()) {
        P(k, at->second) = value;
      } else {
        J(k, c) = value;
      }
    }
    e[k] = scalar.residual + J.row(k).dot(step);
    variances[k] = fit.variance_of(scalar);
  }
  Eigen::MatrixXd S = J * factor.solve(J.transpose());
  S.diagonal() += variances;
  PlacementErrors found;
  found.errors = e - P * (P.transpose() * P).ldlt().solve(P.transpose() * e);
  const Eigen::LLT<Eigen::MatrixXd> of_S(S);
  const Eigen::MatrixXd WP = of_S.solve(P);
  const Eigen::VectorXd We = of_S.solve(e);
  const Eigen::VectorXd c = (P.transpose() * WP).ldlt().solve(P.transpose() * We);
  found.squares = e.dot(We) - c.dot(P.transpose() * We);
  found.freedom = count - own;
  return found;
}

}  // namespace

std::optional<PlacementValidation> validate_by_placement(const PlaceTask& task,
                                                         const PlaceFit& fit) {
  const std::vector<std::size_t> of = task.placements();
  const std::size_t count = *std::ranges::max_element(of) + 1;
  PlacementValidation all;
  double squares = 0;
  double freedom = 0;
  std::vector<double> lengths;
  for (std::size_t number = 0; number < count && count > 1; ++number) {
    const LeftOutPlacement left = placement_of(task, fit, of, number);
    const PlacementErrors found = errors_of(task, fit, of, number);
    if (found.freedom == 0) continue;
    ++all.placements;
    squares += found.squares;
    freedom += static_cast<double>(found.freedom);
    std::map<std::size_t, double> of_touches;
    for (std::size_t k = 0; k < left.scalars.size(); ++k) {
      of_touches[left.scalars[k]->touch] += std::pow(found.errors[static_cast<Eigen::Index>(k)], 2);
    }
    for (const auto& [touch, square] : of_touches) lengths.push_back(std::sqrt(square));
  }
  if (all.placements < 2) return std::nullopt;
  all.touches = lengths.size();
  for (const double length : lengths) {
    all.mean_m += length / static_cast<double>(lengths.size());
    all.rms_m += length * length / static_cast<double>(lengths.size());
    all.largest_m = std::max(all.largest_m, length);
  }
  all.rms_m = std::sqrt(all.rms_m);
  all.factor = std::sqrt(std::max(1.0, squares / freedom));
  return all;
}

}  // namespace armsig::tool
