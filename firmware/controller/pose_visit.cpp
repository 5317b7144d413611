// SPDX-License-Identifier: MIT
#include "firmware/controller/pose_visit.hpp"

#include <utility>

#include "core/base/low_discrepancy.hpp"

namespace armsig::controller {
namespace {

// Times in a row that a point may be begun anew because the arm moved.
constexpr unsigned kMovedInARow = 3;

VisitOutcome ends(Error error, std::optional<std::size_t> joint = {}) {
  return {VisitOutcome::What::kEnds, {error, joint}};
}

}  // namespace

bool is_of_the_place(Error error) {
  return error == Error::kTooFewReceivers || error == Error::kReceiversCollinear ||
         error == Error::kMirrorAmbiguity || error == Error::kRangesInconsistent ||
         error == Error::kSingular || (kMayTakePoints && error == Error::kPointsDiffer);
}

JointVector spread_pose(const Configuration& configuration, std::size_t index) {
  const Arm& arm = configuration.drawing;
  FixedVector<JointLimits, kMaxJoints> limits;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const auto [lower, upper] = arm.limits[i];
    const double centre = configuration.sweeps.configuration[i];
    const double reach = configuration.sweeps.validation_reach;
    limits.push_back({centre + reach * (lower - centre), centre + reach * (upper - centre)});
  }
  return evenly_spread_configuration(types_of(arm.joints), limits, static_cast<int>(index) + 1);
}

JointVector held_out_pose(const Configuration& configuration, std::size_t index) {
  constexpr std::size_t kFirstFar = 64;
  if constexpr (kMayBound) {
    if (index >= kFirstFar) index += 2'000'000;
  }
  return spread_pose(configuration, index);
}

void PoseVisit::begin(Ticket begun) {
  phase_ = Phase::kNext;
  moved_in_a_row_ = 0;
  ticket_ = begun;
  forget_look();
}

#ifndef ARMSIG_NO_REFINEMENT
WayLook::Says PoseVisit::look_at_way(const JointVector& q) {
  if (looks_.at != Looking::kAtPose) return WayLook::Says::kClear;
  const auto says = look_on(looks_.look, configuration_, configuration_.sweeps.configuration, q);
  if (says == WayLook::Says::kClear) looks_ = {.look = {}, .at = Looking::kAtWay};
  if (says == WayLook::Says::kLeaves) forget_look();
  return says;
}

std::expected<void, MoveRefusal> PoseVisit::go_inside(const JointVector& q) {
  const bool home = looks_.at == Looking::kAtWayHome;
  const JointVector& to = home ? configuration_.sweeps.configuration : q;
  const auto says = look_on(looks_.look, configuration_, mover_.now().commanded, to);
  if (says == WayLook::Says::kMore) return {};
  if (says == WayLook::Says::kLeaves) {
    if (home) {
      const clearance::Room& room = looks_.look.room();
      tell_no_way(room);
      return std::unexpected(
          MoveRefusal{Error::kOutsideWorkspace, moving_joint(configuration_, room)});
    }
    looks_ = {.look = {}, .at = Looking::kAtWayHome};
    return {};
  }
  looks_ = {.look = {}, .at = home ? Looking::kAtWay : Looking::kAtPose, .goes_home = home};
  return move_to(to);
}

[[gnu::noinline]] void PoseVisit::tell_no_way(const clearance::Room& room) const {
  Line line;
  line.text("# ").text(sequence_).text(" finds no way");
  add_room(line, room);
  announcer_.say(line);
}

bool PoseVisit::is_half_way() { return std::exchange(looks_.goes_home, false); }
#endif

std::expected<void, MoveRefusal> PoseVisit::move_to(const JointVector& q) {
  const auto move =
      plan_joint_move(configuration_, mover_.now().commanded, q, mover_.sequence_pace());
  if (!move) return std::unexpected(move.error());
  const auto sent = mover_.send(*move, Mover::Of::kSequence);
  if (!sent) return std::unexpected(MoveRefusal{Error::kLateTick, {}});
  ticket_ = *sent;
  phase_ = Phase::kMoving;
  phase_ends_ = mover_.now().now + configuration_.dwell.settle +
                configuration_.dwell.settle_timeout + lasting(*move);
  return {};
}

void PoseVisit::measure() {
  const hal::Instant now = mover_.now().now;
  measurement_.begin(now);
  phase_ = Phase::kMeasuring;
  measured_since_ = now;
  phase_ends_ = now + configuration_.sensor.reading_timeout *
                          static_cast<std::int64_t>(configuration_.dwell.most_pings + 1);
}

VisitOutcome PoseVisit::step() {
  using enum VisitOutcome::What;
  if (!mover_.is_handled(ticket_)) return {};
  const Snapshot& snapshot = mover_.now();
  // First, as what was sent in the tick of the fault was refused because of it.
  if (snapshot.fault) return ends(snapshot.fault->error, snapshot.fault->joint);
  if (const auto refusal = mover_.refusal(ticket_)) return ends(*refusal);
  if (snapshot.mode != Mode::kSweeping) return ends(Error::kSequenceStopped);
  if (phase_ == Phase::kNext) return {kReady};
  if (phase_ == Phase::kMeasuring) return {};  // take() goes on
  if (!mover_.has_arrived(ticket_, configuration_.dwell.settle)) {
    return snapshot.now > phase_ends_ ? ends(Error::kNotSettled, mover_.furthest_joint())
                                      : VisitOutcome();
  }
  phase_ = Phase::kNext;
  return {kMayBound && is_half_way() ? kReady : kArrived};
}

VisitOutcome PoseVisit::take(const Result<std::optional<MeasuredPoint>>& measured) {
  using enum VisitOutcome::What;
  if (phase_ != Phase::kMeasuring) return {};
  if (has_moved()) return refuse_point();
  if (!measured || *measured) {
    phase_ = Phase::kNext;
    if (!measured) return {kLost, {measured.error(), {}}};
    moved_in_a_row_ = 0;
    return {kPoint};
  }
  if (mover_.now().now <= phase_ends_) return {};
  measurement_.end();
  phase_ = Phase::kNext;
  return {kLost, {Error::kPointTimeout, {}}};
}

// Whether a joint left its place, by more than the tolerance, since the first ping.
bool PoseVisit::has_moved() const {
  const Snapshot& snapshot = mover_.now();
  return snapshot.settled < snapshot.now - measured_since_;
}

// The pings of one point are of one place, or of none.
[[gnu::noinline]] VisitOutcome PoseVisit::refuse_point() {
  const std::size_t joint = mover_.furthest_joint();
  measurement_.end();
  if (++moved_in_a_row_ >= kMovedInARow) return ends(Error::kArmMoved, joint);
  announcer_.say(Line()
                     .text("# ")
                     .text(sequence_)
                     .text(" point refused")
                     .reason(Error::kArmMoved)
                     .text(" joint=")
                     .integer(joint + 1));
  phase_ = Phase::kMoving;
  phase_ends_ =
      mover_.now().now + configuration_.dwell.settle + configuration_.dwell.settle_timeout;
  return {};
}

}  // namespace armsig::controller
