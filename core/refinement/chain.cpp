// SPDX-License-Identifier: MIT
#include "core/refinement/chain.hpp"

#include <cmath>

#include "core/base/sine_cosine.hpp"

namespace armsig::refinement {

namespace {

// The joint's own motion of a vector given in its link frame.
Vector3 turned(const JointMotion::One& joint, const Vector3& v) {
  return {joint.cosine * v.x() - joint.sine * v.y(), joint.sine * v.x() + joint.cosine * v.y(),
          v.z()};
}

}  // namespace

Chain::Chain(const Signature& signature, const ReadingModel& readings)
    : readings_(readings), types_(signature.types), X_SL_(signature.X_SL) {
  const std::size_t n = types_.size();
  ARMSIG_CHECK(X_SL_.size() == n + 1 && signature.configuration.size() == n);
  ARMSIG_CHECK(readings.corrections.empty() || readings.corrections.size() == n);
  for (std::size_t i = 0; i < n; ++i) {
    const double effective = signature.configuration[i];
    configuration_[i] = {effective, corrected_reading(readings_, i, effective)};
    B_[i] = X_SL_[i].inverse() * X_SL_[i + 1];
  }
}

JointMotion Chain::motion(const JointVector& readings) const {
  ARMSIG_CHECK(readings.size() == types_.size());
  JointMotion motion;
  const JointVector coupled = effective_readings(readings_.couplings, readings);
  for (std::size_t i = 0; i < types_.size(); ++i) {
    motion.joints[i].coupled = coupled[i];
    move(motion, i, corrected_reading(readings_, i, coupled[i]) - configuration_[i].corrected);
  }
  return motion;
}

double Chain::motion_of(std::size_t joint, const JointVector& readings) const {
  double coupled = readings[joint];
  for (const JointCoupling& coupling : readings_.couplings) {
    if (coupling.joint == joint) coupled += coupling.ratio * readings[coupling.from];
  }
  return corrected_reading(readings_, joint, coupled) - configuration_[joint].corrected;
}

void Chain::move(JointMotion& motion, std::size_t joint, double moved) const {
  JointMotion::One& one = motion.joints[joint];
  one.moved = moved;
  // A joint at rest keeps the exact cosine and sine of zero, so that its derivatives are exact
  // zeros that cost nothing in the filter.
  const bool turns = types_[joint] == JointType::kRevolute && moved != 0;
  const SineCosine turn = turns ? sine_and_cosine(moved) : SineCosine{};
  one.cosine = turn.cosine;
  one.sine = turn.sine;
}

Vector3 Chain::point(const JointMotion& motion, const Target& target) const {
  Vector3 p = X_SL_[target.link - 1].R.transpose() * (target.p_S - X_SL_[target.link - 1].p);
  for (std::size_t i = target.link; i-- > 0;) {
    if (types_[i] == JointType::kRevolute) {
      p = turned(motion.joints[i], p);
    } else {
      p.z() += motion.joints[i].moved;
    }
    if (i > 0) p = B_[i - 1] * p;
  }
  return X_SL_[0] * p;
}

void Chain::point_and_jacobian(const JointMotion& motion, const Target& target,
                               PointJacobian& jacobian) const {
  const std::size_t link = target.link;
  // Inward: the target in each link frame before (r) and after (v) the joint's own motion.
  std::array<Vector3, kMaxJoints> r;
  std::array<Vector3, kMaxJoints> v;
  r[link - 1] = X_SL_[link - 1].R.transpose() * (target.p_S - X_SL_[link - 1].p);
  for (std::size_t i = link; i-- > 0;) {
    if (types_[i] == JointType::kRevolute) {
      v[i] = turned(motion.joints[i], r[i]);
    } else {
      v[i] = r[i] + Vector3(0, 0, motion.joints[i].moved);
    }
    if (i > 0) r[i - 1] = B_[i - 1] * v[i];
  }
  jacobian.p_S = X_SL_[0] * v[0];

  // Outward: the rotation of each link frame, and the derivatives taken in it. A revolute joint
  // moves r to a + R (r - a); turning its axis by w adds w x (R r) - R (w x r), shifting it by t
  // adds t - R t.
  Matrix3 R_SF = X_SL_[0].R;
  bool moved = false;  // until a joint has, the frames are those of the signature configuration
  for (std::size_t i = 0; i < link; ++i) {
    const JointMotion::One& joint = motion.joints[i];
    moved = moved || joint.moved != 0;
    if (joint.moved == 0) {
      // At rest: all its derivatives vanish, and its frame is not turned.
    } else if (types_[i] == JointType::kRevolute) {
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
    if (i + 1 < link) R_SF = moved ? R_SF.lazyProduct(B_[i].R).eval() : X_SL_[i + 1].R;
  }
  jacobian.target.noalias() = R_SF.lazyProduct(X_SL_[link - 1].R.transpose());
}

Pose Chain::displacement(const JointMotion& motion, std::size_t link) const {
  Pose X = X_SL_[0];
  for (std::size_t i = 0; i < link; ++i) {
    if (types_[i] == JointType::kRevolute) {
      const JointMotion::One& joint = motion.joints[i];
      const Vector3 x = X.R.col(0);
      X.R.col(0) = joint.cosine * x + joint.sine * X.R.col(1);
      X.R.col(1) = joint.cosine * X.R.col(1) - joint.sine * x;
    } else {
      X.p += motion.joints[i].moved * X.R.col(2);
    }
    if (i + 1 < link) X = X * B_[i];
  }
  return X * X_SL_[link - 1].inverse();
}

template <int kRows>
void add_derivatives(const Layout& layout, const Signature& signature, const Chain& chain,
                     const JointMotion& motion, std::size_t target, const PointJacobian& jacobian,
                     const Eigen::Matrix<double, kRows, 3>& gradient, RowBlock<kRows>& block) {
  const auto add = [&](std::size_t column, const Vector3& derivative) {
    const Eigen::Matrix<double, kRows, 1> scalars = gradient * derivative;
    for (int k = 0; k < kRows; ++k) block.rows[k][column] += scalars[k];
  };
  const std::size_t link = signature.targets[target].link;
  for (std::size_t i = 0; i < link; ++i) {
    const JointMotion::One& joint = motion.joints[i];
    if (joint.moved == 0) continue;
    const int count = signature.types[i] == JointType::kRevolute ? 4 : 2;
    for (int c = 0; c < count; ++c) {
      add(layout.axis[i] + static_cast<std::size_t>(c), jacobian.axis[i].col(c));
    }
    // Zero at the signature configuration: there every correction is part of the axis lines.
    const double q = joint.coupled;
    const double q_s = chain.coupled_configuration(i);
    if (layout.gain[i] != kNoColumn) add(layout.gain[i], (q - q_s) * jacobian.motion[i]);
    if (layout.first[i] != kNoColumn) {
      add(layout.first[i], (std::cos(q) - std::cos(q_s)) * jacobian.motion[i]);
      add(layout.first[i] + 1, (std::sin(q) - std::sin(q_s)) * jacobian.motion[i]);
    }
    if (layout.second[i] != kNoColumn) {
      add(layout.second[i], (std::cos(2 * q) - std::cos(2 * q_s)) * jacobian.motion[i]);
      add(layout.second[i] + 1, (std::sin(2 * q) - std::sin(2 * q_s)) * jacobian.motion[i]);
    }
  }
  if (layout.target[target] != kNoColumn) {
    for (int c = 0; c < 3; ++c) {
      add(layout.target[target] + static_cast<std::size_t>(c), jacobian.target.col(c));
    }
  }
}

template void add_derivatives<1>(const Layout&, const Signature&, const Chain&, const JointMotion&,
                                 std::size_t, const PointJacobian&,
                                 const Eigen::Matrix<double, 1, 3>&, RowBlock<1>&);
template void add_derivatives<3>(const Layout&, const Signature&, const Chain&, const JointMotion&,
                                 std::size_t, const PointJacobian&,
                                 const Eigen::Matrix<double, 3, 3>&, RowBlock<3>&);
template void add_derivatives<9>(const Layout&, const Signature&, const Chain&, const JointMotion&,
                                 std::size_t, const PointJacobian&,
                                 const Eigen::Matrix<double, 9, 3>&, RowBlock<9>&);

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
    const Vector3 turn = fraction * Vector3(x[axis], x[axis + 1], 0);
    if (const double angle = turn.norm(); angle > 0) {
      X.R = X.R * rotation_about(turn / angle, angle);
    }
    if (readings.corrections.empty()) continue;
    ReadingCorrection& correction = readings.corrections[i];
    if (layout.gain[i] != kNoColumn) correction.gain += fraction * x[layout.gain[i]];
    if (layout.first[i] != kNoColumn) {
      correction.cos_1 += fraction * x[layout.first[i]];
      correction.sin_1 += fraction * x[layout.first[i] + 1];
    }
    if (layout.second[i] != kNoColumn) {
      correction.cos_2 += fraction * x[layout.second[i]];
      correction.sin_2 += fraction * x[layout.second[i] + 1];
    }
  }
  signature.X_SL[n] = signature.X_SL[n - 1] * X_last;
  for (std::size_t t = 0; t < signature.targets.size(); ++t) {
    if (layout.target[t] == kNoColumn) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      signature.targets[t].p_S[static_cast<Eigen::Index>(c)] += fraction * x[layout.target[t] + c];
    }
  }
}

}  // namespace armsig::refinement
