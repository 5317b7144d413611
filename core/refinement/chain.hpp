// SPDX-License-Identifier: MIT
// The arm as a chain of axis lines, and the position of a target with its derivatives by every
// unknown.
//
// With the link frames X_SL of the signature configuration q^s, z of frame i-1 along axis i, the
// motion of link k is the product of rotations about those lines (product of exponentials), written
// with B_i = X_SL[i-1]^-1 X_SL[i] as
//   X_S(k) = X_SL[0] J_1 B_1 J_2 B_2 ... J_k,  J_i = Rot(z, q_i - q_i^s) or Trans(0, 0, q_i -
//   q_i^s),
// (21) of the paper without its pseudo Denavit-Hartenberg step, so that nothing is ill-conditioned
// near parallel axes.
#pragma once

#include "core/arm_model/readings.hpp"
#include "core/refinement/parameters.hpp"
#include "core/refinement/square_root_factor.hpp"
#include "core/signature.hpp"

namespace armsig::refinement {

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

  // JointMotion::One::moved of one joint, without its sine and cosine.
  [[nodiscard]] double motion_of(std::size_t joint, const JointVector& readings) const {
    double coupled = readings[joint];
    for (const JointCoupling& coupling : readings_.couplings) {
      if (coupling.joint == joint) coupled += coupling.ratio * readings[coupling.from];
    }
    return corrected_reading(readings_, joint, coupled) - configuration_[joint].corrected;
  }

  // Puts joint `joint` of `motion` at `moved` from the signature configuration.
  void move(JointMotion& motion, std::size_t joint, double moved) const;

  // Position of `target` in the sensor frame [m], the joints before `first` at the signature
  // configuration.
  [[nodiscard]] Vector3 point(const JointMotion& motion, const Target& target,
                              std::size_t first = 0) const;

  void point_and_jacobian(const JointMotion& motion, const Target& target, PointJacobian& jacobian,
                          std::size_t first = 0) const;

  // Link frame of joint `joint` in the sensor frame, as the joints before it hold it.
  [[nodiscard]] Pose frame(const JointMotion& motion, std::size_t joint) const;

  [[nodiscard]] double coupled_configuration(std::size_t joint) const {
    return configuration_[joint].coupled;
  }

 private:
  struct Zero {
    double coupled = 0;
    double corrected = 0;
  };

  // The target from where it was measured through every moving joint i, from the outermost to
  // `first`, to the sensor frame: visit(i, before, after its motion, both in its link frame).
  template <typename Visit>
  [[nodiscard]] Vector3 carry(const JointMotion& motion, const Target& target, std::size_t first,
                              Visit visit) const;

  ReadingModel readings_;
  JointTypes types_;
  std::array<Zero, kMaxJoints> configuration_;  // readings at the signature configuration
  FixedVector<Pose, kMaxFrames> X_SL_;
  std::array<Pose, kMaxJoints> B_;  // B_[i] = X_SL[i]^-1 X_SL[i+1]
};

// Adds derivatives to a row of the filter, for a measured scalar whose derivative by the target's
// position is `gradient` (already divided by sigma and weighted).
void add_derivatives(const Layout& layout, const Signature& signature, const PoeChain& chain,
                     const JointMotion& motion, std::size_t target, const PointJacobian& jacobian,
                     const Vector3& gradient, RowBlock<1>& block);

// The same to three rows for the coordinates of a measured point, which go with the target's
// position times `weight`.
void add_derivatives(const Layout& layout, const Signature& signature, const PoeChain& chain,
                     const JointMotion& motion, std::size_t target, const PointJacobian& jacobian,
                     double weight, RowBlock<3>& block);

// The estimate moved by the solution `x` of one iteration; X_SL[n] moves with the last axis.
void apply_corrections(const Layout& layout, const StateVector& x, double fraction,
                       Signature& signature, ReadingModel& readings);

}  // namespace armsig::refinement
