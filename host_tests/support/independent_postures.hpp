// SPDX-License-Identifier: MIT
// Every posture of a pose by many random starts of a damped Newton method of its own, polished in
// extended precision: what the project's search is judged by. Shares no code with it.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/SVD>

#include "core/base/arm.hpp"

namespace armsig::test {

template <typename Scalar>
class IndependentArm {
 public:
  using Matrix3S = Eigen::Matrix<Scalar, 3, 3>;
  using Vector3S = Eigen::Matrix<Scalar, 3, 1>;
  using ErrorS = Eigen::Matrix<Scalar, 6, 1>;
  using JacobianS = Eigen::Matrix<Scalar, 6, Eigen::Dynamic, 0, 6, 8>;
  using Readings = Eigen::Matrix<Scalar, Eigen::Dynamic, 1, 0, 8, 1>;
  struct Frame {
    Matrix3S R = Matrix3S::Identity();
    Vector3S p = Vector3S::Zero();
  };

  explicit IndependentArm(const DhRows& rows) {
    for (const DhJoint& row : rows) {
      links_.push_back({row.type == JointType::kRevolute, Scalar(row.theta_rad), Scalar(row.d_m),
                        Scalar(row.a_m), std::cos(Scalar(row.alpha_rad)),
                        std::sin(Scalar(row.alpha_rad))});
    }
  }

  [[nodiscard]] Eigen::Index joints() const { return static_cast<Eigen::Index>(links_.size()); }
  [[nodiscard]] bool turns(Eigen::Index i) const {
    return links_[static_cast<std::size_t>(i)].turns;
  }

  Frame place(const Readings& q, JacobianS* J = nullptr) const {
    std::array<Frame, 9> before;
    Frame X;
    for (std::size_t i = 0; i < links_.size(); ++i) {
      before[i] = X;
      const Link& link = links_[i];
      const Scalar reading = q[static_cast<Eigen::Index>(i)];
      const Scalar theta = link.theta + (link.turns ? reading : 0);
      const Scalar d = link.d + (link.turns ? 0 : reading);
      const Scalar c = std::cos(theta);
      const Scalar s = std::sin(theta);
      Matrix3S R;
      R << c, -s * link.ca, s * link.sa, s, c * link.ca, -c * link.sa, 0, link.sa, link.ca;
      X.p += X.R * Vector3S(link.a * c, link.a * s, d);
      X.R = X.R * R;
    }
    if (J == nullptr) return X;
    J->resize(6, joints());
    for (std::size_t i = 0; i < links_.size(); ++i) {
      const Vector3S axis = before[i].R.col(2);
      const auto column = static_cast<Eigen::Index>(i);
      J->col(column).setZero();
      if (links_[i].turns) {
        J->col(column).template head<3>() = axis.cross(X.p - before[i].p);
        J->col(column).template tail<3>() = axis;
      } else {
        J->col(column).template head<3>() = axis;
      }
    }
    return X;
  }

  static ErrorS error(const Frame& target, const Frame& at) {
    ErrorS e;
    e.template head<3>() = target.p - at.p;
    const Matrix3S R = target.R * at.R.transpose();
    const Vector3S v =
        Scalar(0.5) * Vector3S(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
    const Scalar sine = v.norm();
    const Scalar angle = std::atan2(sine, (R.trace() - 1) / 2);
    e.template tail<3>() = sine > 0 ? Vector3S(v * (angle / sine)) : v;
    return e;
  }

  // Levenberg and Marquardt. What is left of the error.
  Scalar approach(const Frame& target, Readings& q, Scalar goal, int most) const {
    JacobianS J;
    ErrorS e = error(target, place(q, &J));
    Scalar damping = Scalar(0.01) * e.squaredNorm();
    for (int k = 0; k < most && e.norm() > goal; ++k) {
      const auto n = joints();
      Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8> normal = J.transpose() * J;
      normal.diagonal().array() += damping + Scalar(1e-24);
      Readings step = normal.ldlt().solve(J.transpose() * e);
      if (step.size() != n || !step.allFinite()) break;
      const Scalar largest = step.cwiseAbs().maxCoeff();
      if (largest > Scalar(0.6)) step *= Scalar(0.6) / largest;
      const Readings next = q + step;
      JacobianS J_next;
      const ErrorS e_next = error(target, place(next, &J_next));
      if (e_next.squaredNorm() < e.squaredNorm()) {
        q = next;
        e = e_next;
        J = J_next;
        damping *= Scalar(0.1);
        damping = std::min(damping, e.squaredNorm());
      } else {
        damping = std::max(damping * 5, Scalar(1e-14));
        if (damping > Scalar(1e3)) break;
      }
    }
    return e.norm();
  }

  [[nodiscard]] Scalar least_singular_value(const Readings& q) const {
    JacobianS J;
    place(q, &J);
    const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> any = J;
    const auto values = Eigen::JacobiSVD<Eigen::Matrix<Scalar, -1, -1>>(any).singularValues();
    return values[values.size() - 1];
  }

 private:
  struct Link {
    bool turns;
    Scalar theta, d, a, ca, sa;
  };
  std::vector<Link> links_;
};

struct IndependentPosture {
  JointVector q;
  double least_singular_value = 0;
};

// The largest change of a reading between the two, whole turns apart not counted.
inline double apart(const DhRows& rows, const JointVector& a, const JointVector& b) {
  double most = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double change = a[i] - b[i];
    const bool turns = rows[i].type == JointType::kRevolute;
    most = std::max(most, std::abs(turns ? std::remainder(change, 2 * kPi) : change));
  }
  return most;
}

class IndependentSearch {
 public:
  using Exact = IndependentArm<long double>;
  using Fast = IndependentArm<double>;

  IndependentSearch(const DhRows& rows, double stroke_m)
      : rows_(rows), exact_(rows), fast_(rows), stroke_m_(stroke_m) {}

  [[nodiscard]] Exact::Frame pose(const JointVector& q) const { return exact_.place(wide(q)); }
  [[nodiscard]] double miss(const Exact::Frame& target, const JointVector& q) const {
    return static_cast<double>(Exact::error(target, exact_.place(wide(q))).norm());
  }

  // All that `starts` random starts lead to, `known` first.
  std::vector<IndependentPosture> search(const Exact::Frame& target, const JointVector& known,
                                         int starts, std::mt19937_64& random) const {
    std::vector<IndependentPosture> found;
    add(target, wide(known), found);
    Fast::Frame rough{target.R.cast<double>(), target.p.cast<double>()};
    std::uniform_real_distribution<double> any(-1, 1);
    for (int k = 0; k < starts; ++k) {
      Fast::Readings q(fast_.joints());
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        q[i] = any(random) * (fast_.turns(i) ? kPi : stroke_m_);
      }
      if (fast_.approach(rough, q, 1e-9, 60) > 1e-6) continue;
      if (is_known(q, found)) continue;
      add(target, q.cast<long double>(), found);
    }
    return found;
  }

 private:
  static constexpr double kSame = 1e-5;

  static Exact::Readings wide(const JointVector& q) {
    Exact::Readings all(static_cast<Eigen::Index>(q.size()));
    for (std::size_t i = 0; i < q.size(); ++i) {
      all[static_cast<Eigen::Index>(i)] = static_cast<long double>(q[i]);
    }
    return all;
  }
  template <typename Q>
  static JointVector narrow(const Q& q) {
    JointVector all;
    for (Eigen::Index i = 0; i < q.size(); ++i) all.push_back(static_cast<double>(q[i]));
    return all;
  }

  template <typename Q>
  bool is_known(const Q& q, const std::vector<IndependentPosture>& found) const {
    const JointVector one = narrow(q);
    return std::ranges::any_of(
        found, [&](const IndependentPosture& other) { return apart(rows_, one, other.q) < kSame; });
  }

  void add(const Exact::Frame& target, Exact::Readings q,
           std::vector<IndependentPosture>& found) const {
    constexpr long double kMet = 2e-15L;
    if (exact_.approach(target, q, kMet, 60) > kMet || is_known(q, found)) return;
    found.push_back({narrow(q), static_cast<double>(exact_.least_singular_value(q))});
  }

  DhRows rows_;
  Exact exact_;
  Fast fast_;
  double stroke_m_;
};

}  // namespace armsig::test
