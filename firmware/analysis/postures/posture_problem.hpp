// SPDX-License-Identifier: MIT
// What posture_search.hpp follows: joints 1 to 3 that bring axis 5 to its place, for a turn of
// joint 6, and by how much axis 5 then misses the directions that joint 4 can give it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/pose.hpp"
#include "core/kinematics/chain.hpp"

namespace armsig::kinematics::postures {

// A rotation about a z axis, by its cosine and sine.
struct Turn {
  double c = 1;
  double s = 0;

  Turn operator*(const Turn& other) const {
    return {c * other.c - s * other.s, s * other.c + c * other.s};
  }
  [[nodiscard]] Turn back() const { return {c, -s}; }
  [[nodiscard]] double angle() const { return std::atan2(s, c); }
  Vector3 operator*(const Vector3& v) const {
    return {c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z()};
  }
};

inline Turn turn_by(double angle) { return {std::cos(angle), std::sin(angle)}; }

inline Turn direction(double x, double y) {
  const double length = std::sqrt(x * x + y * y);
  return length > 0 ? Turn{x / length, y / length} : Turn{};
}

// The part of a link after its joint's rotation: Trans(v) Rot(x, alpha).
struct ArmLink {
  Vector3 v;
  double c = 1;
  double s = 0;

  [[nodiscard]] Vector3 tilt(const Vector3& p) const {
    return {p.x(), c * p.y() - s * p.z(), s * p.y() + c * p.z()};
  }
  [[nodiscard]] Vector3 tilt_back(const Vector3& p) const {
    return {p.x(), c * p.y() + s * p.z(), c * p.z() - s * p.y()};
  }
};

// Joints 1 to 4, turned by.
struct ArmTurns {
  Turn q1, q2, q3, q4;
};

// Of the four ways in which joints 1 to 3 reach a point: bits.
inline constexpr unsigned kOtherShoulder = 1;
inline constexpr unsigned kOtherElbow = 2;
inline constexpr unsigned kWays = 4;

// How far a point is inside the reach, as the squares of two sines: negative outside.
struct Reach {
  double shoulder = 0;
  double elbow = 0;

  [[nodiscard]] double least() const { return std::min(shoulder, elbow); }
};

class PostureProblem {
 public:
  PostureProblem(const Chain& chain, const Pose& X_0n) : unit_(chain.length) {
    for (std::size_t i = 0; i < 6; ++i) {
      link_[i] = {Vector3(chain.x[i], chain.y[i], chain.z[i]), chain.cos_alpha[i],
                  chain.sin_alpha[i]};
    }
    // The common normal of axes 4 and 5 is along x of frame 3 turned by joint 4.
    const double along5 = link_[3].v.y() / link_[3].s;
    P_3_ = {link_[3].v.x(), 0, link_[3].v.z() + along5 * link_[3].c};
    axis5_5_ = link_[4].tilt_back(Vector3::UnitZ());
    P_5_ = along5 * axis5_5_ - link_[4].tilt_back(link_[4].v);
    for (Eigen::Index k = 0; k < 3; ++k) {
      R_.col(k) = X_0n.R * link_[5].tilt_back(Vector3::Unit(k));
    }
    p_ = X_0n.p - R_ * link_[5].v;
    fold2_ = link_[1].c > 0 ? 1 : -1;
    sign1_ = link_[0].s > 0 ? 1 : -1;
    sign4_ = link_[3].s > 0 ? 1 : -1;
  }

  // At joint 6 turned by q6: the point of axis 5, and its direction, in frame 0.
  [[nodiscard]] Vector3 point(const Turn& q6) const { return p_ + R_ * (q6.back() * P_5_); }
  [[nodiscard]] Vector3 axis5(const Turn& q6) const { return R_ * (q6.back() * axis5_5_); }

  // Joints 1 to 3 that bring the meeting point of axes 4 and 5 to P, axes 1 to 3 as on the nominal
  // arm; of a point out of reach those that come nearest. No elbow is straighter than `opening`.
  Reach reach(const Vector3& P, unsigned way, ArmTurns& turns, double opening = 0) const {
    const Vector3 w = link_[2].v + link_[2].tilt({0, 0, P_3_.z()});
    const Vector3& v1 = link_[0].v;
    const Vector3& v2 = link_[1].v;
    const double beside = v1.y() - sign1_ * (v2.z() + fold2_ * w.z());
    const double out_squared = P.x() * P.x() + P.y() * P.y() - beside * beside;
    const double out = std::copysign(std::sqrt(std::max(opening * unit_ * unit_, out_squared)),
                                     (way & kOtherShoulder) != 0 ? -1.0 : 1.0);
    turns.q1 = direction(P.x() * out + P.y() * beside, P.y() * out - P.x() * beside);
    const double x = out - v1.x();
    const double y = sign1_ * (P.z() - v1.z());
    const double upper = std::sqrt(v2.x() * v2.x() + v2.y() * v2.y());
    const double fore = std::sqrt(w.x() * w.x() + w.y() * w.y());
    const double cosine = (x * x + y * y - upper * upper - fore * fore) / (2 * upper * fore);
    const double sine_squared = 1 - cosine * cosine;
    const double sine = std::copysign(std::sqrt(std::max(opening, sine_squared)),
                                      (way & kOtherElbow) != 0 ? -1.0 : 1.0);
    const Turn bent =
        direction(std::clamp(cosine, -1.0, 1.0), sine) * Turn{v2.x() / upper, v2.y() / upper};
    const Turn of_fore{w.x() / fore, w.y() / fore};
    turns.q3 = (fold2_ > 0 ? bent : bent.back()) * of_fore.back();
    const double kx = v2.x() + fore * bent.c;
    const double ky = v2.y() + fore * bent.s;
    turns.q2 = direction(x * kx + y * ky, y * kx - x * ky);
    return {out_squared / (unit_ * unit_), sine_squared};
  }

  // A direction of frame 0 in frame 3.
  [[nodiscard]] Vector3 in_frame3(const ArmTurns& turns, const Vector3& d_0) const {
    const Vector3 d_1 = link_[0].tilt_back(turns.q1.back() * d_0);
    const Vector3 d_2 = link_[1].tilt_back(turns.q2.back() * d_1);
    return link_[2].tilt_back(turns.q3.back() * d_2);
  }
  [[nodiscard]] double miss(const ArmTurns& turns, const Vector3& axis5_0) const {
    return in_frame3(turns, axis5_0).z() - link_[3].c;
  }
  void turn_joint4(const Vector3& axis5_3, ArmTurns& turns) const {
    turns.q4 = direction(-sign4_ * axis5_3.y(), sign4_ * axis5_3.x());
  }

  // The same on the chain as it is, by Newton's method from there. False next to where ways meet.
  bool reach_exactly(const Vector3& P, const Vector3& axis5_0, ArmTurns& turns) const {
    constexpr int kMostSteps = 8;
    constexpr double kReached = 1e-15;
    constexpr double kFlattestMotion = 1e-7;
    constexpr double kLongestStep = 0.5;
    turn_joint4(in_frame3(turns, axis5_0), turns);
    double off = 0;
    for (int k = 0; k < kMostSteps; ++k) {
      const Vector3 p_2 = turns.q3 * (link_[2].v + link_[2].tilt(turns.q4 * P_3_));
      const Vector3 p_1 = turns.q2 * (link_[1].v + link_[1].tilt(p_2));
      const Vector3 p_0 = turns.q1 * (link_[0].v + link_[0].tilt(p_1));
      const Vector3 error = P - p_0;
      off = error.norm();
      if (off <= kReached * unit_) return true;
      const Vector3 by1(-p_0.y(), p_0.x(), 0);
      const Vector3 by2 = turns.q1 * link_[0].tilt({-p_1.y(), p_1.x(), 0});
      const Vector3 by3 =
          turns.q1 * link_[0].tilt(turns.q2 * link_[1].tilt({-p_2.y(), p_2.x(), 0}));
      const Vector3 across = by2.cross(by3);
      const double volume = by1.dot(across);
      if (std::abs(volume) < kFlattestMotion * unit_ * unit_ * unit_) return false;
      const Vector3 step =
          Vector3(error.dot(across), by1.dot(error.cross(by3)), by1.dot(by2.cross(error))) / volume;
      if (!(step.lpNorm<1>() < kLongestStep)) return false;
      turns.q1 = turns.q1 * turn_by(step.x());
      turns.q2 = turns.q2 * turn_by(step.y());
      turns.q3 = turns.q3 * turn_by(step.z());
      turn_joint4(in_frame3(turns, axis5_0), turns);
    }
    constexpr double kGoodEnough = 1e-11;
    return off <= kGoodEnough * unit_;
  }

  // All six readings' turns, joint 5 by the orientation that is left.
  [[nodiscard]] std::array<Turn, 6> all_turns(const ArmTurns& turns, const Turn& q6) const {
    const Vector3 x_0 = R_ * (q6.back() * Vector3::UnitX());
    const Vector3 x_4 = link_[3].tilt_back(turns.q4.back() * in_frame3(turns, x_0));
    return {turns.q1, turns.q2, turns.q3, turns.q4, direction(x_4.x(), x_4.y()), q6};
  }

 private:
  std::array<ArmLink, 6> link_;
  Vector3 P_3_;  // the point of axis 4 nearest to axis 5, beside it: in frame 3, joint 4 at zero
  Vector3 P_5_;  // that point in frame 5
  Vector3 axis5_5_;  // axis 5 in frame 5
  Matrix3 R_;        // frame 5 in frame 0, but for the turn of joint 6
  Vector3 p_;
  double unit_;
  double fold2_ = 1;
  double sign1_ = 1;
  double sign4_ = 1;
};

}  // namespace armsig::kinematics::postures
