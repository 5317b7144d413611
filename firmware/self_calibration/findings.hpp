// SPDX-License-Identifier: MIT
// What a fit is worth: what accuracy may be expected of it over the poses in which the arm works.
#pragma once

#include <array>
#include <span>

#include "core/base/tool_accuracy.hpp"
#include "core/calibration/engine.hpp"
#include "firmware/self_calibration/held_out_judge.hpp"
#include "firmware/self_calibration/play.hpp"

namespace armsig::controller {

// One number a joint.
using PerJoint = std::array<double, kMaxJoints>;

// From where to where the readings of the fitted rows go, effective ones.
struct Covered {
  PerJoint lower;
  PerJoint upper;

  Covered();
  void add(const JointVector& readings);
  [[nodiscard]] bool has(std::size_t joint, double reading) const {
    return reading >= lower[joint] && reading <= upper[joint];
  }
};

// The variance [m^2] of the tool's place by what the model leaves open, and by play; sums over some
// poses, and their parts.
struct Prediction {
  std::size_t poses = 0;
  double model_m2 = 0;
  double play_m2 = 0;
  PerJoint maps_m2{};       // of the model, where the readings are covered
  PerJoint uncovered_m2{};  // of it, where they are not
  PerJoint plays_m2{};
  PerJoint levers_m2{};  // squares of how far a target is from the axis [m/rad]; of a slide 1

  void add(const calibration::Engine& engine, const calibration::ChainFrames& frames,
           const JointVector& readings, const Covered& covered, const Motions& motions,
           const HalfPlays& play);
};

// The parts of what is predicted [m], RMS over the poses, and the joint that has most of one.
struct Budget {
  struct Part {
    double length_m = 0;
    std::size_t joint = 0;  // that has most of it
    double of_joint_m = 0;  // that joint's
  };
  double geometry_m = 0;  // and gravity: what noise leaves open, as in maps
  Part maps;
  Part uncovered;  // maps at readings that were not measured
  Part play;
  double unexplained_m = 0;  // by which the held-out poses are worse than stated
  std::size_t shortest = 0;  // turning joint that moves the target least, by `lever_m` a radian
  double lever_m = 0;
};
// Precondition: there is a pose in `prediction`. `model_m`: as in Findings.
[[nodiscard]] Budget budget_of(const Prediction& prediction, const JointTypes& types,
                               double model_m);

// How each joint moves the target at `frames`.
[[nodiscard]] Motions motions_at(const calibration::ArmModel& model,
                                 const calibration::ChainFrames& frames, const Vector3& p_L);

struct Findings {
  HeldOutJudge::Score held_out;
  // RMS length of what the model leaves open, enlarged by the factor.
  double model_m = 0;
  double play_m = 0;    // and of what play adds
  double sensor_m = 0;  // 1 sigma of a measured point per axis, as the rows show it
  HalfPlays play;
  Budget budget = {};
  std::size_t fitted = 0;    // rows
  std::size_t rejected = 0;  // of them, as blunders

  [[nodiscard]] double predicted_m() const;
  [[nodiscard]] ToolAccuracy::Predicted predicted() const {
    return {predicted_m(), PredictedRegion::kJointLimits};
  }
  [[nodiscard]] bool is_believed() const { return held_out.poses >= kFewestSelfHeldOut; }
  // Measurements, of so many times the present number, by which `accuracy_m` would be reached;
  // infinite where play is in the way.
  [[nodiscard]] double times_more(double accuracy_m) const;
};

}  // namespace armsig::controller
