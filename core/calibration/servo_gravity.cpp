// SPDX-License-Identifier: MIT
#include "core/calibration/servo_gravity.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "core/base/check.hpp"
#include "core/kinematics/forward_kernel.hpp"

namespace armsig::calibration {

namespace {

using kinematics::Chain;
using kinematics::JointTerms;

// make_chain() lets frames slide along their axes, which the levers would notice.
void draw(const Arm& drawing, const std::array<double, kMaxJoints>& zero, std::size_t joint_count,
          Chain& chain) {
  chain.joint_count = joint_count;
  chain.has_prismatic = false;
  for (std::size_t i = 0; i < joint_count; ++i) {
    const DhJoint& row = drawing.joints[i];
    const bool revolute = row.type == JointType::kRevolute;
    chain.theta[i] = revolute ? zero[i] : row.theta_rad;
    chain.x[i] = row.a_m;
    chain.y[i] = 0;
    chain.z[i] = revolute ? row.d_m : zero[i];
    chain.cos_alpha[i] = std::cos(row.alpha_rad);
    chain.sin_alpha[i] = std::sin(row.alpha_rad);
    chain.revolute[i] = revolute;
    chain.revolute_bits[i] = revolute ? -1 : 0;
    chain.has_prismatic = chain.has_prismatic || !revolute;
  }
}

// The rows of R_U0, any rotation that brings `up` to z; the identity where it is there.
Matrix3 upright(const Vector3& up) {
  const Vector3 aside = std::abs(up.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY();
  Matrix3 R;
  R.row(2) = up.transpose();
  R.row(0) = (aside - up * up.dot(aside)).normalized().transpose();
  R.row(1) = up.cross(Vector3(R.row(0).transpose())).transpose();
  return R;
}

// Two numbers each: x and y of the axes and origins of the frames.
struct Horizontal {
  alignas(32) std::array<std::array<double, 4>, kMaxFrames> axes;
  alignas(32) std::array<std::array<double, 4>, kMaxFrames> origins;
};

using Rows = std::array<std::array<double, 4>, 3>;

kinematics::FrameRows<double> row_of(const std::array<double, 4>& row) {
  return {row[0], row[1], row[2], row[3]};
}

// V: as many lanes as the processor has, of which one is a plain double.
template <typename V>
[[gnu::always_inline]] inline void find_horizontal(const Chain& drawing, const JointTerms& terms,
                                                   const Rows& start, std::size_t first,
                                                   Horizontal& found) {
  if constexpr (std::is_same_v<V, double>) {
    kinematics::FrameRows<double> row_x = row_of(start[0]);
    kinematics::FrameRows<double> row_y = row_of(start[1]);
    for (std::size_t i = first;; ++i) {
      found.origins[i][0] = row_x.p;
      found.origins[i][1] = row_y.p;
      if (i == drawing.joint_count) return;
      found.axes[i][0] = row_x.z;
      found.axes[i][1] = row_y.z;
      row_x.advance(drawing, terms, i);
      row_y.advance(drawing, terms, i);
    }
  } else {
    const auto& [x, y, z] = start;
    kinematics::FrameRows<V> rows{V{x[0], y[0]}, V{x[1], y[1]}, V{x[2], y[2]}, V{x[3], y[3]}};
    for (std::size_t i = first;; ++i) {
      store(found.origins[i].data(), rows.p);
      if (i == drawing.joint_count) return;
      store(found.axes[i].data(), rows.z);
      rows.advance(drawing, terms, i);
    }
  }
}

// A prismatic joint gives way along its axis: z . down.
[[gnu::noinline]] void find_vertical(const Chain& drawing, const JointTerms& terms,
                                     const Rows& start, std::size_t first,
                                     std::array<double, kMaxJoints>& axis_z) {
  kinematics::FrameRows<double> row = row_of(start[2]);
  for (std::size_t i = first; i < drawing.joint_count; ++i) {
    axis_z[i] = row.z;
    row.advance(drawing, terms, i);
  }
}

}  // namespace

void ServoGravity::set(const PackedDeflections& deflections, const Arm& drawing) {
  lever_m_ = longest_lever_m(drawing);
  stand(drawing, deflections.up_0);
  terms_.clear();
  runs_.clear();
  slides_ = false;
  std::size_t frames = 1;
  for (std::size_t joint = 0; joint < drawing.joints.size(); ++joint) {
    const bool turns = drawing.joints[joint].type == JointType::kRevolute;
    if (joint < first_) continue;  // about the vertical: nothing pulls at it
    Run run{.joint = static_cast<std::uint8_t>(joint), .end = 0, .turns = turns, .sum = 0};
    for (const GravityTerm& term : deflections.gravity) {
      if (term.joint != joint) continue;
      terms_.push_back({term.coefficient, term.origin});
      run.sum += term.coefficient;
      frames = std::max(frames, turns ? std::size_t{term.origin} : joint + 1);
    }
    run.end = static_cast<std::uint8_t>(terms_.size());
    if (terms_.size() == (runs_.empty() ? 0 : runs_.back().end)) continue;
    runs_.push_back(run);
    slides_ = slides_ || !turns;
  }
  draw(drawing, deflections.drawn_zero, frames, drawing_);
  find_bounds();
}

void ServoGravity::stand(const Arm& nominal, const Vector3& up_0) {
  const Matrix3 R_U0 = upright(up_0);
  const DhJoint& row = nominal.joints[0];
  const bool vertical = row.type == JointType::kRevolute && up_0.head<2>().isZero(0);
  first_ = vertical ? 1 : 0;
  Pose X_UF{R_U0, Vector3::Zero()};
  if (vertical) X_UF = X_UF * Pose{rotation_x(row.alpha_rad), Vector3(row.a_m, 0, row.d_m)};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    first_rows_[i] = {X_UF.R(at, 0), X_UF.R(at, 1), X_UF.R(at, 2), X_UF.p[at]};
  }
}

void ServoGravity::find_bounds() {
  largest_ = steepest_ = 0;
  std::size_t begin = 0;
  for (const Run& run : runs_) {
    double sum = 0;
    for (std::size_t t = begin; t < run.end; ++t) sum += std::abs(terms_[t].coefficient);
    begin = run.end;
    largest_ = std::max(largest_, sum * (run.turns ? lever_m_ : 1.0));
    // A joint that turns by one moves the weight by its distance at most, or turns axis and weight
    // together against the vertical; a slide moves the weight by one.
    steepest_ = std::max(steepest_, sum * std::max(lever_m_, 1.0));
  }
}

void ServoGravity::at(const Values& q, Values& by) const {
  by.fill(0);
  if (empty()) return;
  JointTerms terms;
  const bool known = kinematics::joint_terms(drawing_, q.data(), terms);
  ARMSIG_CHECK(known);
  Horizontal found;
  find_horizontal<Pack<double>>(drawing_, terms, first_rows_, first_, found);
  std::size_t t = 0;
  for (const Run& run : runs_) {
    if (!run.turns) [[unlikely]] {
      t = run.end;
      continue;
    }
    double x = 0;
    double y = 0;
    for (; t < run.end; ++t) {
      const double* to = found.origins[terms_[t].origin].data();
      x += terms_[t].coefficient * to[0];
      y += terms_[t].coefficient * to[1];
    }
    const double* z = found.axes[run.joint].data();
    const double* from = found.origins[run.joint].data();
    by[run.joint] = z[1] * (x - run.sum * from[0]) - z[0] * (y - run.sum * from[1]);
  }
  if (!slides_) [[likely]]
    return;
  Values axis_z;
  find_vertical(drawing_, terms, first_rows_, first_, axis_z);
  for (const Run& run : runs_) {
    if (!run.turns) by[run.joint] = -run.sum * axis_z[run.joint];
  }
}

}  // namespace armsig::calibration
