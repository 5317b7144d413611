// SPDX-License-Identifier: MIT
#include "firmware/calibration/servo_gravity.hpp"

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

// No more than the arm's links laid end to end, its slides as long as their limits let them.
double longest_lever_m(const Arm& drawing) {
  double length = 0;
  for (std::size_t i = 0; i < drawing.joints.size(); ++i) {
    const DhJoint& row = drawing.joints[i];
    length += std::hypot(row.a_m, row.d_m);
    if (row.type == JointType::kPrismatic && !drawing.limits.empty()) {
      length += std::max(std::abs(drawing.limits[i].lower), std::abs(drawing.limits[i].upper));
    }
  }
  return std::min(length, kLongestLever_m);
}

// Two numbers each: x and y of the axes and origins of the frames from 1 on.
struct Horizontal {
  alignas(32) std::array<std::array<double, 4>, kMaxFrames> axes;
  alignas(32) std::array<std::array<double, 4>, kMaxFrames> origins;
};

// V: as many lanes as the processor has, of which one is a plain double. The first joint stands
// where its x axis is the base's.
template <typename V>
[[gnu::always_inline]] inline void find_horizontal(const Chain& drawing, const JointTerms& terms,
                                                   Horizontal& found) {
  const double x = drawing.x[0];
  const double c = drawing.cos_alpha[0];
  const double s = drawing.sin_alpha[0];
  if constexpr (std::is_same_v<V, double>) {
    kinematics::FrameRows<double> row_x{1, 0, 0, x};
    kinematics::FrameRows<double> row_y{0, c, -s, 0};
    for (std::size_t i = 1;; ++i) {
      found.origins[i][0] = row_x.p;
      found.origins[i][1] = row_y.p;
      if (i == drawing.joint_count) return;
      found.axes[i][0] = row_x.z;
      found.axes[i][1] = row_y.z;
      row_x.advance(drawing, terms, i);
      row_y.advance(drawing, terms, i);
    }
  } else {
    kinematics::FrameRows<V> rows{V{1, 0}, V{0, c}, V{0, -s}, V{x, 0}};
    for (std::size_t i = 1;; ++i) {
      store(found.origins[i].data(), rows.p);
      if (i == drawing.joint_count) return;
      store(found.axes[i].data(), rows.z);
      rows.advance(drawing, terms, i);
    }
  }
}

// A slide gives way along its axis: z . down.
[[gnu::noinline]] void find_vertical(const Chain& drawing, const JointTerms& terms,
                                     std::array<double, kMaxJoints>& axis_z) {
  kinematics::FrameRows<double> row{0, 0, 1, 0};
  for (std::size_t i = 0; i < drawing.joint_count; ++i) {
    axis_z[i] = row.z;
    row.advance(drawing, terms, i);
  }
}

}  // namespace

void ServoGravity::set(const PackedDeflections& deflections, const Arm& drawing) {
  lever_m_ = longest_lever_m(drawing);
  terms_.clear();
  runs_.clear();
  slides_ = false;
  std::size_t frames = 1;
  for (std::size_t joint = 0; joint < drawing.joints.size(); ++joint) {
    const bool turns = drawing.joints[joint].type == JointType::kRevolute;
    if (turns && joint == 0) continue;  // about the vertical: nothing pulls at it
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
  find_horizontal<Pack<double>>(drawing_, terms, found);
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
  find_vertical(drawing_, terms, axis_z);
  for (const Run& run : runs_) {
    if (!run.turns) by[run.joint] = -run.sum * axis_z[run.joint];
  }
}

}  // namespace armsig::calibration
