// SPDX-License-Identifier: MIT
#include "core/calibration/chain.hpp"

#include <cmath>

#include "core/base/sine_cosine.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::calibration {

PoeChain::PoeChain(const Signature& signature, const ReadingModel& readings)
    : readings_(readings), types_(signature.types), X_SL_(signature.X_SL) {
  const std::size_t n = types_.size();
  ARMSIG_CHECK(X_SL_.size() == n + 1 && signature.configuration.size() == n);
  ARMSIG_CHECK(readings.corrections.empty() || readings.corrections.size() == n);
  const Deflections at_rest =
      deflections_at(readings_, readings_for(readings_.couplings, signature.configuration));
  for (std::size_t i = 0; i < n; ++i) {
    const double effective = signature.configuration[i];
    configuration_[i] = {effective, corrected_reading(readings_, i, effective) + at_rest[i]};
  }
}

JointMotion PoeChain::motion(const JointVector& readings) const {
  ARMSIG_CHECK(readings.size() == types_.size());
  JointMotion motion;
  const JointVector coupled = effective_readings(readings_.couplings, readings);
  const Deflections deflections = deflections_at(readings_, readings);
  for (std::size_t i = 0; i < types_.size(); ++i) {
    JointMotion::One& one = motion.joints[i];
    one.coupled = coupled[i];
    one.moved =
        corrected_reading(readings_, i, coupled[i]) + deflections[i] - configuration_[i].corrected;
    if (types_[i] != JointType::kRevolute) continue;
    const SineCosine turn = sine_and_cosine(one.moved);
    one.cosine = turn.cosine;
    one.sine = turn.sine;
  }
  return motion;
}

template <typename Visit>
Vector3 PoeChain::carry(const JointMotion& motion, const Target& target, Visit visit) const {
  Vector3 p = target.p_S;
  for (std::size_t i = target.link; i-- > 0;) {
    const JointMotion::One& joint = motion.joints[i];
    if (joint.moved == 0) continue;
    const Vector3 r = X_SL_[i].R.transpose() * (p - X_SL_[i].p);
    Vector3 v(r.x(), r.y(), r.z() + joint.moved);
    if (types_[i] == JointType::kRevolute) {
      v = {joint.cosine * r.x() - joint.sine * r.y(), joint.sine * r.x() + joint.cosine * r.y(),
           r.z()};
    }
    visit(i, r, v);
    p = X_SL_[i] * v;
  }
  return p;
}

Vector3 PoeChain::point(const JointMotion& motion, const Target& target) const {
  return carry(motion, target, [](std::size_t, const Vector3&, const Vector3&) {});
}

void PoeChain::point_and_jacobian(const JointMotion& motion, const Target& target,
                                  PointJacobian& jacobian) const {
  // Inward: the target in the link frame of each moving joint before (r) and after (v) its motion.
  std::array<Vector3, kMaxJoints> r;
  std::array<Vector3, kMaxJoints> v;
  jacobian.p_S =
      carry(motion, target, [&](std::size_t i, const Vector3& before, const Vector3& after) {
        r[i] = before;
        v[i] = after;
      });

  // Outward: the rotation by the joints so far, and the derivatives taken in the link frame as they
  // hold it. A revolute joint moves r to a + R (r - a); turning its axis by w adds
  // w x (R r) - R (w x r), shifting it by t adds t - R t.
  Matrix3 turned = Matrix3::Identity();
  for (std::size_t i = 0; i < target.link; ++i) {
    const JointMotion::One& joint = motion.joints[i];
    if (joint.moved == 0) continue;
    Matrix3 R_SF = turned.lazyProduct(X_SL_[i].R);
    if (types_[i] == JointType::kRevolute) {
      const Vector3 x = R_SF.col(0);
      const Vector3 y = R_SF.col(1);
      const Vector3 x_turned = joint.cosine * x + joint.sine * y;
      const Vector3 y_turned = joint.cosine * y - joint.sine * x;
      const double along = r[i].z();
      jacobian.axis[i].col(0) = along * (y_turned - y) + (v[i].y() - r[i].y()) * R_SF.col(2);
      jacobian.axis[i].col(1) = along * (x - x_turned) + (r[i].x() - v[i].x()) * R_SF.col(2);
      jacobian.axis[i].col(2) = x - x_turned;
      jacobian.axis[i].col(3) = y - y_turned;
      jacobian.motion[i] = v[i].x() * y - v[i].y() * x;
      R_SF.col(0) = x_turned;
      R_SF.col(1) = y_turned;
    } else {
      jacobian.axis[i].col(0) = -joint.moved * R_SF.col(1);
      jacobian.axis[i].col(1) = joint.moved * R_SF.col(0);
      jacobian.motion[i] = R_SF.col(2);
    }
    turned = R_SF.lazyProduct(X_SL_[i].R.transpose());
  }
  jacobian.target = turned;
}

void add_derivatives(const Layout& layout, const Signature& signature, const PoeChain& chain,
                     const JointMotion& motion, std::size_t target, const PointJacobian& jacobian,
                     RowBlock<3>& block) {
  const std::size_t link = signature.targets[target].link;
  for (std::size_t column = 0; column < layout.size(); ++column) {
    const Parameter& parameter = layout.parameters[column];
    const std::size_t i = parameter.index;
    const Eigen::Index component = parameter.component;
    const bool moves = i < link && motion.joints[i].moved != 0;
    Vector3 derivative = Vector3::Zero();
    if (of_reading(parameter) && moves) {
      // Zero at the signature configuration: there every correction is part of the axis lines.
      const double turn = turn_by(parameter, motion.joints[i].coupled) -
                          turn_by(parameter, chain.coupled_configuration(i));
      derivative = turn * jacobian.motion[i];
    } else if (parameter.kind == ParameterKind::kAxisDirection && moves) {
      derivative = jacobian.axis[i].col(component);
    } else if (parameter.kind == ParameterKind::kAxisPosition && moves) {
      derivative = jacobian.axis[i].col(2 + component);
    } else if (parameter.kind == ParameterKind::kTarget && i == target) {
      derivative = jacobian.target.col(component);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      block.rows[c][column] += derivative[static_cast<Eigen::Index>(c)];
    }
  }
}

void apply_corrections(const Layout& layout, const StateVector& x, double fraction,
                       Signature& signature, ReadingModel& readings) {
  const std::size_t n = signature.joint_count();
  const Pose X_last = signature.X_SL[n - 1].inverse() * signature.X_SL[n];
  for (std::size_t i = 0; i < n; ++i) {
    Pose& X = signature.X_SL[i];
    const std::size_t axis = layout.axis[i];
    if (signature.types[i] == JointType::kRevolute) {
      X.p += fraction * (X.R.col(0) * x[axis + 2] + X.R.col(1) * x[axis + 3]);
    }
    X.R = X.R * numerics::rotation_by(fraction * Vector3(x[axis], x[axis + 1], 0));
  }
  signature.X_SL[n] = signature.X_SL[n - 1] * X_last;
  for (std::size_t c = 0; c < layout.size(); ++c) {
    const Parameter& parameter = layout.parameters[c];
    if (of_reading(parameter) && !readings.corrections.empty()) {
      readings.corrections[parameter.index].*term_of(parameter) += fraction * x[c];
    } else if (parameter.kind == ParameterKind::kTarget) {
      signature.targets[parameter.index].p_S[parameter.component] += fraction * x[c];
    }
  }
}

}  // namespace armsig::calibration
