// SPDX-License-Identifier: MIT
// Joints that can move without frame n: the readings nearest to what was asked for, on every
// stretch of their curve inside the limits.
#pragma once

#include <cstdint>

#include "firmware/analysis/postures/motion_curve.hpp"
#include "firmware/analysis/postures/posture_list.hpp"

namespace armsig::kinematics {

class FreeMotion {
 public:
  // Six or seven joints. All are kept by reference.
  FreeMotion(const Chain& chain, const Pose& X_0n, const PostureList& list);

  static constexpr std::size_t kMaxStretches = 16;
  using Stretches = FixedVector<JointVector, kMaxStretches>;
  enum class Kind : std::uint8_t {
    kNone,   // the joints are not free, or in more ways than along one curve
    kKnown,  // the curve is that of one of `known`
    kNew,
  };

  // Follows the curve of q, which meets the pose. `best`: the worthiest readings of each stretch
  // inside the limits; where there is none, those least outside.
  template <typename Known>
  Kind follow(const JointVector& q, const Known& known, Stretches& best) {
    known_.clear();
    for (const JointVector& one : known) known_.push_back(one);
    return follow(q, best);
  }

 private:
  struct Sample {
    JointVector q;
    PostureList::Worth worth;
  };
  struct Candidate {
    Sample sample;
    int stretch = 0;
  };

  Kind follow(const JointVector& q, Stretches& best);
  // One way along the curve. False where a known one is met.
  bool follow_one_way(const Sample& first, bool& free);
  void look_at(const Sample& before, const Sample& at, const Sample& next, int& stretch);
  [[nodiscard]] bool passes_known() const;
  [[nodiscard]] bool passes(const JointVector& one) const;
  [[nodiscard]] Sample sample(const JointVector& q) const { return {q, list_.worth(q)}; }
  // The worthiest nearby.
  [[nodiscard]] Sample refined(Sample at) const;
  void keep_best(Stretches& best);

  static constexpr std::size_t kMaxKnown = 48;

  const Chain& chain_;
  const PostureList& list_;
  MotionCurve curve_;
  FixedVector<JointVector, kMaxKnown> known_;
  FixedVector<Candidate, 64> candidates_;
  int stretches_ = 0;
};

}  // namespace armsig::kinematics
