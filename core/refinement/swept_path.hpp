// SPDX-License-Identifier: MIT
// The path of a target while one joint moves and all others rest, and its derivatives by every
// unknown, in closed form.
//
// F is the link frame of the moving joint as the joints before it hold it, z along its axis; r the
// target in F before the joint's own motion, as the joints behind it hold it; m the middle of that
// motion, d the motion about m:
//   revolute   p_F = c + A cos d + B sin d,  c = (0, 0, z), A = (x, y, 0), B = (-y, x, 0),
//                                            (x, y, z) = Rot(z, m) r
//   prismatic  p_F = c + A d / h,            c = r + m z, A = h z, B = 0,
// h half the length of the sweep.
#pragma once

#include "core/refinement/chain.hpp"

namespace armsig::refinement {

// Which joint moves, and where the others rest.
struct SweptJoint {
  std::size_t joint = 0;
  bool revolute = true;
  double half_length = 0;  // h
  JointMotion middle;      // the joint at m, the others where they rest
};

struct SweptPath {
  Pose X_SF;
  Vector3 r_F;
  Matrix3 rows;  // c, A, B
};

// `chain` is that of `signature`.
[[nodiscard]] SweptPath swept_path(const Signature& signature, const Chain& chain,
                                   const SweptJoint& swept, const Target& target);

// By the unknowns that the path involves. Row 3 k + i of `rows` is component i of the k-th of c, A,
// B; entry j of it the derivative by unknown columns[j] of the layout, ascending.
struct PathDerivatives {
  FixedVector<std::uint8_t, kMaxParameters> columns;
  RowBlock<9> rows;
  // How fast the moving joint, and each that rests away from the signature configuration, moves the
  // target: its distance from the axis [m], or 1 for a prismatic joint.
  std::array<double, kMaxJoints> radius{};

  void add(std::size_t column, const Vector3& by_c, const Vector3& by_A, const Vector3& by_B);
};

// Precondition: the target is among the unknowns.
void path_derivatives(const Layout& layout, const Signature& signature, const Chain& chain,
                      const SweptJoint& swept, std::size_t target, const SweptPath& path,
                      PathDerivatives& derivatives);

}  // namespace armsig::refinement
