// SPDX-License-Identifier: MIT
// The postures of one pose, each once: what a cold start finds is put in order here.
#pragma once

#include <tuple>

#include "core/kinematics/inverse.hpp"
#include "firmware/analysis/postures/closed_form.hpp"

namespace armsig::kinematics {

struct NamedSolution {
  // A solution outside the joint limits is listed too, as kJointLimit; its q then meets the pose
  // and breaks a limit. All others are kConverged or kDegraded.
  InverseSolution solution;
  bool named = false;  // whether the arm has a closed form, and with it postures
  Posture posture;
};

// From this regularity on a solution is far from all others.
inline constexpr double kClearOfFolds = 0.03;
inline constexpr std::size_t kMaxSolutions = 16;
using Solutions = FixedVector<NamedSolution, kMaxSolutions>;

// Where joint i is looked for: its limits, where they end; a turn, or an arm's length of travel,
// where they don't.
[[nodiscard]] JointLimits range_of(const Chain& chain, std::size_t i);

class PostureList {
 public:
  static constexpr std::size_t kMaxFound = 48;

  // `reference` may be empty: the middle of the ranges. All but the last two are kept by reference.
  PostureList(const Chain& chain, const ClosedForm& form, const Pose& X_0n,
              const JointVector& reference, double rotation_tolerance_rad);

  // Takes a solution that meets the pose, unless it is on the list; the list is never without room
  // for one inside the limits while it holds one outside.
  void add(InverseSolution solution);

  [[nodiscard]] std::size_t size() const { return found_.size(); }
  [[nodiscard]] bool empty() const { return found_.empty(); }
  [[nodiscard]] const InverseSolution& operator[](std::size_t k) const {
    return found_[k].solution;
  }
  [[nodiscard]] bool has_one_inside() const;
  // The place of readings that are one posture with `solution`; size() where there is none.
  [[nodiscard]] std::size_t place_of(const InverseSolution& solution) const;
  // The first of the list in order.
  [[nodiscard]] Solutions sorted() const;

  // Each revolute joint by the whole turns that bring it inside its limits, and to the reference.
  [[nodiscard]] JointVector turned(JointVector q) const;
  // By how much readings are beyond their limits, and how far from the reference: less is better.
  struct Worth {
    double beyond = 0;
    double distance = 0;

    auto operator<=>(const Worth&) const = default;
  };
  [[nodiscard]] Worth worth(const JointVector& q) const;

 private:
  using Key = std::tuple<bool, bool, bool, double>;

  [[nodiscard]] Key key(const NamedSolution& named, double turned_rad) const;
  [[nodiscard]] bool is_same_posture(const InverseSolution& a, const InverseSolution& b) const;
  [[nodiscard]] bool leads_between(JointVector q, const JointVector& change) const;
  [[nodiscard]] bool is_met_at(JointVector q, const JointVector& change, double within) const;

  const Chain& chain_;
  const ClosedForm& form_;
  const Pose& X_0n_;
  JointVector reference_;
  double rotation_tolerance_rad_;
  FixedVector<NamedSolution, kMaxFound> found_;
  bool replaced_ = false;  // one of these, by a better one
};

}  // namespace armsig::kinematics
