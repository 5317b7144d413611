// SPDX-License-Identifier: MIT
#include "firmware/controller/grid_sequence.hpp"

#include <algorithm>

namespace armsig::controller {

GridSequence::GridSequence(const Configuration& configuration, Mover& mover, const Link& link,
                           const Announcer& announcer)
    : configuration_(configuration), mover_(mover), link_(link), announcer_(announcer) {}

const Model& GridSequence::model() const { return link_.models[mover_.now().model]; }

Result<void> GridSequence::begin() {
  const auto& taught = configuration_.grid.taught;
  if (taught[0].empty()) return std::unexpected(Error::kUnsupported);
  ARMSIG_TRY(origin, tool_pose(model(), taught[0]));
  ARMSIG_TRY(on_x, tool_pose(model(), taught[1]));
  ARMSIG_TRY(on_xy, tool_pose(model(), taught[2]));
  X_RW_ = evaluation::taught_frame(origin.p, on_x.p, on_xy.p);
  R_RT_ = origin.R;
  walk_.emplace(configuration_.grid.grid, taught[0]);
  checking_ = true;
#ifndef ARMSIG_NO_REFINEMENT
  look_ = {};
  looking_ = false;
  before_ = mover_.now().commanded;
#endif
  moving_ = told_ = false;
  touched_ = 0;
  most_missed_rad_ = 0;
  return {};
}

// Functions of their own, here and below: a line would stand on the stack below the inverse.
[[gnu::noinline]] void GridSequence::end(Error error, std::optional<std::size_t> joint) {
  if (!is_running()) return;
  walk_.reset();
  mover_.send(CommandKind::kEndSequence);
  Line line;
  line.text("# touch-grid ended touched=").integer(touched_).reason(error);
  if (joint) line.text(" joint=").integer(*joint + 1);
  announcer_.say(line);
}

void GridSequence::step() {
  if (!is_running() || !mover_.is_handled(ticket_)) return;
  const Snapshot& snapshot = mover_.now();
  // First, as what was sent in the tick of the fault was refused because of it.
  if (snapshot.fault) {
    end(snapshot.fault->error, snapshot.fault->joint);
    return;
  }
  if (const auto refusal = mover_.refusal(ticket_)) {
    end(*refusal);
    return;
  }
  if (snapshot.mode != Mode::kSweeping) {
    end(Error::kSequenceStopped);
    return;
  }
  if (moving_) {
    const bool arrived = mover_.has_arrived(ticket_, configuration_.dwell.settle);
    if (arrived && !told_) tell_touched();
    if (!mover_.has_arrived(ticket_, configuration_.dwell.settle + configuration_.grid.dwell)) {
      if (snapshot.now > move_ends_) end(Error::kNotSettled, mover_.furthest_joint());
      return;
    }
    moving_ = told_ = false;
  }
  go_on();
}

[[gnu::noinline]] void GridSequence::tell_touched() {
  told_ = true;
  ++touched_;
  Line line;
  line.text("# touched vertex=").integer(touched_);
  line.text(" of=").integer(configuration_.grid.grid.vertex_count());
  tell_missed(line, missed_rad_);
  announcer_.say(line);
}

void GridSequence::tell_missed(Line& line, double missed_rad) const {
  if (may_miss_orientation(model())) line.orientation_missed(missed_rad);
}

[[gnu::noinline]] void GridSequence::finish() {
  walk_.reset();
  mover_.send(CommandKind::kEndSequence);
  Line line;
  line.text("# touch-grid done touched=").integer(touched_);
  tell_missed(line, most_missed_rad_);
  announcer_.say(line);
}

[[gnu::noinline]] Result<JointVector> GridSequence::joints_at_vertex() {
  const Pose X_RT{R_RT_, X_RW_ * walk_->vertex()};
  calibration::LatelyTurned nothing;
  ARMSIG_TRY(solution, joints_for(model(), X_RT, walk_->seed(), {}, nothing));
  missed_rad_ = solution.rotation_error_rad;
  most_missed_rad_ = std::max(most_missed_rad_, missed_rad_);
  return evaluation::readings_found(solution);
}

#ifndef ARMSIG_NO_REFINEMENT
bool GridSequence::is_clear_to(const JointVector& q) {
  const auto says = look_on(look_, configuration_, before_, q);
  looking_ = says == WayLook::Says::kMore;
  if (looking_) return false;
  if (says == WayLook::Says::kClear) {
    look_ = {};
    before_ = q;
    return true;
  }
  Line line;
  line.text("# touch-grid finds no way");
  add_room(line, look_.room());
  announcer_.say(line);
  end(Error::kOutsideWorkspace, moving_joint(configuration_, look_.room()));
  return false;
}
#else
bool GridSequence::is_clear_to(const JointVector&) { return true; }
#endif

void GridSequence::go_on() {
#ifndef ARMSIG_NO_REFINEMENT
  const bool onward = !looking_;
#else
  constexpr bool onward = true;
#endif
  if (onward && !walk_->next()) {
    if (checking_) {
      checking_ = false;
      walk_.emplace(configuration_.grid.grid, configuration_.grid.taught[0]);
      return;
    }
    finish();
    return;
  }
  const auto q = joints_at_vertex();
  if (!q) {
    end(q.error());
    return;
  }
  if (checking_ && !is_clear_to(*q)) return;
  walk_->reached(*q);
  if (checking_) return;
  const auto move = plan_joint_move(configuration_, mover_.now().commanded, *q);
  if (!move) {
    end(move.error().error, move.error().joint);
    return;
  }
  const auto sent = mover_.send(*move, Mover::Of::kSequence);
  if (!sent) {
    end(Error::kLateTick);
    return;
  }
  ticket_ = *sent;
  moving_ = true;
  move_ends_ = mover_.now().now + lasting(*move) + configuration_.dwell.settle +
               configuration_.grid.dwell + configuration_.dwell.settle_timeout;
}

}  // namespace armsig::controller
