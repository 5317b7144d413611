// SPDX-License-Identifier: MIT
// One pose of a sequence: the way there, the standstill, and the point that is measured there. What
// every sequence that measures has in common.
#pragma once

#include <type_traits>
#include <variant>

#include "firmware/controller/announcer.hpp"
#include "firmware/controller/mover.hpp"
#include "firmware/controller/point_measurement.hpp"
#include "firmware/controller/workspace.hpp"

namespace armsig::controller {

// Whether it is the place, rather than the sensor, that a point was lost by.
[[nodiscard]] bool is_of_the_place(Error error);

// Pose `index` of those that are spread about the signature configuration over the configured part
// of each joint's limits; the same at every call.
[[nodiscard]] JointVector spread_pose(const Configuration& configuration, std::size_t index);

// The same of those that a candidate is judged by. Where what is around the arm excludes many they
// go on where no self-calibration is offered one.
[[nodiscard]] JointVector held_out_pose(const Configuration& configuration, std::size_t index);

// What became of a pose in a step.
struct VisitOutcome {
  enum class What : std::uint8_t {
    kUnderWay,
    kReady,    // nothing is under way
    kArrived,  // and stands still; once more after a point that was refused as the arm moved
    kPoint,    // the measured one is good
    kLost,     // the pose gives no point, by `why`
    kEnds,     // the sequence, by `why`
  };
  What what = What::kUnderWay;
  MoveRefusal why = {};
};

class PoseVisit {
 public:
  // `sequence` is its name in what is told.
  PoseVisit(const Configuration& configuration, Mover& mover, PointMeasurement& measurement,
            const Announcer& announcer, std::string_view sequence)
      : configuration_(configuration),
        mover_(mover),
        measurement_(measurement),
        announcer_(announcer),
        sequence_(sequence) {}

  // The sequence begins; `begun` is the kBeginSequence that it needs.
  void begin(Ticket begun);
  // Whether `q` may be gone to: the way there from the signature configuration is clear. A bounded
  // step; while there is more to look at, to be asked again about it.
  [[nodiscard]] WayLook::Says look_at(const JointVector& q) {
    if constexpr (kMayBound) return look_at_way(q);
    return WayLook::Says::kClear;
  }
  // What look_at() has found is of no use: the pose is not gone to.
  void forget_look() { looks_ = {}; }
  // Straight in the joint readings, or where that is not clear by way of the signature
  // configuration. A bounded step: until is_under_way() is true, to be called again. Errors: those
  // of plan_joint_move(); kLateTick (the tick has stopped); kOutsideWorkspace (there is no way from
  // where the arm is). Precondition: look_at(q) is clear.
  [[nodiscard]] std::expected<void, MoveRefusal> go_to(const JointVector& q) {
    if constexpr (kMayBound) return go_inside(q);
    return move_to(q);
  }
  // A point where the arm stands.
  void measure();
  // What the arm does. Ends by its fault, by the refusal of a command, kSequenceStopped (halt),
  // kNotSettled.
  [[nodiscard]] VisitOutcome step();
  // What the sensor said in this step. Lost by an error of PointMeasurement::step() or
  // kPointTimeout; ends by kArmMoved. Before step(), in every step of the background.
  [[nodiscard]] VisitOutcome take(const Result<std::optional<MeasuredPoint>>& measured);
  [[nodiscard]] bool is_under_way() const { return phase_ != Phase::kNext; }

 private:
  enum class Phase : std::uint8_t { kNext, kMoving, kMeasuring };
  enum class Looking : std::uint8_t { kAtPose, kAtWay, kAtWayHome };

  // What is known of the way to the next pose.
  struct Looks {
    WayLook look;
    Looking at = Looking::kAtPose;
    bool goes_home = false;  // on the way to the pose
  };
  [[nodiscard]] WayLook::Says look_at_way(const JointVector& q);
  [[nodiscard]] std::expected<void, MoveRefusal> go_inside(const JointVector& q);
  [[nodiscard]] std::expected<void, MoveRefusal> move_to(const JointVector& q);
  void tell_no_way(const clearance::Room& room) const;
  // Whether the arm is at the signature configuration on the way to a pose.
  [[nodiscard]] bool is_half_way();
  [[nodiscard]] bool has_moved() const;
  [[nodiscard]] VisitOutcome refuse_point();

  const Configuration& configuration_;
  Mover& mover_;
  PointMeasurement& measurement_;
  const Announcer& announcer_;
  std::string_view sequence_;

  Phase phase_ = Phase::kNext;
  unsigned moved_in_a_row_ = 0;
  Ticket ticket_ = 0;        // of the last command
  hal::Instant phase_ends_;  // the bound of the phase under way
  hal::Instant measured_since_;
  [[no_unique_address]] std::conditional_t<kMayBound, Looks, std::monostate> looks_;
};

// A sequence of visits, `Sequence`, which is told what becomes of each: ready() for the next one,
// arrived(), take(point), lose(error), end(error, joint), pass_over() for a pose that what is
// around the arm excludes. It is its friend.
template <typename Sequence>
class VisitingSequence {
 public:
  void step() {
    if (!self().is_running()) return;
    const VisitOutcome outcome = visit_.step();
    if (outcome.what == VisitOutcome::What::kReady) {
      self().ready();
    } else if (outcome.what == VisitOutcome::What::kArrived) {
      self().arrived();
    } else if (outcome.what == VisitOutcome::What::kEnds) {
      self().end(outcome.why.error, outcome.why.joint);
    }
  }
  // What the sensor said in this step.
  void measure_step(const Result<std::optional<MeasuredPoint>>& measured) {
    if (!self().is_running()) return;
    const VisitOutcome outcome = visit_.take(measured);
    if (outcome.what == VisitOutcome::What::kPoint) {
      self().take(**measured);
    } else if (outcome.what == VisitOutcome::What::kLost) {
      self().lose(outcome.why.error);
    } else if (outcome.what == VisitOutcome::What::kEnds) {
      self().end(outcome.why.error, outcome.why.joint);
    }
  }

 private:
  friend Sequence;
  VisitingSequence(const Configuration& configuration, Mover& mover, PointMeasurement& measurement,
                   const Announcer& announcer, std::string_view name)
      : configuration_(configuration),
        mover_(mover),
        measurement_(measurement),
        announcer_(announcer),
        visit_(configuration, mover, measurement, announcer, name) {}

 protected:
  // Whether `q` may be gone to. If not it is passed over; or ready() looks on.
  [[nodiscard]] bool may_go_to(const JointVector& q) {
    const WayLook::Says says = visit_.look_at(q);
    if (says == WayLook::Says::kLeaves) self().pass_over();
    return says == WayLook::Says::kClear;
  }
  // On the way to `q`, or at its end. Precondition: may_go_to(q).
  void go_to(const JointVector& q) {
    if (const auto gone = visit_.go_to(q); !gone) {
      self().end(gone.error().error, gone.error().joint);
    }
  }

  const Configuration& configuration_;
  Mover& mover_;
  PointMeasurement& measurement_;
  const Announcer& announcer_;
  PoseVisit visit_;

 private:
  [[nodiscard]] Sequence& self() { return *static_cast<Sequence*>(this); }
};

}  // namespace armsig::controller
