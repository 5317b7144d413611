// SPDX-License-Identifier: MIT
// Moves with minimum jerk: in joint space, and straight lines of the tool.
#pragma once

#include <chrono>
#include <optional>

#include "core/base/pose.hpp"
#include "firmware/controller/configuration.hpp"
#include "firmware/controller/model.hpp"
#include "firmware/controller/path_parameter.hpp"
#include "firmware/controller/workspace.hpp"

namespace armsig::controller {

enum class MoveKind : std::uint8_t { kJoint, kLine };

// All of a move that is known before it begins.
struct Move {
  MoveKind kind = MoveKind::kJoint;
  JointVector from;
  JointVector to;  // of a line: where the plan ends
  Pose X_RT_from;  // line only
  Pose X_RT_to;
  double duration_s = 0;
  BrakingLimits braking;  // of the path parameter, after a halt
};

// How long the move takes, if no tick is late.
[[nodiscard]] inline hal::Duration lasting(const Move& move) {
  return std::chrono::duration_cast<hal::Duration>(std::chrono::duration<double>(move.duration_s));
}

struct MoveRefusal {
  Error error = Error::kNotFinite;
  std::optional<std::size_t> joint;
};
using Planned = std::expected<Move, MoveRefusal>;

// `pace` in (0, 1] slows the limits down.
// Errors: kNotFinite, kOutOfRange (pace, number of readings), kJointLimit.
[[nodiscard]] Planned plan_joint_move(const Configuration& configuration, const JointVector& from,
                                      const JointVector& to, double pace = 1);

// Plans a straight line of the tool, a bounded step at a time: the line is walked in kLineSamples
// samples through the inverse of the model before anything moves. An arm of fewer than six joints
// keeps the position on the line, and the orientation as near as its joints can. `configuration`
// and `model` must stay as they are meanwhile.
inline constexpr int kLineSamples = 100;
// Passes of the inverse in one step. With 22 of them the longest step of a line that ends out of
// reach took 352,000 instructions of the R5F (2026-11-22), 16,000 a pass.
inline constexpr int kPassesAStep = 10;
class LinePlanning {
 public:
  LinePlanning(const Configuration& configuration, const Model& model, const JointVector& from,
               const Pose& X_RT_to, double pace);

  // A few samples of the line, or a part of one that is hard to reach; false if nothing is left to
  // do.
  bool step();
  // Of the inverse, up to now.
  [[nodiscard]] int passes() const { return passes_; }
  // The largest angle by which the samples up to now miss the orientation of the line [rad].
  [[nodiscard]] double missed_rad() const { return missed_rad_; }
  // Precondition: step() has returned false.
  // Errors: kNotFinite, kOutOfRange, kOutOfReach, kJointLimit, kSingularPath, kNotConverged,
  // kOutsideWorkspace.
  [[nodiscard]] const Planned& result() const { return planned_; }
  // What is too near to what, where the error is kOutsideWorkspace.
  [[nodiscard]] const clearance::Room& room() const { return room_; }

 private:
  void begin(const Pose& X_RT_to);
  void sample(int passes);
  void take(const JointVector& q);
  void keep_limits(const JointVector& slope, const JointVector& before);
  [[nodiscard]] bool keeps_clear(const JointVector& q);

  const Configuration& configuration_;
  const Model& model_;
  double pace_;
  Planned planned_;
  JointVector slope_before_;
  PathShares shares_;
  calibration::LatelyTurned lately_;
  JointVector search_;  // where the inverse of the sample under way has come to
  double left_m_ = 0;   // and how far it is from there, position and orientation together
  double missed_rad_ = 0;
  int done_ = 0;  // samples
  int passes_ = 0;
  int passes_of_sample_ = 0;
  double asked_room_m_ = kLeastRoom_m;
  clearance::Room room_;
};

// Looks at the way of a joint move, a bounded step at a time.
class MoveLook {
 public:
  MoveLook(const Configuration& configuration, const Move& move)
      : configuration_(configuration),
        planned_(move),
        look_(asked_room_m(configuration, move.from)) {}

  // False if nothing is left to do.
  bool step();
  // Precondition: step() has returned false. Error: kOutsideWorkspace.
  [[nodiscard]] const Planned& result() const { return planned_; }
  [[nodiscard]] const clearance::Room& room() const { return look_.room(); }

 private:
  const Configuration& configuration_;
  Planned planned_;
  WayLook look_;
};

// The whole of it at once.
[[nodiscard]] Planned plan_line(const Configuration& configuration, const Model& model,
                                const JointVector& from, const Pose& X_RT_to, double pace = 1);

// The tool pose at s in [0, 1]: straight, turned about one axis.
[[nodiscard]] Pose line_pose(const Move& line, double s);

// The joint readings at s in [0, 1] of the path, reached from `former` within a tick.
// Errors of a line: kOutOfReach, kJointLimit, kSingularPath, kSpeedLimit (a joint would have to be
// faster than its limit), kNotConverged, kNotFinite.
// `lately`: what the tick before has found.
[[nodiscard]] Result<JointVector> readings_at(const Move& move, const Configuration& configuration,
                                              const Model& model, const JointVector& former,
                                              double s, calibration::LatelyTurned& lately);

}  // namespace armsig::controller
