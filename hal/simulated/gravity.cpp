// SPDX-License-Identifier: MIT
#include "hal/simulated/gravity.hpp"

namespace armsig::simulated {

namespace {

struct PointMass {
  double kg = 0;
  Vector3 p_S = Vector3::Zero();
};

// What moves with one link.
struct Limb {
  PointMass rod;
  PointMass end;
};

FixedVector<Limb, kMaxJoints> masses_of(const SimulatedArm& arm,
                                        const FixedVector<Pose, kMaxFrames>& X_SL,
                                        const Limbs& limbs) {
  const std::size_t joints = arm.arm.joints.size();
  FixedVector<Limb, kMaxJoints> masses;
  for (std::size_t link = 1; link <= joints; ++link) {
    const Vector3& near = X_SL[link - 1].p;
    const Vector3& far = X_SL[link].p;
    masses.push_back({.rod = {limbs.kg_per_m * (far - near).norm(), 0.5 * (near + far)},
                      .end = {limbs.motor_kg, far}});
  }
  Limb& last = masses.back();
  last.end.kg = limbs.load_kg;
  if (!arm.targets.empty()) {
    const Target& target = arm.targets[arm.targets.size() - 1];
    if (target.link == joints) last.end.p_S = X_SL[joints] * target.p_L;
  }
  return masses;
}

// Weight along the motion of one joint, and what is moved by it.
struct Share {
  double weight = 0;   // N m or N
  double inertia = 0;  // kg m^2 or kg
};

}  // namespace

JointVector gravity_pull(const SimulatedArm& arm, const JointVector& readings, const Limbs& limbs) {
  const std::size_t joints = arm.arm.joints.size();
  const auto X_SL = link_poses(arm, readings);
  const auto masses = masses_of(arm, X_SL, limbs);
  // How the effective readings follow each reading: linear, so exact by a unit step.
  const JointVector still = effective_readings(arm.arm, JointVector(joints, 0.0));
  JointVector pull;
  for (std::size_t i = 0; i < joints; ++i) {
    JointVector unit(joints, 0.0);
    unit[i] = 1;
    const JointVector moved = effective_readings(arm.arm, unit);
    const bool turns = arm.arm.joints[i].type == JointType::kRevolute;
    Share share{.inertia = turns ? limbs.rotor_kg_m2 : limbs.rotor_kg};
    const auto carry = [&](const PointMass& mass, std::size_t link) {
      Vector3 by_reading = Vector3::Zero();
      for (std::size_t k = 0; k < link; ++k) {
        const Vector3 axis_S = X_SL[k].R.col(2);
        const bool rotates = arm.arm.joints[k].type == JointType::kRevolute;
        by_reading +=
            (moved[k] - still[k]) * (rotates ? axis_S.cross(mass.p_S - X_SL[k].p).eval() : axis_S);
      }
      share.weight += mass.kg * limbs.g_S.dot(by_reading);
      share.inertia += mass.kg * by_reading.squaredNorm();
    };
    for (std::size_t link = 1; link <= joints; ++link) {
      carry(masses[link - 1].rod, link);
      carry(masses[link - 1].end, link);
    }
    pull.push_back(share.weight / share.inertia);
  }
  return pull;
}

}  // namespace armsig::simulated
