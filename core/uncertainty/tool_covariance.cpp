// SPDX-License-Identifier: MIT
#include "core/uncertainty/tool_covariance.hpp"

#include <cmath>

namespace armsig::uncertainty {

using refinement::Chain;
using refinement::JointMotion;
using refinement::PointJacobian;
using refinement::Refined;
using refinement::RowBlock;
using refinement::StateVector;

namespace {

Matrix3 covariance_at(const Refined& refined, const Chain& chain, const JointVector& readings,
                      std::size_t target) {
  const std::size_t n = refined.layout.size();
  const JointMotion motion = chain.motion(readings);
  PointJacobian jacobian;
  chain.point_and_jacobian(motion, refined.signature.targets[target], jacobian);
  RowBlock<3> block;
  block.clear(n);
  refinement::add_derivatives<3>(refined.layout, refined.signature, chain, motion, target, jacobian,
                                 Matrix3::Identity(), block);
  std::array<StateVector, 3> y;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t c = 0; c < n; ++c) y[k][c] = block.rows[k][c];
    refined.information.solve_transposed(y[k]);
  }
  Matrix3 covariance;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      double sum = 0;
      for (std::size_t c = 0; c < n; ++c) sum += y[i][c] * y[j][c];
      covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = sum;
    }
  }
  return covariance;
}

// The van der Corput sequence in base `base`: element k of an even cover of (0, 1).
double radical_inverse(std::size_t k, std::size_t base) {
  double inverse = 0;
  double digit = 1;
  for (; k > 0; k /= base) {
    digit /= static_cast<double>(base);
    inverse += digit * static_cast<double>(k % base);
  }
  return inverse;
}

}  // namespace

Matrix3 tool_covariance(const Refined& refined, const JointVector& readings, std::size_t target) {
  return covariance_at(refined, Chain(refined.signature, refined.readings), readings, target);
}

Vector3 tool_position(const Refined& refined, const JointVector& readings, std::size_t target) {
  const Chain chain(refined.signature, refined.readings);
  return chain.point(chain.motion(readings), refined.signature.targets[target]);
}

JointVector spread_configuration(std::span<const JointLimits> limits, std::size_t index) {
  constexpr std::array<std::size_t, kMaxJoints> kPrimes{2, 3, 5, 7, 11, 13, 17, 19};
  // The first elements of the larger bases run along a diagonal; later ones do not.
  constexpr std::size_t kSkipped = 20;
  JointVector readings;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const double share = radical_inverse(index + kSkipped, kPrimes[i]);
    readings.push_back(limits[i].lower + share * (limits[i].upper - limits[i].lower));
  }
  return readings;
}

double predicted_rms(const Refined& refined, std::span<const JointLimits> limits,
                     std::size_t target, std::size_t count) {
  const Chain chain(refined.signature, refined.readings);
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k) {
    sum += covariance_at(refined, chain, spread_configuration(limits, k), target).trace();
  }
  return std::sqrt(sum / static_cast<double>(count));
}

}  // namespace armsig::uncertainty
