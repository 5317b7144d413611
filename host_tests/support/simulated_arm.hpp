// SPDX-License-Identifier: MIT
// A simulated arm in front of a sensor: truth by the plain Denavit-Hartenberg product, independent
// of the code under test.
#pragma once

#include <vector>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/calibration/refined.hpp"
#include "core/signature.hpp"
#include "host_tests/support/random.hpp"

namespace armsig::test {

inline Pose dh_pose(const DhJoint& joint, double reading) {
  const bool revolute = joint.type == JointType::kRevolute;
  const Matrix3 R_z = rotation_z(joint.theta_rad + (revolute ? reading : 0.0));
  const Vector3 p(joint.a_m, 0, joint.d_m + (revolute ? 0.0 : reading));
  return {R_z * rotation_x(joint.alpha_rad), R_z * p};
}

inline constexpr JointType kR = JointType::kRevolute;
inline constexpr JointType kP = JointType::kPrismatic;

inline Arm make_arm(std::initializer_list<DhJoint> joints,
                    std::initializer_list<JointLimits> limits) {
  Arm arm;
  for (const DhJoint& joint : joints) arm.joints.push_back(joint);
  for (const JointLimits& limit : limits) arm.limits.push_back(limit);
  return arm;
}

// Table 1 of the paper; limits of the Puma Mark II 500 series.
inline Arm puma() {
  const auto limit = [](double lower_deg, double upper_deg) {
    return JointLimits{radians(lower_deg), radians(upper_deg)};
  };
  return make_arm({{kR, 0, 0, 0, -kPi / 2},
                   {kR, 0, 0.14909, 0.4318, 0},
                   {kR, 0, 0, -0.02032, kPi / 2},
                   {kR, 0, 0.4307, 0, -kPi / 2},
                   {kR, 0, 0, 0, kPi / 2},
                   {kR, 0, 0, 0, 0}},
                  {limit(-160, 160), limit(-225, 45), limit(-45, 225), limit(-110, 170),
                   limit(-100, 100), limit(-266, 266)});
}

// How far real arms are from their drawing, 1 sigma.
struct Tolerances {
  double alpha_rad = radians(0.1);
  double theta_rad = radians(0.2);
  double length_m = 0.5e-3;
};

inline Arm made_to(const Arm& drawing, const Tolerances& tolerances, Random& random) {
  Arm arm = drawing;
  for (DhJoint& joint : arm.joints) {
    joint.theta_rad += random.normal(tolerances.theta_rad);
    joint.alpha_rad += random.normal(tolerances.alpha_rad);
    joint.d_m += random.normal(tolerances.length_m);
    joint.a_m += random.normal(tolerances.length_m);
  }
  return arm;
}

// An arm standing somewhere in front of a sensor, with target points on its last link.
struct Cell {
  Arm arm;
  Pose X_SB;                    // base in the sensor frame
  std::vector<Vector3> p_tool;  // in the last link's frame

  [[nodiscard]] JointVector effective(const JointVector& readings) const {
    JointVector q = readings;
    for (const JointCoupling& c : arm.couplings) q[c.joint] += c.ratio * readings[c.from];
    return q;
  }
  [[nodiscard]] Pose frame(const JointVector& readings, std::size_t link) const {
    const JointVector q = effective(readings);
    Pose X = X_SB;
    for (std::size_t i = 0; i < link; ++i) X = X * dh_pose(arm.joints[i], q[i]);
    return X;
  }
  [[nodiscard]] Vector3 point(const JointVector& readings, std::size_t target) const {
    return frame(readings, arm.joints.size()) * p_tool[target];
  }
};

// What an exact identification of the cell would give.
inline Signature signature_of(const Cell& cell, const JointVector& configuration) {
  Signature signature;
  signature.configuration = cell.effective(configuration);
  for (const DhJoint& joint : cell.arm.joints) signature.types.push_back(joint.type);
  const std::size_t n = cell.arm.joints.size();
  for (std::size_t i = 0; i <= n; ++i) signature.X_SL.push_back(cell.frame(configuration, i));
  for (std::size_t t = 0; t < cell.p_tool.size(); ++t) {
    Target target;
    target.number = static_cast<int>(t) + 1;
    target.link = n;
    target.p_S = cell.point(configuration, t);
    signature.targets.push_back(target);
  }
  return signature;
}

// The signature with every axis and target off by so much: a start as features give it.
inline Signature disturbed(Signature signature, double angle_rad, double length_m, Random& random) {
  for (Pose& X : signature.X_SL) {
    X.R = X.R * rotation_about(random.direction(), angle_rad);
    X.p += length_m * random.direction();
  }
  for (Target& target : signature.targets) target.p_S += length_m * random.direction();
  return signature;
}

inline calibration::Observation observe(const Cell& cell, const JointVector& readings,
                                        std::size_t target, double sigma_m, Random& random,
                                        std::size_t sweep = 0) {
  calibration::Observation row;
  row.sweep = sweep;
  row.target = target;
  row.readings = readings;
  row.p_S = cell.point(readings, target) + random.normal_vector(sigma_m);
  row.sigma_m = sigma_m;
  return row;
}

using Log = std::vector<calibration::Observation>;

// One sweep of every joint, `points` over `arc_rad` about the held configuration.
inline void add_sweeps(const Cell& cell, const JointVector& held, double arc_rad, int points,
                       double sigma_m, Random& random, Log& log) {
  for (std::size_t joint = 0; joint < held.size(); ++joint) {
    for (int k = 0; k < points; ++k) {
      JointVector q = held;
      q[joint] += arc_rad * (static_cast<double>(k) / (points - 1) - 0.5);
      log.push_back(observe(cell, q, 0, sigma_m, random, joint + 1));
    }
  }
}

inline void add_poses(const Cell& cell, int poses, double sigma_m, Random& random, Log& log) {
  for (int k = 0; k < poses; ++k) {
    log.push_back(observe(cell, random.configuration(cell.arm), 0, sigma_m, random));
  }
}

// A Puma made to the tolerances of "Figures to expect", in front of a sensor.
inline Cell puma_cell(Random& random, const Tolerances& tolerances = {}) {
  return {made_to(puma(), tolerances, random),
          {random.rotation(), 1.5 * random.direction()},
          {Vector3(0.08, 0.03, 0.12)}};
}

// The same with a prismatic joint in its middle.
inline Cell mixed_cell(Random& random) {
  Cell cell = puma_cell(random);
  cell.arm.joints[3].type = JointType::kPrismatic;
  cell.arm.limits[3] = {-0.2, 0.3};
  return cell;
}

// Where their signatures are taken.
inline JointVector cell_configuration() {
  return {radians(10), radians(-60), radians(70), radians(20), radians(40), radians(10)};
}

}  // namespace armsig::test
