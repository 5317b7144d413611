// SPDX-License-Identifier: MIT
#include "core/uncertainty/tool_covariance.hpp"

#include <cmath>

#include "core/arm_model/model.hpp"
#include "core/base/low_discrepancy.hpp"

namespace armsig::uncertainty {

using refinement::Chain;
using refinement::JointMotion;
using refinement::PointJacobian;
using refinement::Refined;
using refinement::RowBlock;
using refinement::StateVector;

namespace {

// What the maps of the readings leave open.
Matrix3 of_maps(const Refined& refined, const JointMotion& motion, const PointJacobian& jacobian,
                const JointVector& readings, std::size_t target) {
  Matrix3 covariance = Matrix3::Zero();
  for (std::size_t i = 0; i < refined.signature.targets[target].link; ++i) {
    if (motion.joints[i].moved == 0) continue;
    const calibration::JointModel& joint = refined.readings.deflections->joints[i];
    covariance += calibration::map_variance_at(joint, readings[i]) * jacobian.motion[i] *
                  jacobian.motion[i].transpose();
  }
  return covariance;
}

Matrix3 covariance_at(const Refined& refined, const Chain& chain, const JointVector& readings,
                      std::size_t target) {
  const std::size_t n = refined.layout.size();
  const JointMotion motion = chain.motion(readings);
  PointJacobian jacobian;
  chain.point_and_jacobian(motion, refined.signature.targets[target], jacobian);
  RowBlock<3> block;
  block.clear(n);
  refinement::add_derivatives(refined.layout, refined.signature, chain, motion, target, jacobian,
                              1.0, block);
  std::array<StateVector, 3> y;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t c = 0; c < n; ++c) y[k][c] = block.rows[k][c];
    refined.information.solve_transposed(y[k]);
  }
  const double unexplained_m = refined.quality.unexplained_m;
  Matrix3 covariance = unexplained_m * unexplained_m * Matrix3::Identity();
  if (refined.readings.deflections != nullptr)
    covariance += of_maps(refined, motion, jacobian, readings, target);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      double sum = 0;
      for (std::size_t c = 0; c < n; ++c) sum += y[i][c] * y[j][c];
      covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) += sum;
    }
  }
  return covariance;
}

}  // namespace

Matrix3 tool_covariance(const Refined& refined, const JointVector& readings, std::size_t target) {
  return covariance_at(refined, Chain(refined.signature, refined.readings), readings, target);
}

JointVector work_configuration(const FixedVector<JointType, kMaxJoints>& types,
                               const FixedVector<JointLimits, kMaxJoints>& limits, int n) {
  // The first elements of the larger bases run along a diagonal; later ones do not.
  constexpr int kSkipped = 19;
  return evenly_spread_configuration(types, limits, n + kSkipped);
}

Vector3 tool_position(const Refined& refined, const JointVector& readings, std::size_t target) {
  const Chain chain(refined.signature, refined.readings);
  return chain.point(chain.motion(readings), refined.signature.targets[target]);
}

double predicted_rms(const Refined& refined, const FixedVector<JointLimits, kMaxJoints>& limits,
                     std::size_t target, int count) {
  const Chain chain(refined.signature, refined.readings);
  double sum = 0;
  for (int k = 1; k <= count; ++k) {
    const JointVector readings = work_configuration(refined.signature.types, limits, k);
    sum += covariance_at(refined, chain, readings, target).trace();
  }
  return std::sqrt(sum / count);
}

}  // namespace armsig::uncertainty
