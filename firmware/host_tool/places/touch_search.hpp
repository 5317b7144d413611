// SPDX-License-Identifier: MIT
// Readings at which the tool of an arm is at a point, for places that do not stand yet.
#pragma once

#include <vector>

#include "core/clearance/clearance.hpp"
#include "core/kinematics/chain.hpp"

namespace armsig::tool {

class TouchSearch {
 public:
  struct Stand {
    JointVector q;
    Vector3 p_B = Vector3::Zero();  // of the tool
  };

  // `tool_F` in the last frame of the nominal model; `around` has nothing in the hand. The limits
  // of `arm` are kept. Precondition: as many limits as joints.
  TouchSearch(const Arm& arm, const Vector3& tool_F, clearance::Surroundings around);

  // Readings that the arm may stand at, spread evenly over its limits. Empty: there is none.
  [[nodiscard]] const std::vector<Stand>& stands() const { return stands_; }

  // Readings with the tool at `p_B` and its stem about `axis_B`, no two alike, `most` of them at
  // most: found by Newton's method for the position alone from readings spread evenly, so that the
  // arm comes in all of its postures. `sought`: touches that were sought beside it before; their
  // readings are passed over, so that this one is in another posture.
  [[nodiscard]] std::vector<JointVector> touches(const Vector3& p_B, const Vector3& axis_B,
                                                 std::size_t most, std::size_t sought = 0) const;

  // Whether a place may be there: inside the box, and above planes with room for what holds it.
  [[nodiscard]] bool has_room(const Vector3& p_B) const;

  // From the tool towards the flange, in frame B; zero for a tool that is at the flange.
  [[nodiscard]] Vector3 stem_B(const JointVector& q) const;

 private:
  [[nodiscard]] bool is_clear(const JointVector& q) const;
  [[nodiscard]] bool moves_to(const Vector3& p_B, JointVector& q) const;

  Arm arm_;
  Vector3 tool_F_;
  clearance::Surroundings around_;
  kinematics::Chain chain_;             // of effective readings
  std::vector<JointVector> effective_;  // by a reading of one: the columns of the couplings
  std::vector<Stand> stands_;
};

}  // namespace armsig::tool
