// SPDX-License-Identifier: MIT
#include "firmware/analysis/uncertainty/tool_covariance.hpp"

#include <cmath>

#include "core/base/low_discrepancy.hpp"
#include "core/calibration/model.hpp"
#include "core/calibration/row.hpp"

namespace armsig::uncertainty {

using calibration::PoeChain;
using calibration::Refined;

namespace {

// What the joint error maps leave open.
Matrix3 of_maps(const Refined& refined, const calibration::Linearised& at,
                const JointVector& readings, std::size_t target) {
  Matrix3 covariance = Matrix3::Zero();
  for (std::size_t i = 0; i < refined.signature.targets[target].link; ++i) {
    if (at.motion.joints[i].moved == 0) continue;
    const calibration::JointModel& joint = refined.readings.deflections->joints[i];
    covariance += calibration::map_variance_at(joint, readings[i]) * at.jacobian.motion[i] *
                  at.jacobian.motion[i].transpose();
  }
  return covariance;
}

Matrix3 covariance_at(const Refined& refined, const PoeChain& chain, const JointVector& readings,
                      std::size_t target) {
  calibration::RowBlock<3> rows;
  const calibration::Linearised at =
      calibration::position_rows(refined, chain, readings, target, rows);
  const double unexplained_m = refined.quality.unexplained_m;
  Matrix3 covariance = unexplained_m * unexplained_m * Matrix3::Identity();
  if (refined.readings.deflections != nullptr) covariance += of_maps(refined, at, readings, target);
  return covariance + refined.information.covariance(rows);
}

}  // namespace

Matrix3 tool_covariance(const Refined& refined, const JointVector& readings, std::size_t target) {
  return covariance_at(refined, PoeChain(refined.signature, refined.readings), readings, target);
}

Vector3 tool_position(const Refined& refined, const JointVector& readings, std::size_t target) {
  const PoeChain chain(refined.signature, refined.readings);
  return chain.point(chain.motion(readings), refined.signature.targets[target]);
}

double predicted_rms(const Refined& refined, const FixedVector<JointLimits, kMaxJoints>& limits,
                     std::size_t target, int count) {
  const PoeChain chain(refined.signature, refined.readings);
  double sum = 0;
  for (int k = 1; k <= count; ++k) {
    const JointVector readings = work_configuration(refined.signature.types, limits, k);
    sum += covariance_at(refined, chain, readings, target).trace();
  }
  return std::sqrt(sum / count);
}

}  // namespace armsig::uncertainty
