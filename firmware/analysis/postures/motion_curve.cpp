// SPDX-License-Identifier: MIT
#include "firmware/analysis/postures/motion_curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/check.hpp"
#include "core/kinematics/forward.hpp"

namespace armsig::kinematics {
namespace {

// Of two postures that have nearly met the one is found from the other.
constexpr double kFirstStep = 2e-5;
constexpr double kLongestStep = 0.2;
constexpr double kShortestStep = 1e-6;
constexpr int kMostSteps = 2000;
constexpr int kMostCorrections = 5;
constexpr int kFewCorrections = 2;          // after these the next step is longer
constexpr double kOnCurve = 1e-10;          // angles, and lengths in units of the arm
constexpr double kLongestCorrection = 0.5;  // in parts of a step
constexpr double kStraight = 0.97;          // cosine between neighbouring tangents
constexpr double kOneCurve = 1e-9;          // least pivot: below, curves cross

// Column k of the unit matrix by the largest of what is left. False where that is none.
bool eliminate(Eigen::Index k, Eigen::Matrix<double, 6, 7>& A, Eigen::Matrix<double, 6, 1>& e,
               std::array<Eigen::Index, 7>& column) {
  Eigen::Index row = 0;
  Eigen::Index best = 0;
  const double pivot = A.bottomRightCorner(6 - k, 7 - k).cwiseAbs().maxCoeff(&row, &best);
  if (!(pivot > kOneCurve)) return false;
  row += k;
  best += k;
  if (row != k) {
    A.row(row).swap(A.row(k));
    std::swap(e[row], e[k]);
  }
  if (best != k) {
    A.col(best).swap(A.col(k));
    std::swap(column[static_cast<std::size_t>(best)], column[static_cast<std::size_t>(k)]);
  }
  const double inverse = 1 / A(k, k);
  A.row(k) *= inverse;
  e[k] *= inverse;
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (i == k) continue;
    const double by = A(i, k);
    A.row(i) -= by * A.row(k);
    e[i] -= by * e[k];
  }
  return true;
}

}  // namespace

MotionCurve::MotionCurve(const Chain& chain, const Pose& X_0n, const Line& line)
    : chain_(chain), X_0n_(X_0n), line_(line), has_line_(chain.joint_count == 6) {
  ARMSIG_CHECK(chain.joint_count == 6 || chain.joint_count == 7);
}

MotionCurve::Unknowns MotionCurve::unknowns_of(const JointVector& q) const {
  Unknowns y = Unknowns::Zero();
  for (std::size_t i = 0; i < q.size(); ++i) {
    y[static_cast<Eigen::Index>(i)] = chain_.revolute[i] ? q[i] : q[i] / chain_.length;
  }
  return y;
}

JointVector MotionCurve::readings_of(const Unknowns& y) const {
  JointVector q;
  for (std::size_t i = 0; i < chain_.joint_count; ++i) {
    const double unknown = y[static_cast<Eigen::Index>(i)];
    q.push_back(chain_.revolute[i] ? unknown : unknown * chain_.length);
  }
  return q;
}

bool MotionCurve::evaluate(const Unknowns& y, Residuals& e, Rates& A) const {
  const auto at = forward_with_jacobian(chain_, readings_of(y));
  if (!at) return false;
  Vector3 p = X_0n_.p;
  Matrix3 R = X_0n_.R;
  A.leftCols<6>() = at->J.leftCols<6>();
  if (has_line_) {
    const Matrix3 turn = rotation_about(line_.direction, y[6]);
    const Vector3 lever = turn * (X_0n_.p - line_.point);
    p = line_.point + lever;
    R = turn * X_0n_.R;
    A.col(6).head<3>() = -line_.direction.cross(lever);
    A.col(6).tail<3>() = -line_.direction;
  } else {
    A.col(6) = at->J.col(6);
  }
  e.head<3>() = (p - at->X_0n.p) / chain_.length;
  e.tail<3>() = rotation_vector(R * at->X_0n.R.transpose());
  A.topRows<3>() /= chain_.length;
  for (std::size_t i = 0; i < chain_.joint_count; ++i) {
    if (!chain_.revolute[i]) A.col(static_cast<Eigen::Index>(i)) *= chain_.length;
  }
  return true;
}

// Gauss and Jordan, with the largest pivot of all.
bool MotionCurve::solve(Rates A, Residuals e, const Unknowns& along, Unknowns& step,
                        Unknowns& tangent) {
  std::array<Eigen::Index, 7> column{0, 1, 2, 3, 4, 5, 6};
  for (Eigen::Index k = 0; k < 6; ++k) {
    if (!eliminate(k, A, e, column)) return false;
  }
  step.setZero();
  for (std::size_t k = 0; k < 6; ++k) {
    step[column[k]] = e[static_cast<Eigen::Index>(k)];
    tangent[column[k]] = -A(static_cast<Eigen::Index>(k), 6);
  }
  tangent[column[6]] = 1;
  tangent /= tangent.dot(along) < 0 ? -tangent.norm() : tangent.norm();
  step -= step.dot(tangent) * tangent;
  return true;
}

bool MotionCurve::correct(Unknowns& y, Unknowns& tangent, int& passes) const {
  Residuals e;
  Rates A;
  const Unknowns along = tangent;
  for (passes = 0; passes <= kMostCorrections; ++passes) {
    Unknowns step;
    if (!evaluate(y, e, A) || !solve(A, e, along, step, tangent)) return false;
    if (e.norm() <= kOnCurve) return true;
    y += step;
  }
  return false;
}

bool MotionCurve::begin(const JointVector& q, bool forwards) {
  at_ = before_ = begin_ = unknowns_of(q);
  Residuals e;
  Rates A;
  Unknowns step;
  const Unknowns along = forwards ? any_direction() : -any_direction();
  if (!evaluate(at_, e, A) || !solve(A, e, along, step, tangent_)) return false;
  begin_tangent_ = tangent_;
  step_ = kFirstStep;
  length_ = 0;
  steps_ = 0;
  whole_ = false;
  return true;
}

MotionCurve::Unknowns MotionCurve::any_direction() {
  return {0.31, 0.27, 0.41, 0.37, 0.29, 0.43, 0.35};
}

std::optional<JointVector> MotionCurve::from(const JointVector& q, double distance) const {
  Unknowns y = unknowns_of(q);
  Residuals e;
  Rates A;
  Unknowns step;
  Unknowns tangent;
  if (!evaluate(y, e, A) || !solve(A, e, any_direction(), step, tangent)) return std::nullopt;
  y += distance * tangent;
  int passes = 0;
  if (!correct(y, tangent, passes)) return std::nullopt;
  return readings_of(y);
}

bool MotionCurve::is_back() const {
  if (length_ < 4 * kLongestStep) return false;
  Unknowns from_begin = at_ - begin_;
  for (Eigen::Index i = 0; i < 7; ++i) {
    const bool turns = i == static_cast<Eigen::Index>(chain_.joint_count) ||
                       chain_.revolute[static_cast<std::size_t>(i)];
    if (turns) from_begin[i] = wrap_angle(from_begin[i]);
  }
  const double along = from_begin.dot(begin_tangent_);
  const double beside = (from_begin - along * begin_tangent_).norm();
  const double last = (at_ - before_).norm();
  return along >= 0 && along <= 1.1 * last && beside <= 0.3 * last &&
         tangent_.dot(begin_tangent_) > 0.9;
}

bool MotionCurve::advance() {
  if (whole_) return false;
  while (steps_ < kMostSteps && step_ >= kShortestStep) {
    ++steps_;
    Unknowns next = at_ + step_ * tangent_;
    const Unknowns guess = next;
    Unknowns tangent = tangent_;
    int passes = 0;
    const bool good = correct(next, tangent, passes) && tangent.dot(tangent_) > kStraight &&
                      (next - guess).norm() <= kLongestCorrection * step_;
    if (!good) {
      step_ *= 0.5;
      continue;
    }
    before_ = at_;
    at_ = next;
    tangent_ = tangent;
    length_ += (at_ - before_).norm();
    if (passes <= kFewCorrections) step_ = std::min(2 * step_, kLongestStep);
    whole_ = is_back();
    return true;
  }
  return false;
}

JointVector MotionCurve::near(double part) const {
  return readings_of(before_ + part * (at_ - before_));
}

JointVector MotionCurve::exactly(double part) const {
  Unknowns y = before_ + part * (at_ - before_);
  Unknowns tangent = tangent_;
  int passes = 0;
  const Unknowns between = y;
  return readings_of(correct(y, tangent, passes) ? y : between);
}

double MotionCurve::turn_before() const { return has_line_ ? wrap_angle(before_[6]) : 0; }
double MotionCurve::turn() const { return has_line_ ? wrap_angle(at_[6]) : 0; }

}  // namespace armsig::kinematics
