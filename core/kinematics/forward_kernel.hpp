// SPDX-License-Identifier: MIT
// The product (1) for the servo tick: one pass over the joints, no 4 x 4 matrices.
//
// Multiplying a frame by Rot(z, theta) Trans(x, y, z) Rot(x, alpha) works on each row of [R p] by
// itself. The kernel therefore carries as many rows as a register holds, written once for packs and
// for single numbers.
#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>

#include "core/base/lanes.hpp"
#include "core/kinematics/forward.hpp"
#include "core/kinematics/joint_terms.hpp"

namespace armsig::kinematics {
inline namespace ARMSIG_LANES {

// A constant as V: all lanes of a pack, or the number itself.
template <typename V>
[[nodiscard]] [[gnu::always_inline]] inline V as(const Broadcast& constant) {
  if constexpr (sizeof(V) <= sizeof(constant.copies)) {
    return load<V>(constant.copies.data());
  } else {
    return V{} + constant.copies[0];
  }
}

// Rows of a frame: columns x, y, z of R and p, each V holding one or several rows.
template <typename V>
struct FrameRows {
  V x, y, z, p;

  // This frame times link i.
  [[gnu::always_inline]] void advance(const Chain& chain, const JointTerms& terms, std::size_t i) {
    const V turned_x = terms.cosine[i] * x + terms.sine[i] * y;
    const V turned_y = terms.cosine[i] * y - terms.sine[i] * x;
    p += as<V>(terms.z[i]) * z;
    p += as<V>(chain.x[i]) * turned_x;
    p += as<V>(chain.y[i]) * turned_y;
    x = turned_x;
    y = as<V>(chain.cos_alpha[i]) * turned_y + as<V>(chain.sin_alpha[i]) * z;
    z = as<V>(chain.cos_alpha[i]) * z - as<V>(chain.sin_alpha[i]) * turned_y;
  }
};

// The z axis and the origin of the frames before each joint: the lines that the joints turn about.
// Four numbers each, the fourth without meaning.
struct JointAxes {
  alignas(32) std::array<std::array<double, 4>, kMaxJoints> axes;
  alignas(32) std::array<std::array<double, 4>, kMaxJoints> origins;

  [[nodiscard]] double* axis(std::size_t i) { return axes[i].data(); }
  [[nodiscard]] const double* axis(std::size_t i) const { return axes[i].data(); }
  [[nodiscard]] double* origin(std::size_t i) { return origins[i].data(); }
  [[nodiscard]] const double* origin(std::size_t i) const { return origins[i].data(); }
};

// The same where the Jacobian will be: the axis is its lower half already, the origin waits in the
// upper one. Three numbers each: for kernels that store no fourth.
struct JacobianAxes {
  double* J;

  [[nodiscard]] double* axis(std::size_t i) const { return J + 6 * i + 3; }
  [[nodiscard]] double* origin(std::size_t i) const { return J + 6 * i; }
};

// Keeps nothing where only frame n is wanted.
struct NoAxes {};

// A whole frame [R p], frame 0 at first: one pack with a spare lane where a register holds three
// rows, a pack of two rows and a single one, or three single ones.
template <typename V, std::size_t kRowsAtOnce>
struct FrameBy;
using Frame = FrameBy<Pack<double>, Lanes<double>::kCount>;

template <typename V>
struct FrameBy<V, 4> {
  FrameRows<V> rows{V{1, 0, 0, 0}, V{0, 1, 0, 0}, V{0, 0, 1, 0}, V{0, 0, 0, 0}};

  // Frame n. The usual six joints are unrolled where nothing else is wanted.
  template <typename Axes>
  [[gnu::always_inline]] void advance_all(const Chain& chain, const JointTerms& terms, Axes& axes) {
    if constexpr (std::is_same_v<Axes, NoAxes>) {
      if (chain.joint_count == 6) [[likely]] {
#pragma GCC unroll 6
        for (std::size_t i = 0; i < 6; ++i) rows.advance(chain, terms, i);
        return;
      }
    }
    for (std::size_t i = 0; i < chain.joint_count; ++i) {
      if constexpr (!std::is_same_v<Axes, NoAxes>) {
        store(axes.axis(i), rows.z);
        store(axes.origin(i), rows.p);
      }
      rows.advance(chain, terms, i);
    }
  }
  [[gnu::always_inline]] void store_pose(Pose& X) const {
    store(X.R.data(), rows.x);
    store(X.R.data() + 3, rows.y);
    store_three(X.R.data() + 6, rows.z);
    store_three(X.p.data(), rows.p);
  }

 private:
  [[gnu::always_inline]] static void store_three(double* to, const V& v) {
    store(to, __builtin_shufflevector(v, v, 0, 1));
    to[2] = v[2];
  }
};

template <typename V>
struct FrameBy<V, 2> {
  FrameRows<V> rows01{V{1, 0}, V{0, 1}, V{0, 0}, V{0, 0}};
  FrameRows<double> row2{0, 0, 1, 0};

  // Frame n, one pack of rows after the other: both at once need more registers than there are.
  template <typename Axes>
  [[gnu::always_inline]] void advance_all(const Chain& chain, const JointTerms& terms, Axes& axes) {
    constexpr bool kStore = !std::is_same_v<Axes, NoAxes>;
    for (std::size_t i = 0; i < chain.joint_count; ++i) {
      if constexpr (kStore) store(axes.axis(i), rows01.z);
      if constexpr (kStore) store(axes.origin(i), rows01.p);
      rows01.advance(chain, terms, i);
    }
    for (std::size_t i = 0; i < chain.joint_count; ++i) {
      if constexpr (kStore) axes.axis(i)[2] = row2.z;
      if constexpr (kStore) axes.origin(i)[2] = row2.p;
      row2.advance(chain, terms, i);
    }
  }
  void store_pose(Pose& X) const {
    store_column(X.R.data(), rows01.x, row2.x);
    store_column(X.R.data() + 3, rows01.y, row2.y);
    store_column(X.R.data() + 6, rows01.z, row2.z);
    store_column(X.p.data(), rows01.p, row2.p);
  }

 private:
  static void store_column(double* to, const V& rows01, double row2) {
    store(to, rows01);
    to[2] = row2;
  }
};

// A vector that is brought from the frame of a link to the frame before it.
struct TipVector {
  double x, y, z;

  // By Rot(x, alpha) of link i, then by Rot(z, theta).
  [[gnu::always_inline]] void twist(const Chain& chain, std::size_t i) {
    const double c = chain.cos_alpha[i];
    const double s = chain.sin_alpha[i];
    const double twisted = c * y - s * z;
    z = s * y + c * z;
    y = twisted;
  }
  [[gnu::always_inline]] void turn(const JointTerms& terms, std::size_t i) {
    const double turned = terms.cosine[i] * x - terms.sine[i] * y;
    y = terms.sine[i] * x + terms.cosine[i] * y;
    x = turned;
  }
};

template <typename V>
struct FrameBy<V, 1> {
  Matrix3 R;
  Vector3 p;

  // Frame n. Alone, its x and z axes and its origin are brought to frame 0 from the tip, which
  // keeps all in registers; with the frames between, from the base, all rows of a link together, so
  // that its constants are loaded once.
  template <typename Axes>
  [[gnu::always_inline]] void advance_all(const Chain& chain, const JointTerms& terms, Axes& axes) {
    if constexpr (std::is_same_v<Axes, NoAxes>) {
      bring_to_base(chain, terms);
    } else {
      advance_from_base(chain, terms, axes);
    }
  }
  [[gnu::always_inline]] void store_pose(Pose& X) const {
    X.R = R;
    X.p = p;
  }

 private:
  [[gnu::always_inline]] void bring_to_base(const Chain& chain, const JointTerms& terms) {
    // The last link alone, written out.
    std::size_t i = chain.joint_count - 1;
    const double s = terms.sine[i];
    const double c = terms.cosine[i];
    TipVector x{c, s, 0};
    TipVector z{0, -chain.sin_alpha[i], chain.cos_alpha[i]};
    TipVector o{chain.x[i], chain.y[i], terms.z[i]};
    z.x = -s * z.y;
    z.y = c * z.y;
    o.turn(terms, i);
    while (i-- > 0) {
      x.twist(chain, i);
      z.twist(chain, i);
      o.twist(chain, i);
      o.x += chain.x[i];
      o.y += chain.y[i];
      o.z += terms.z[i];
      x.turn(terms, i);
      z.turn(terms, i);
      o.turn(terms, i);
    }
    R.col(0) << x.x, x.y, x.z;
    R.col(1) << z.y * x.z - z.z * x.y, z.z * x.x - z.x * x.z, z.x * x.y - z.y * x.x;
    R.col(2) << z.x, z.y, z.z;
    p << o.x, o.y, o.z;
  }

  template <typename Axes>
  [[gnu::always_inline]] void advance_from_base(const Chain& chain, const JointTerms& terms,
                                                Axes& axes) {
    FrameRows<double> row0{1, 0, 0, 0};
    FrameRows<double> row1{0, 1, 0, 0};
    FrameRows<double> row2{0, 0, 1, 0};
    for (std::size_t i = 0; i < chain.joint_count; ++i) {
      double* const axis = axes.axis(i);
      axis[0] = row0.z;
      axis[1] = row1.z;
      axis[2] = row2.z;
      double* const origin = axes.origin(i);
      origin[0] = row0.p;
      origin[1] = row1.p;
      origin[2] = row2.p;
      row0.advance(chain, terms, i);
      row1.advance(chain, terms, i);
      row2.advance(chain, terms, i);
    }
    R << row0.x, row0.y, row0.z, row1.x, row1.y, row1.z, row2.x, row2.y, row2.z;
    p << row0.p, row1.p, row2.p;
  }
};

// Linear velocity of the point p_0 per unit of joint i's rate. The axis of joint i is the z axis of
// frame i - 1, and any point on it will do, so the moved frames of the chain serve as they are.
[[nodiscard]] [[gnu::always_inline]] inline Vector3 linear_column(const JointAxes& axes,
                                                                  const Vector3& p_0,
                                                                  std::size_t i) {
  const Eigen::Map<const Vector3> axis(axes.axis(i));
  const Eigen::Map<const Vector3> origin(axes.origin(i));
  return axis.cross(p_0 - origin);
}

// Pose and geometric Jacobian; false if a reading is not finite.
template <std::size_t kRowsAtOnce = Lanes<double>::kCount>
[[nodiscard]] inline bool joint_columns(const Chain& chain, const double* q,
                                        PoseAndJacobian& result) {
  JointTerms terms;
  if (!joint_terms(chain, q, terms)) return false;
  constexpr bool kInPlace = kRowsAtOnce < 4;
  std::conditional_t<kInPlace, JacobianAxes, JointAxes> axes;
  if constexpr (kInPlace) axes.J = result.J.data();
  Frame frame;
  frame.advance_all(chain, terms, axes);
  frame.store_pose(result.X_0n);
  const Vector3 p = result.X_0n.p;
  double* linear = result.J.data();
  for (std::size_t i = 0; i < chain.joint_count; ++i, linear += 6) {
    double* const angular = linear + 3;
    const double* const axis = axes.axis(i);
    const double* const origin = axes.origin(i);
    if constexpr (!kInPlace) std::copy_n(axis, 3, angular);
    if (chain.revolute[i]) [[likely]] {
      const double x = p[0] - origin[0];
      const double y = p[1] - origin[1];
      const double z = p[2] - origin[2];
      linear[0] = axis[1] * z - axis[2] * y;
      linear[1] = axis[2] * x - axis[0] * z;
      linear[2] = axis[0] * y - axis[1] * x;
    } else {
      for (int k = 0; k < 3; ++k) linear[k] = std::exchange(angular[k], 0.0);
    }
  }
  std::fill(linear, result.J.data() + result.J.size(), 0.0);
  return true;
}

}  // namespace ARMSIG_LANES
}  // namespace armsig::kinematics
