// SPDX-License-Identifier: MIT
// The arm as a chain of axis lines, and the position of a target with its derivatives by every
// unknown.
//
// With the link frames X_SL of the signature configuration q^s, z of frame i-1 along axis i, link k
// moves by the product of the motions about those lines (product of exponentials),
//   E_1 E_2 ... E_k,  E_i = X_SL[i-1] J_i X_SL[i-1]^-1,
//   J_i = Rot(z, q_i - q_i^s) or Trans(0, 0, q_i - q_i^s),
// (21) of the paper without its pseudo Denavit-Hartenberg step, so that nothing is ill-conditioned
// near parallel axes. Joints at rest cost nothing.
#pragma once

#include "core/calibration/parameters.hpp"
#include "core/calibration/readings.hpp"
#include "core/calibration/square_root_factor.hpp"
#include "core/signature.hpp"

namespace armsig::calibration {

// How far the joints have moved from the signature configuration.
struct JointMotion {
  struct One {
    double moved = 0;  // corrected; radians or metres
    double cosine = 1;
    double sine = 0;
    double coupled = 0;  // the coupled reading it came from
  };
  std::array<One, kMaxJoints> joints;
};

// Derivatives of a target's position in the sensor frame. Not set for joints at rest (moved = 0:
// all are zero) and for joints beyond the target's link.
struct PointJacobian {
  Vector3 p_S;
  std::array<Eigen::Matrix<double, 3, 4>, kMaxJoints> axis;  // direction x, y; position x, y
  std::array<Vector3, kMaxJoints> motion;                    // by JointMotion::moved
  Matrix3 target;                                            // by Target::p_S
};

class PoeChain {
 public:
  // Precondition: as many X_SL as joints + 1.
  PoeChain(const Signature& signature, const ReadingModel& readings);

  [[nodiscard]] JointMotion motion(const JointVector& readings) const;

  // Position of `target` in the sensor frame [m].
  [[nodiscard]] Vector3 point(const JointMotion& motion, const Target& target) const;

  void point_and_jacobian(const JointMotion& motion, const Target& target,
                          PointJacobian& jacobian) const;

  [[nodiscard]] double coupled_configuration(std::size_t joint) const {
    return configuration_[joint].coupled;
  }

 private:
  struct Zero {
    double coupled = 0;
    double corrected = 0;
  };

  // The target from where it was measured through every moving joint i, from the outermost to the
  // first: visit(i, before, after its motion, both in its link frame).
  template <typename Visit>
  [[nodiscard]] Vector3 carry(const JointMotion& motion, const Target& target, Visit visit) const;

  ReadingModel readings_;
  JointTypes types_;
  std::array<Zero, kMaxJoints> configuration_;  // readings at the signature configuration
  FixedVector<Pose, kMaxFrames> X_SL_;
};

// Adds the derivatives of the position of target `target` by the unknowns that move it to the three
// rows.
void add_derivatives(const Layout& layout, const Signature& signature, const PoeChain& chain,
                     const JointMotion& motion, std::size_t target, const PointJacobian& jacobian,
                     RowBlock<3>& block);

// The estimate moved by the solution `x` of one iteration; X_SL[n] moves with the last axis.
void apply_corrections(const Layout& layout, const StateVector& x, double fraction,
                       Signature& signature, ReadingModel& readings);

}  // namespace armsig::calibration
