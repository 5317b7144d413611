// SPDX-License-Identifier: MIT
// What two arms give way by beyond their readings, joint by joint: joint error maps, and
// gravity.
#pragma once

#include <array>

#include "core/calibration/model.hpp"

namespace armsig::differences {

// Maps and gravity of one arm; none: it has none.
struct Bending {
  const calibration::ArmModel* model = nullptr;  // kept by whoever made this
  JointVector configuration;  // effective readings at which the joints stand as the readings say
};

// Of the drawing, and of the arm that is held against it.
struct Bendings {
  Bending drawn;
  Bending actual;

  [[nodiscard]] bool any() const { return drawn.model != nullptr || actual.model != nullptr; }
};

// rad of a revolute joint, m of a prismatic one.
using BendValues = std::array<double, kMaxJoints>;
struct Bend {
  BendValues drawn{};            // all that the drawing gives way by
  BendValues more_by_map{};      // what the arm's map adds to that
  BendValues more_by_gravity{};  // and its gravity
};

class Bends {
 public:
  // Preconditions: models of as many joints as their configurations.
  explicit Bends(const Bendings& bendings);

  // At the readings of the encoders; `effective`: couplings applied.
  [[nodiscard]] Bend at(const JointVector& readings, const JointVector& effective) const;

 private:
  struct Side {
    const calibration::ArmModel* model = nullptr;
    BendValues map_at_rest{};
    BendValues gravity_at_rest{};
  };

  static Side side_of(const Bending& bending);
  static void evaluate(const Side& side, const JointVector& readings, const JointVector& effective,
                       BendValues& map, BendValues& gravity);

  Side drawn_;
  Side actual_;
};

}  // namespace armsig::differences
