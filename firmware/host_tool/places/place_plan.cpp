// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/place_plan.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include <Eigen/Dense>

#include "firmware/host_tool/places/place_accuracy.hpp"

namespace armsig::tool {
namespace {

// Of every place: one that is wrong is named, and the place left out is predicted.
constexpr std::size_t kLeastOfAPlace = 4;
// Numbers for each unknown of geometry, tool and places.
constexpr double kLeastNumbers = 1.5;
// Of the sums by which touches are compared; what is stated is not from them.
constexpr Eigen::Index kSums = 32;
constexpr unsigned kSeed = 1;

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class TouchChoice {
 public:
  TouchChoice(const PlaceFit& none, Eigen::MatrixXd judged, std::size_t touches)
      : fit_(none), judged_(std::move(judged)), covariance_(none.covariance()), rows_(touches) {
    for (const PlaceScalar& scalar : none.touches()) rows_[scalar.touch].push_back(&scalar);
    judged_ /= std::sqrt(static_cast<double>(judged_.rows()) / 3);
    squares_ = (judged_ * covariance_).cwiseProduct(judged_).sum();
    std::mt19937 random(kSeed);
    Eigen::MatrixXd signs(kSums, judged_.rows());
    for (double& sign : signs.reshaped()) {
      sign = ((random() & 1U) != 0 ? 1 : -1) / std::sqrt(static_cast<double>(kSums));
    }
    sums_ = covariance_ * (signs * judged_).transpose();
  }

  [[nodiscard]] double rms_m() const { return std::sqrt(std::max(squares_, 0.0)); }
  [[nodiscard]] std::size_t numbers(std::size_t touch) const { return rows_[touch].size(); }

  // By how much the sums' squares fall.
  [[nodiscard]] double gain(std::size_t touch) const {
    const Rows by = times(touch, sums_);
    return innovation(touch).llt().solve(by).cwiseProduct(by).sum();
  }

  void take(std::size_t touch) {
    const Rows by = times(touch, covariance_);
    const auto factor = innovation(touch).llt();
    const Rows of_tool = by * judged_.transpose();
    squares_ -= factor.solve(of_tool).cwiseProduct(of_tool).sum();
    const Rows of_sums = times(touch, sums_);
    sums_ -= by.transpose() * factor.solve(of_sums);
    covariance_ -= by.transpose() * factor.solve(by);
  }

 private:
  // J X of a touch.
  [[nodiscard]] Rows times(std::size_t touch, const Rows& X) const {
    Rows product = Rows::Zero(static_cast<Eigen::Index>(rows_[touch].size()), X.cols());
    for (std::size_t i = 0; i < rows_[touch].size(); ++i) {
      for (const auto& [column, value] : rows_[touch][i]->J) {
        product.row(static_cast<Eigen::Index>(i)) += value * X.row(column);
      }
    }
    return product;
  }

  // J C J^T and the noise.
  [[nodiscard]] Eigen::MatrixXd innovation(std::size_t touch) const {
    const auto& rows = rows_[touch];
    const auto size = static_cast<Eigen::Index>(rows.size());
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(size, size);
    for (Eigen::Index i = 0; i < size; ++i) {
      for (Eigen::Index j = 0; j < size; ++j) {
        for (const auto& [a, value] : rows[static_cast<std::size_t>(i)]->J) {
          for (const auto& [b, other] : rows[static_cast<std::size_t>(j)]->J) {
            S(i, j) += value * other * covariance_(a, b);
          }
        }
      }
      S(i, i) += fit_.variance_of(*rows[static_cast<std::size_t>(i)]);
    }
    return S;
  }

  const PlaceFit& fit_;
  Eigen::MatrixXd judged_;
  Rows covariance_;
  Rows sums_;  // C L^T by random signs
  double squares_ = 0;
  std::vector<std::vector<const PlaceScalar*>> rows_;
};

// Numbers that a fit of these places should have.
std::size_t least_numbers(const PlaceTask& task) {
  return static_cast<std::size_t>(
      kLeastNumbers * static_cast<double>(3 * task.places.size() + 4 * task.nominal.joints.size()));
}

}  // namespace

PlacePlan plan_touches(const PlaceLayout& layout, double sigma_m, double accuracy_m,
                       std::size_t most) {
  const PlaceTask& task = layout.task;
  const PlaceScales scales = expected_scales(task, sigma_m);
  PlaceFit fit(task, nominal_state(task), {}, &scales);
  fit.foresee({});
  TouchChoice choice(fit, judged_tool(fit, layout.judged), task.touches.size());
  PlacePlan plan;
  std::vector<bool> taken(task.touches.size(), false);
  std::vector<std::size_t> of_place(task.places.size(), 0);
  std::size_t numbers = 0;
  // The first touches of a place only tell where it is: they come before the choice.
  const auto comes_first = [&](std::size_t k) {
    return !taken[k] && of_place[task.touches[k].place] < kLeastOfAPlace;
  };
  for (;;) {
    bool first = false;
    for (std::size_t k = 0; k < taken.size() && !first; ++k) first = comes_first(k);
    plan.is_whole = !first && choice.rms_m() <= accuracy_m && numbers >= least_numbers(task);
    if (plan.is_whole || plan.touches.size() == most) break;
    std::size_t best = taken.size();
    double most_gain = -1;
    for (std::size_t k = 0; k < taken.size(); ++k) {
      if (first ? !comes_first(k) : taken[k]) continue;
      const double gain = choice.gain(k);
      if (gain > most_gain) std::tie(most_gain, best) = std::pair(gain, k);
    }
    if (best == taken.size()) break;
    choice.take(best);
    taken[best] = true;
    ++of_place[task.touches[best].place];
    numbers += choice.numbers(best);
    plan.touches.push_back(best);
    plan.expected_rms_m.push_back(choice.rms_m());
  }
  return plan;
}

}  // namespace armsig::tool
