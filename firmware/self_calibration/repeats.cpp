// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/repeats.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace armsig::controller {
namespace {

using Numbers = FixedVector<double, Repeats::kMost>;

constexpr double kCommon = 6;          // sigmas of a median
constexpr double kMedianSigma = 1.25;  // of it, over that of the mean
// What a common shift must explain to be what it was, of the median length.
constexpr double kExplains = 0.6;

double median_of(Numbers numbers) {
  // By insertion: they are few.
  for (auto at = numbers.begin(); at != numbers.end(); ++at) {
    std::rotate(std::upper_bound(numbers.begin(), at, *at), at, at + 1);
  }
  const std::size_t half = numbers.size() / 2;
  return numbers.size() % 2 == 1 ? numbers[half] : (numbers[half - 1] + numbers[half]) / 2;
}

}  // namespace

void Repeats::add(const Matrix3& R_SL, const Vector3& difference_S, double variance_m2) {
  all_.push_back({difference_S, R_SL.transpose() * difference_S, variance_m2});
}

Repeats::Change Repeats::change(double wrong, double least_m) const {
  if (all_.empty()) return {};
  struct Common {
    std::string_view what;
    Vector3 One::* in;
    Vector3 shift = Vector3::Zero();
    double left_m = 0;
  };
  std::array<Common, 2> commons{{{"target", &One::in_hand}, {"sensor", &One::in_sensor}}};
  Numbers beyond_m;
  Numbers variances;
  for (const One& one : all_) {
    variances.push_back(one.variance_m2);
    if (is_beyond_chance(one.in_sensor, one.variance_m2)) beyond_m.push_back(one.in_sensor.norm());
  }
  for (Common& common : commons) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      Numbers coordinates;
      for (const One& one : all_) coordinates.push_back((one.*common.in)(axis));
      common.shift(axis) = median_of(coordinates);
    }
    Numbers left;
    for (const One& one : all_) left.push_back((one.*common.in - common.shift).norm());
    common.left_m = median_of(left);
  }
  const Common& likelier = commons[0].left_m <= commons[1].left_m ? commons[0] : commons[1];
  const double shift_m = likelier.shift.norm();
  const double sigma_m =
      kMedianSigma * std::sqrt(median_of(variances) / static_cast<double>(all_.size()));
  const double expected = static_cast<double>(all_.size()) * wrong;
  const double chance = expected + 4 * std::sqrt(expected * (1 - wrong)) + 1;
  const double by_m = beyond_m.empty() ? 0 : median_of(beyond_m);
  const bool singly = static_cast<double>(beyond_m.size()) > chance && by_m > least_m;
  const bool together = shift_m > kCommon * sigma_m && shift_m > least_m;
  if (together && (!singly || likelier.left_m < kExplains * shift_m)) {
    return {likelier.what, shift_m};
  }
  return singly ? Change{"arm", by_m} : Change{};
}

}  // namespace armsig::controller
