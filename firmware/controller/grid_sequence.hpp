// SPDX-License-Identifier: MIT
// The grid-touching task of section 4 of the paper on the real arm: the workspace is taught by
// three readings, and the tool is sent to every vertex through the model that the arm is servoed
// with.
#pragma once

#include <optional>

#include "core/evaluation/tool_pose.hpp"
#include "firmware/controller/announcer.hpp"
#include "firmware/controller/mover.hpp"
#include "firmware/controller/workspace.hpp"

namespace armsig::controller {

class GridSequence {
 public:
  GridSequence(const Configuration& configuration, Mover& mover, const Link& link,
               const Announcer& announcer);

  // Errors: kUnsupported (no grid is configured), kNotFinite. Precondition: not is_running().
  Result<void> begin();
  // The kBeginSequence that it needs, sent after begin().
  void begun(Ticket ticket) { ticket_ = ticket; }
  void end(Error error, std::optional<std::size_t> joint = {});
  void step();

  [[nodiscard]] bool is_running() const { return walk_.has_value(); }
  [[nodiscard]] std::size_t touched() const { return touched_; }

 private:
  [[nodiscard]] const Model& model() const;
  [[nodiscard]] Result<JointVector> joints_at_vertex();
  void tell_missed(Line& line, double missed_rad) const;
  // Whether the way to the vertex is clear; while it is being looked at, or where it is not and the
  // sequence has ended: no.
  [[nodiscard]] bool is_clear_to(const JointVector& q);
  void tell_touched();
  void finish();
  void go_on();

  const Configuration& configuration_;
  Mover& mover_;
  const Link& link_;
  const Announcer& announcer_;

  std::optional<evaluation::VertexWalk> walk_;
  bool checking_ = false;  // every vertex is solved for, and the way there, before the arm moves
  bool moving_ = false;
  bool told_ = false;  // that the tool is at the vertex
  Ticket ticket_ = 0;  // of the last command
  hal::Instant move_ends_;
  Pose X_RW_;
  Matrix3 R_RT_ = Matrix3::Identity();
  // By which the orientation is missed, of an arm of fewer than six joints [rad].
  double missed_rad_ = 0;  // at the vertex
  double most_missed_rad_ = 0;
  std::size_t touched_ = 0;
#ifndef ARMSIG_NO_REFINEMENT
  WayLook look_;          // from the vertex before to the present one
  bool looking_ = false;  // at it
  JointVector before_;    // where that way begins
#endif
};

}  // namespace armsig::controller
