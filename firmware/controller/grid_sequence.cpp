// SPDX-License-Identifier: MIT
#include "firmware/controller/grid_sequence.hpp"

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
  moving_ = told_ = false;
  touched_ = 0;
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
  announcer_.say(Line()
                     .text("# touched vertex=")
                     .integer(touched_)
                     .text(" of=")
                     .integer(configuration_.grid.grid.vertex_count()));
}

[[gnu::noinline]] void GridSequence::finish() {
  walk_.reset();
  mover_.send(CommandKind::kEndSequence);
  announcer_.say(Line().text("# touch-grid done touched=").integer(touched_));
}

[[gnu::noinline]] Result<JointVector> GridSequence::joints_at_vertex() const {
  const Pose X_0n = flange_pose(model(), {R_RT_, X_RW_ * walk_->vertex()});
  calibration::LatelyTurned nothing;
  ARMSIG_TRY(solution, joints_for(model(), X_0n, walk_->seed(), {.p_nP = model().p_nT}, nothing));
  return evaluation::readings_found(solution);
}

void GridSequence::go_on() {
  if (!walk_->next()) {
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
