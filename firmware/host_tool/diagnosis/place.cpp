// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/place.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/SVD>

#include "core/calibration/chain.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kFewestPairs = 4;
constexpr int kPlacePasses = 12;
constexpr double kLeastMedian_m = 1e-9;

struct Pair {
  Vector3 seen;
  Vector3 predicted;
};

std::vector<double> lengths_of(const std::vector<Pair>& pairs, const Pose& X) {
  std::vector<double> lengths;
  for (const Pair& pair : pairs) lengths.push_back((X * pair.seen - pair.predicted).norm());
  return lengths;
}

// The rigid motion of the seen points onto the predicted ones (Kabsch).
Pose aligned(const std::vector<Pair>& pairs, const std::vector<double>& weights) {
  Vector3 seen = Vector3::Zero();
  Vector3 predicted = Vector3::Zero();
  double sum = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    sum += weights[k];
    seen += weights[k] * pairs[k].seen;
    predicted += weights[k] * pairs[k].predicted;
  }
  seen /= sum;
  predicted /= sum;
  Matrix3 H = Matrix3::Zero();
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    H += weights[k] * (pairs[k].seen - seen) * (pairs[k].predicted - predicted).transpose();
  }
  const Eigen::JacobiSVD<Matrix3> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sense = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0 ? -1 : 1;
  const Matrix3 R = svd.matrixV() * Vector3(1, 1, sense).asDiagonal() * svd.matrixU().transpose();
  return {.R = R, .p = predicted - R * seen};
}

}  // namespace

std::optional<Place> fit_place(const calibration::Refined& estimate,
                               std::span<const calibration::Observation> positions) {
  const calibration::PoeChain chain(estimate.signature, estimate.readings);
  std::vector<Pair> pairs;
  Vector3 middle = Vector3::Zero();
  for (const calibration::Observation& row : positions) {
    if (row.kind != calibration::ObservationKind::kPosition) continue;
    pairs.push_back(
        {row.p_S, chain.point(chain.motion(row.readings), estimate.signature.targets[row.target])});
    middle += row.p_S;
  }
  if (pairs.size() < kFewestPairs) return std::nullopt;
  middle /= static_cast<double>(pairs.size());
  Place place;
  place.before_m = median_of(lengths_of(pairs, {}));
  std::vector<double> weights(pairs.size(), 1.0);
  for (int pass = 0; pass < kPlacePasses; ++pass) {
    place.X_ON = aligned(pairs, weights);
    const std::vector<double> lengths = lengths_of(pairs, place.X_ON);
    place.after_m = median_of(lengths);
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const double in_median = lengths[k] / std::max(kLeastMedian_m, place.after_m);
      weights[k] = 1 / (1 + in_median * in_median);
    }
  }
  place.shift_m = (place.X_ON * middle - middle).norm();
  place.turn_rad = angle_between(place.X_ON.R, Matrix3::Identity());
  return place;
}

}  // namespace armsig::tool
