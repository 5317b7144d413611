// SPDX-License-Identifier: MIT
// Whether the arm is still the one that was accepted: a few poses, the same every time, measured
// and held against the signature in use; on request, or by schedule when the arm has nothing to do.
//
// Moves nothing without torque, and by schedule only after it was told for kNotice. Ends with the
// residuals of the poses, a line for machines and one for people:
//
//   # check residuals r1_mm=0.010,-0.020,0.005 r2_mm=...
//   # check verdict="as accepted" signature=3 dx_mm=0.010 dy_mm=-0.020 dz_mm=0.005 sigma_mm=0.022
//   poses=16 ... # the arm is as it was accepted: ...
//
// or with `# check verdict="could not measure" error=SENSOR_SILENT reason="..."`.
//
// What the checks have shown outlives a restart where the program gives a CheckMemory; elsewhere
// the reference is learnt anew. The first check after a restart tells which:
//
//   # check history recalled learnt=12 of=20
//   # check history unused error=RECORD_CORRUPT reason="..."; the reference is learnt anew
#pragma once

#include <optional>
#include <utility>

#include "firmware/controller/check_memory.hpp"
#include "firmware/controller/custody.hpp"
#include "firmware/controller/pose_visit.hpp"

namespace armsig::controller {

class CheckSequence : public VisitingSequence<CheckSequence> {
 public:
  // The arm has stood still for so long before a check by schedule is told, and then again.
  static constexpr hal::Duration kQuiet = std::chrono::seconds(60);
  static constexpr hal::Duration kNotice = std::chrono::seconds(10);
  static constexpr hal::Duration kPostponed = std::chrono::hours(1);

  CheckSequence(const Configuration& configuration, Mover& mover, PointMeasurement& measurement,
                const Announcer& announcer, const Link& link, const Custody& custody,
                CheckMemory* memory = nullptr);

  // The kBeginSequence that it needs. Errors: kNoSignature (the drawing is in use: nothing was
  // accepted), the trouble of the sensor, kBusBusy (the tick has stopped). Precondition: not
  // is_running(), and nothing else is.
  Result<Ticket> begin();
  // Ends it with `error` as the reason, wherever it is.
  void end(Error error, std::optional<std::size_t> joint = {});
  // Looks at the schedule; `others`: something else is under way or asked for.
  void look_at_schedule(bool others);
  // A check that is due, or told, is put off by kPostponed, by its period where that is shorter.
  void postpone();

  [[nodiscard]] bool is_running() const { return stage_ != Stage::kNone; }
  [[nodiscard]] std::size_t poses_done() const { return pose_; }
  [[nodiscard]] const std::optional<CheckReport>& last() const { return last_; }
  // Once after each check that has found the arm as it was accepted.
  [[nodiscard]] bool take_accepted() { return std::exchange(just_accepted_, false); }

 private:
  friend class VisitingSequence<CheckSequence>;

  enum class Stage : std::uint8_t { kNone, kApproaching, kPosing, kReturning };

  void ready();
  void arrived();
  void take(const MeasuredPoint& point);
  void lose(Error error);
  void pass_over();
  void finish();
  [[nodiscard]] Result<Vector3> predicted() const;
  void tell_notice() const;
  void tell_failure(Error error, std::optional<std::size_t> joint) const;
  void tell_residuals() const;
  void tell(const CheckReport& report, std::size_t poses) const;
  void tell_people(const CheckReport& report) const;

  const Link& link_;
  const Custody& custody_;
  CheckMemory* memory_;

  Stage stage_ = Stage::kNone;
  std::size_t pose_ = 0;
  JointVector home_;  // where it began, and ends
  MeasuredCheck checked_;
  double variance_m2_ = 0;        // summed over the poses measured, of a component
  std::optional<Error> trouble_;  // of the sensor, by which it ends
  CheckHistory history_;
  std::optional<CheckReport> last_;
  bool just_accepted_ = false;
  hal::Instant due_;                    // by schedule
  std::optional<hal::Instant> notice_;  // since when it is told
};

}  // namespace armsig::controller
