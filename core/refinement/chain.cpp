// SPDX-License-Identifier: MIT
#include "core/refinement/chain.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/sine_cosine.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::refinement {

namespace {

// The joint's own motion of a vector given in its link frame.
Vector3 turned(const JointMotion::One& joint, const Vector3& v) {
  return {joint.cosine * v.x() - joint.sine * v.y(), joint.sine * v.x() + joint.cosine * v.y(),
          v.z()};
}

}  // namespace

PoeChain::PoeChain(const Signature& signature, const ReadingModel& readings)
    : readings_(readings), types_(signature.types), X_SL_(signature.X_SL) {
  const std::size_t n = types_.size();
  ARMSIG_CHECK(X_SL_.size() == n + 1 && signature.configuration.size() == n);
  ARMSIG_CHECK(readings.corrections.empty() || readings.corrections.size() == n);
  Deflections at_rest{};
  if (readings_.deflections != nullptr) {
    at_rest = deflections_at(readings_, readings_for(readings_.couplings, signature.configuration));
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double effective = signature.configuration[i];
    configuration_[i] = {effective, corrected_reading(readings_, i, effective) + at_rest[i]};
    B_[i] = X_SL_[i].inverse() * X_SL_[i + 1];
  }
}

JointMotion PoeChain::motion(const JointVector& readings) const {
  ARMSIG_CHECK(readings.size() == types_.size());
  using V = Pack<double>;
  JointMotion motion;
  const JointVector coupled = effective_readings(readings_.couplings, readings);
  std::array<double, kMaxJoints> angles{};
  Deflections deflections{};
  if (readings_.deflections != nullptr) deflections = deflections_at(readings_, readings);
  double largest = 0;
  for (std::size_t i = 0; i < types_.size(); ++i) {
    JointMotion::One& one = motion.joints[i];
    one.coupled = coupled[i];
    one.moved =
        corrected_reading(readings_, i, coupled[i]) + deflections[i] - configuration_[i].corrected;
    if (types_[i] == JointType::kRevolute) angles[i] = one.moved;
    largest = std::max(largest, std::abs(angles[i]));
  }
  if (largest > SineCosineConstants<double>::kLargestAngle) {
    for (std::size_t i = 0; i < types_.size(); ++i) move(motion, i, motion.joints[i].moved);
    return motion;
  }
  // Those of zero are exact, as move() has them.
  for (std::size_t i = 0; i < types_.size(); i += Lanes<double>::kCount) {
    std::array<double, Lanes<double>::kCount> sines;
    std::array<double, Lanes<double>::kCount> cosines;
    V sine;
    V cosine;
    sine_cosine<double>(load<V>(&angles[i]), sine, cosine);
    store(sines.data(), sine);
    store(cosines.data(), cosine);
    for (std::size_t k = 0; k < Lanes<double>::kCount; ++k) {
      motion.joints[i + k].sine = sines[k];
      motion.joints[i + k].cosine = cosines[k];
    }
  }
  return motion;
}

void PoeChain::move(JointMotion& motion, std::size_t joint, double moved) const {
  JointMotion::One& one = motion.joints[joint];
  one.moved = moved;
  // A joint at rest keeps the exact cosine and sine of zero, so that its derivatives are exact
  // zeros that cost nothing in the filter.
  const bool turns = types_[joint] == JointType::kRevolute && moved != 0;
  const SineCosine turn = turns ? sine_and_cosine(moved) : SineCosine{};
  one.cosine = turn.cosine;
  one.sine = turn.sine;
}

// Joints at rest keep the frames of the signature configuration: the way between two moving joints
// leads through the sensor frame past those between them, at the cost of none.
template <typename Visit>
Vector3 PoeChain::carry(const JointMotion& motion, const Target& target, std::size_t first,
                        Visit visit) const {
  Vector3 p = target.p_S;
  bool in_sensor_frame = true;  // otherwise p is in the link frame of the joint just visited
  for (std::size_t i = target.link; i-- > first;) {
    const JointMotion::One& joint = motion.joints[i];
    if (joint.moved == 0) {
      if (!in_sensor_frame) p = X_SL_[i + 1] * p;
      in_sensor_frame = true;
      continue;
    }
    p = in_sensor_frame ? Vector3(X_SL_[i].R.transpose() * (p - X_SL_[i].p)) : B_[i] * p;
    in_sensor_frame = false;
    const Vector3 r = p;
    if (types_[i] == JointType::kRevolute) {
      p = turned(joint, p);
    } else {
      p.z() += joint.moved;
    }
    visit(i, r, p);
  }
  return in_sensor_frame ? p : X_SL_[first] * p;
}

Vector3 PoeChain::point(const JointMotion& motion, const Target& target, std::size_t first) const {
  return carry(motion, target, first, [](std::size_t, const Vector3&, const Vector3&) {});
}

void PoeChain::point_and_jacobian(const JointMotion& motion, const Target& target,
                                  PointJacobian& jacobian, std::size_t first) const {
  // Inward: the target in the link frame of each moving joint before (r) and after (v) its motion.
  std::array<Vector3, kMaxJoints> r;
  std::array<Vector3, kMaxJoints> v;
  jacobian.p_S =
      carry(motion, target, first, [&](std::size_t i, const Vector3& before, const Vector3& after) {
        r[i] = before;
        v[i] = after;
      });

  // Outward: the rotation of each moving joint's link frame, and the derivatives taken in it. A
  // revolute joint moves r to a + R (r - a); turning its axis by w adds w x (R r) - R (w x r),
  // shifting it by t adds t - R t.
  Matrix3 R_SF = Matrix3::Identity();
  std::size_t last = kMaxJoints;  // that moves, so far
  for (std::size_t i = first; i < target.link; ++i) {
    const JointMotion::One& joint = motion.joints[i];
    if (joint.moved == 0) continue;
    if (last == kMaxJoints) {
      R_SF = X_SL_[i].R;
    } else if (last + 1 == i) {
      R_SF = R_SF.lazyProduct(B_[last].R).eval();
    } else {
      R_SF = R_SF.lazyProduct(X_SL_[last].R.transpose().lazyProduct(X_SL_[i].R).eval()).eval();
    }
    last = i;
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
  }
  jacobian.target = R_SF;
  if (last < kMaxJoints) jacobian.target = R_SF.lazyProduct(X_SL_[last].R.transpose());
}

Pose PoeChain::frame(const JointMotion& motion, std::size_t joint) const {
  Pose X = X_SL_[joint];
  for (std::size_t i = joint; i-- > 0;) {
    const JointMotion::One& one = motion.joints[i];
    if (one.moved == 0) continue;
    X = X_SL_[i].inverse() * X;
    if (types_[i] == JointType::kRevolute) {
      for (int c = 0; c < 3; ++c) X.R.col(c) = turned(one, X.R.col(c));
      X.p = turned(one, X.p);
    } else {
      X.p.z() += one.moved;
    }
    X = X_SL_[i] * X;
  }
  return X;
}

namespace {

// Calls add(column, derivative of the target's position) for every unknown that moves it.
template <typename Add>
void for_each_derivative(const Layout& layout, const Signature& signature, const PoeChain& chain,
                         const JointMotion& motion, std::size_t target,
                         const PointJacobian& jacobian, Add add) {
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
    const auto add_correction = [&](std::size_t column, double moves) {
      add(column, moves * jacobian.motion[i]);
    };
    if (layout.gain[i] != kNoColumn) add_correction(layout.gain[i], q - q_s);
    if (layout.first[i] != kNoColumn) {
      add_correction(layout.first[i], std::cos(q) - std::cos(q_s));
      add_correction(layout.first[i] + 1, std::sin(q) - std::sin(q_s));
    }
    if (layout.second[i] != kNoColumn) {
      add_correction(layout.second[i], std::cos(2 * q) - std::cos(2 * q_s));
      add_correction(layout.second[i] + 1, std::sin(2 * q) - std::sin(2 * q_s));
    }
  }
  if (layout.target[target] != kNoColumn) {
    for (int c = 0; c < 3; ++c) {
      add(layout.target[target] + static_cast<std::size_t>(c), jacobian.target.col(c));
    }
  }
}

}  // namespace

void add_derivatives(const Layout& layout, const Signature& signature, const PoeChain& chain,
                     const JointMotion& motion, std::size_t target, const PointJacobian& jacobian,
                     const Vector3& gradient, RowBlock<1>& block) {
  for_each_derivative(layout, signature, chain, motion, target, jacobian,
                      [&](std::size_t column, const Vector3& derivative) {
                        block.rows[0][column] += gradient.dot(derivative);
                      });
}

void add_derivatives(const Layout& layout, const Signature& signature, const PoeChain& chain,
                     const JointMotion& motion, std::size_t target, const PointJacobian& jacobian,
                     double weight, RowBlock<3>& block) {
  for_each_derivative(layout, signature, chain, motion, target, jacobian,
                      [&](std::size_t column, const Vector3& derivative) {
                        for (int c = 0; c < 3; ++c) {
                          block.rows[c][column] += weight * derivative[c];
                        }
                      });
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
