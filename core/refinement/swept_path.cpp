// SPDX-License-Identifier: MIT
#include "core/refinement/swept_path.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::refinement {

namespace {

Vector3 turned_to_middle(const SweptJoint& swept, const Vector3& v) {
  const JointMotion::One& joint = swept.middle.joints[swept.joint];
  return {joint.cosine * v.x() - joint.sine * v.y(), joint.sine * v.x() + joint.cosine * v.y(),
          v.z()};
}

// The path changes with r: by this much where r changes by `by_r`.
void add_by_target(const SweptJoint& swept, std::size_t column, const Vector3& by_r,
                   PathDerivatives& derivatives) {
  if (swept.revolute) {
    const Vector3 v = turned_to_middle(swept, by_r);
    derivatives.add(column, {0, 0, v.z()}, {v.x(), v.y(), 0}, {-v.y(), v.x(), 0});
  } else {
    derivatives.add(column, by_r, Vector3::Zero(), Vector3::Zero());
  }
}

// With R the joint's whole motion, turning its axis by w adds w x (R r) - R (w x r), shifting it by
// t adds t - R t; here split into c, A and B.
void add_by_axis(const SweptJoint& swept, std::size_t column, const SweptPath& path,
                 PathDerivatives& derivatives) {
  const JointMotion::One& joint = swept.middle.joints[swept.joint];
  if (!swept.revolute) {
    const double m = joint.moved;
    const double h = swept.half_length;
    derivatives.add(column, {0, -m, 0}, {0, -h, 0}, Vector3::Zero());
    derivatives.add(column + 1, {m, 0, 0}, {h, 0, 0}, Vector3::Zero());
    return;
  }
  const Vector3& r = path.r_F;
  const double x = path.rows(1, 0);
  const double y = path.rows(1, 1);
  const double z = r.z();
  const double c = joint.cosine;
  const double s = joint.sine;
  derivatives.add(column, {0, -z, -r.y()}, {-z * s, z * c, y}, {-z * c, -z * s, x});
  derivatives.add(column + 1, {z, 0, r.x()}, {-z * c, -z * s, -x}, {z * s, -z * c, y});
  derivatives.add(column + 2, {1, 0, 0}, {-c, -s, 0}, {s, -c, 0});
  derivatives.add(column + 3, {0, 1, 0}, {s, -c, 0}, {c, s, 0});
}

std::size_t unknowns_of_axis(JointType type) { return type == JointType::kRevolute ? 4 : 2; }

// The joints before the moving one carry the whole path, which is known by the points c, c + A and
// c + B of the link that they hold.
void add_by_inner_axes(const Layout& layout, const Signature& signature, const Chain& chain,
                       const SweptJoint& swept, const SweptPath& path,
                       PathDerivatives& derivatives) {
  const auto& joints = swept.middle.joints;
  const bool moved = std::any_of(joints.begin(), joints.begin() + swept.joint,
                                 [](const JointMotion::One& joint) { return joint.moved != 0; });
  if (!moved) return;
  std::array<PointJacobian, 3> of;
  for (int k = 0; k < 3; ++k) {
    Vector3 p_F = path.rows.row(0);
    if (k > 0) p_F += path.rows.row(k);
    Target point;
    point.link = swept.joint;
    point.p_S = signature.X_SL[swept.joint] * p_F;
    chain.point_and_jacobian(swept.middle, point, of[static_cast<std::size_t>(k)]);
  }
  const Matrix3 R_FS = path.X_SF.R.transpose();
  for (std::size_t i = 0; i < swept.joint; ++i) {
    if (joints[i].moved == 0) continue;
    for (std::size_t u = 0; u < unknowns_of_axis(signature.types[i]); ++u) {
      const auto c = static_cast<Eigen::Index>(u);
      const Vector3 by_c = R_FS * of[0].axis[i].col(c);
      derivatives.add(layout.axis[i] + u, by_c, R_FS * of[1].axis[i].col(c) - by_c,
                      R_FS * of[2].axis[i].col(c) - by_c);
    }
    derivatives.radius[i] = std::max(of[1].motion[i].norm(), of[2].motion[i].norm());
  }
}

// The joints behind the moving one and the target itself move r.
void add_by_outer_axes_and_target(const Layout& layout, const Signature& signature,
                                  const Chain& chain, const SweptJoint& swept, std::size_t target,
                                  PathDerivatives& derivatives) {
  const Target& held = signature.targets[target];
  PointJacobian by_r;
  chain.point_and_jacobian(swept.middle, held, by_r, swept.joint + 1);
  const Matrix3 R_LS = signature.X_SL[swept.joint].R.transpose();
  for (std::size_t i = swept.joint + 1; i < held.link; ++i) {
    if (swept.middle.joints[i].moved == 0) continue;
    for (std::size_t u = 0; u < unknowns_of_axis(signature.types[i]); ++u) {
      const auto c = static_cast<Eigen::Index>(u);
      add_by_target(swept, layout.axis[i] + u, R_LS * by_r.axis[i].col(c), derivatives);
    }
    derivatives.radius[i] = by_r.motion[i].norm();
  }
  const Matrix3 R_LT = R_LS * by_r.target;
  for (std::size_t c = 0; c < 3; ++c) {
    add_by_target(swept, layout.target[target] + c, R_LT.col(static_cast<Eigen::Index>(c)),
                  derivatives);
  }
}

}  // namespace

void PathDerivatives::add(std::size_t column, const Vector3& by_c, const Vector3& by_A,
                          const Vector3& by_B) {
  const std::size_t j = columns.size();
  columns.push_back(static_cast<std::uint8_t>(column));
  for (int i = 0; i < 3; ++i) {
    rows.rows[i][j] = by_c[i];
    rows.rows[3 + i][j] = by_A[i];
    rows.rows[6 + i][j] = by_B[i];
  }
}

SweptPath swept_path(const Signature& signature, const Chain& chain, const SweptJoint& swept,
                     const Target& target) {
  const Pose& X_SL = signature.X_SL[swept.joint];
  SweptPath path;
  path.X_SF = chain.frame(swept.middle, swept.joint);
  path.r_F = X_SL.R.transpose() * (chain.point(swept.middle, target, swept.joint + 1) - X_SL.p);
  if (swept.revolute) {
    const Vector3 v = turned_to_middle(swept, path.r_F);
    path.rows << 0, 0, v.z(), v.x(), v.y(), 0, -v.y(), v.x(), 0;
  } else {
    const Vector3& r = path.r_F;
    const double middle = swept.middle.joints[swept.joint].moved;
    path.rows << r.x(), r.y(), r.z() + middle, 0, 0, swept.half_length, 0, 0, 0;
  }
  return path;
}

void path_derivatives(const Layout& layout, const Signature& signature, const Chain& chain,
                      const SweptJoint& swept, std::size_t target, const SweptPath& path,
                      PathDerivatives& derivatives) {
  derivatives.columns.clear();
  derivatives.radius.fill(0);
  add_by_inner_axes(layout, signature, chain, swept, path, derivatives);
  add_by_axis(swept, layout.axis[swept.joint], path, derivatives);
  derivatives.radius[swept.joint] = swept.revolute ? path.r_F.head<2>().norm() : 1;
  add_by_outer_axes_and_target(layout, signature, chain, swept, target, derivatives);
}

}  // namespace armsig::refinement
