// SPDX-License-Identifier: MIT
#include "firmware/analysis/postures/closed_form.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"

namespace armsig::kinematics {
namespace {

constexpr double kSnapTwist = 0.05;    // rad from a quarter turn
constexpr double kSmallOffset = 0.03;  // m: what may be dropped
// Least openings of a posture. A millimetre of difference between the arms moves a fold of a
// metre-long arm by about these.
constexpr double kLeastReach = 0.03;  // m, base axis to wrist across the shoulder offset
constexpr double kLeastElbow = 0.06;  // rad
constexpr double kLeastWrist = 0.03;  // rad

// Next to a fold: within this many least openings.
constexpr double kNearFold = 4;

// A link with its twist snapped: cos and sin of alpha are -1, 0 or 1.
struct Link {
  double theta = 0;
  double a = 0;
  double d = 0;
  double cos_alpha = 1;
  double sin_alpha = 0;
  [[nodiscard]] bool parallel() const { return cos_alpha != 0; }
};

// Links 1 to 5; false if a twist is no quarter turn.
bool snapped_links(const Chain& chain, std::array<Link, 6>& links) {
  double carried = 0;  // rotation about z left over from the link before
  for (std::size_t i = 0; i < 5; ++i) {
    Link& link = links[i];
    link.cos_alpha = std::round(static_cast<double>(chain.cos_alpha[i]));
    link.sin_alpha = std::round(static_cast<double>(chain.sin_alpha[i]));
    const double miss = link.parallel() ? chain.sin_alpha[i] : chain.cos_alpha[i];
    if (std::abs(miss) > kSnapTwist) return false;
    link.theta = chain.theta[i] + carried;
    link.d = chain.z[i];
    link.a = chain.x[i];
    carried = 0;
    if (link.parallel()) {
      // Between parallel axes any direction is a common normal: turn x along the link.
      const double direction = std::atan2(chain.y[i], chain.x[i]);
      link.a = std::hypot(chain.x[i], chain.y[i]);
      link.theta += direction;
      carried = -link.cos_alpha * direction;
    } else if (std::abs(chain.y[i]) > kSmallOffset) {
      return false;
    }
  }
  links[5].theta = chain.theta[5] + carried;
  return true;
}

bool small(double length) { return std::abs(length) < kSmallOffset; }

struct Plane {
  double x = 0;
  double y = 0;
};

// R Rot(z, angle) Rot(x, quarter turn of the sign given).
Matrix3 turned(const Matrix3& R, double angle_rad, double sign) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  Matrix3 result;
  result.col(0) = c * R.col(0) + s * R.col(1);
  result.col(1) = sign * R.col(2);
  result.col(2) = sign * (s * R.col(0) - c * R.col(1));
  return result;
}

// Most angles need no library call.
double wrapped(double angle_rad) {
  return std::abs(angle_rad) < kPi ? angle_rad : wrap_angle(angle_rad);
}

// The rotation that joints 4, 5, 6 (or 2 + 3 + 4, 5, 6) make up for: Rz(first) Rx Rz(fifth) Rx
// Rz(sixth).
struct Wrist {
  double first = 0;
  double fifth = 0;
  double sixth = 0;
  bool straight = false;
};

Wrist solve_wrist(const ClosedForm& form, const Matrix3& M, bool flip) {
  Wrist wrist;
  const double bent = std::hypot(M(0, 2), M(1, 2));
  const double sign = flip ? -1.0 : 1.0;
  wrist.straight = bent < kNearFold * kLeastWrist;
  wrist.fifth = std::atan2(sign * bent, -form.sign4 * form.sign5 * M(2, 2));
  wrist.first = std::atan2(sign * form.sign5 * M(1, 2), sign * form.sign5 * M(0, 2));
  const Matrix3 before =
      turned(turned(Matrix3::Identity(), wrist.first, form.sign4), wrist.fifth, form.sign5);
  wrist.sixth = std::atan2(before.col(1).dot(M.col(0)) - before.col(0).dot(M.col(1)),
                           before.col(0).dot(M.col(0)) + before.col(1).dot(M.col(1)));
  return wrist;
}

double lefty_sign(const ClosedForm& form) {
  return -form.sign1 * form.shoulder_offset < 0 ? -1.0 : 1.0;
}

}  // namespace

ClosedForm closed_form(const Chain& chain) {
  ClosedForm form;
  if (chain.joint_count != 6 || chain.has_prismatic) return form;
  std::array<Link, 6> links{};
  if (!snapped_links(chain, links)) return form;
  for (std::size_t i = 0; i < 6; ++i) form.theta[i] = links[i].theta;
  form.a1 = links[0].a;
  form.d1 = links[0].d;
  form.a2 = links[1].a;
  form.sign1 = links[0].sin_alpha;
  form.sign3 = links[2].sin_alpha;
  form.sign4 = links[3].sin_alpha;
  form.sign5 = links[4].sin_alpha;
  form.fold2 = links[1].cos_alpha;
  const double aside = links[2].parallel() ? 0 : -form.sign3 * links[3].d;
  form.forearm = std::hypot(links[2].a, aside);
  form.forearm_angle = std::atan2(aside, links[2].a);
  form.d5 = links[4].d;
  const bool bent = !links[0].parallel() && !links[3].parallel() && !links[4].parallel();
  if (!bent || !links[1].parallel() || small(form.a2)) return form;
  // The turned joint 6 stands at the origin of frame 5; from there to frame n nothing is idealised.
  form.X_6n.p = Vector3(chain.x[5], chain.y[5], chain.z[5]);
  form.X_6n.R = Matrix3{{1, 0, 0},
                        {0, chain.cos_alpha[5], -chain.sin_alpha[5]},
                        {0, chain.sin_alpha[5], chain.cos_alpha[5]}};
  if (!links[2].parallel()) {
    form.shoulder_offset = links[1].d + form.fold2 * links[2].d;
    form.a4 = links[3].a;
    const bool spherical = small(form.a4) && small(form.d5) && small(links[4].a);
    if (spherical && !small(form.forearm)) form.design = Design::kSphericalWrist;
  } else if (form.fold2 > 0 && links[2].cos_alpha > 0 && small(links[4].a) &&
             !small(form.forearm)) {
    form.shoulder_offset = links[1].d + links[2].d + links[3].d;
    form.a4 = links[3].a;
    form.design = Design::kParallelAxes;
  }
  return form;
}

// NOLINTNEXTLINE(readability-function-size): a kernel
Start solve_closed_form(const ClosedForm& form, const Pose& X_0n, const Posture& posture) {
  ARMSIG_CHECK(form.design != Design::kOther);
  const bool spherical = form.design == Design::kSphericalWrist;
  const Pose X_06 = X_0n * form.X_6n.inverse();
  const double offset = form.shoulder_offset;
  Start start;

  // Shoulder: the wrist point is `offset` beside the plane of the arm, on either side of the base.
  const double radius = std::hypot(X_06.p.x(), X_06.p.y());
  const double across = std::sqrt(std::max(radius * radius - offset * offset, 0.0));
  start.near_fold = across < kNearFold * kLeastReach;
  start.reachable = radius > std::abs(offset) - kSmallOffset;
  double margin = kSmallOffset;
  const double reach = (posture.lefty ? 1.0 : -1.0) * lefty_sign(form) * across;
  const double angle1 =
      std::atan2(X_06.p.y(), X_06.p.x()) - std::atan2(-form.sign1 * offset, reach);
  const Matrix3 R_01 = turned(Matrix3::Identity(), angle1, form.sign1);

  // The point that the elbow has to reach, in the plane of the arm seen from the shoulder.
  Plane goal{reach - form.a1, form.sign1 * (X_06.p.z() - form.d1)};
  Wrist wrist;
  if (!spherical) {
    wrist = solve_wrist(form, R_01.transpose() * X_06.R, posture.flip);
    // The direction of a straight wrist is uncertain, and it places the elbow's goal.
    if (wrist.straight) margin += std::abs(form.d5);
    const double c = std::cos(wrist.first);
    const double s = std::sin(wrist.first);
    goal.x -= form.d5 * form.sign4 * s + form.a4 * c;
    goal.y += form.d5 * form.sign4 * c - form.a4 * s;
  }

  // Elbow: two sides of the triangle are the upper arm and the forearm.
  const double length = form.forearm;
  const double distance = std::hypot(goal.x, goal.y);
  const double cosine =
      (distance * distance - form.a2 * form.a2 - length * length) / (2 * form.a2 * length);
  const double exact = std::acos(std::clamp(cosine, -1.0, 1.0));
  start.near_fold = start.near_fold || std::sin(exact) < std::sin(kNearFold * kLeastElbow);
  start.reachable = start.reachable && distance < form.a2 + length + margin &&
                    distance > std::abs(form.a2 - length) - margin;
  // The elbow is above if the forearm bends downwards, as seen with the wrist in front.
  const double bend = (posture.above == (reach > 0) ? -1.0 : 1.0) * form.sign1 * form.fold2;
  const double angle3 = bend * exact - form.forearm_angle;
  const double angle2 =
      std::atan2(goal.y, goal.x) -
      std::atan2(form.fold2 * bend * length * std::sin(exact), form.a2 + length * std::cos(exact));
  double angle4 = wrist.first - angle2 - angle3;
  if (spherical) {
    // Between parallel axes the angles add up, with the sign of the fold between them.
    Matrix3 R_02 = R_01;
    R_02.rightCols<2>() *= form.fold2;
    const Matrix3 R_03 = turned(R_02, form.fold2 * angle2 + angle3, form.sign3);
    wrist = solve_wrist(form, R_03.transpose() * X_06.R, posture.flip);
    angle4 = wrist.first;
  }

  start.near_fold = start.near_fold || wrist.straight;
  start.q = {angle1, angle2, angle3, angle4, wrist.fifth, wrist.sixth};
  for (std::size_t i = 0; i < 6; ++i) start.q[i] = wrapped(start.q[i] - form.theta[i]);
  return start;
}

Posture posture_of(const ClosedForm& form, const JointVector& q) {
  ARMSIG_CHECK(form.design != Design::kOther && q.size() == 6);
  std::array<double, 6> angle{};
  for (std::size_t i = 0; i < 6; ++i) angle[i] = q[i] + form.theta[i];
  const double bend = angle[2] + form.forearm_angle;
  double reach = form.a1 + form.a2 * std::cos(angle[1]) +
                 form.forearm * std::cos(angle[1] + form.fold2 * bend);
  if (form.design == Design::kParallelAxes) {
    const double first = angle[1] + angle[2] + angle[3];
    reach += form.a4 * std::cos(first) + form.d5 * form.sign4 * std::sin(first);
  }
  Posture posture;
  posture.lefty = (reach > 0) == (lefty_sign(form) > 0);
  const bool downwards = form.sign1 * form.fold2 * std::sin(bend) < 0;
  posture.above = downwards == (reach > 0);
  posture.flip = std::sin(angle[4]) < 0;
  return posture;
}

}  // namespace armsig::kinematics
