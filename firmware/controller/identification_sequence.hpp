// SPDX-License-Identifier: MIT
// The identification, step by step: sweep joint after joint about the signature configuration,
// dwell and measure at every point, stop or extend each sweep by the accuracy it predicts,
// identify, then measure held-out poses and compare candidate and active model on them.
//
// Where an accuracy is asked for, and there is a Refinement, that chooses further poses before the
// held-out ones, and refines the candidate.
//
// Trouble of the sensor pauses it; resume() measures the same point again. Trouble of the arm ends
// it. Nothing is stored by it. A candidate may come from outside as well, and is then compared
// alone.
#pragma once

#include <optional>
#include <variant>

#include "core/identification.hpp"
#include "firmware/controller/announcer.hpp"
#include "firmware/controller/held_out.hpp"
#include "firmware/controller/measurement_log.hpp"
#include "firmware/controller/mover.hpp"
#include "firmware/controller/point_measurement.hpp"
#include "firmware/controller/pose_visit.hpp"
#include "firmware/controller/receiving.hpp"
#include "firmware/controller/refinement.hpp"
#include "firmware/controller/signature_record.hpp"
#include "firmware/controller/sweep.hpp"

namespace armsig::controller {

class IdentificationSequence : public VisitingSequence<IdentificationSequence> {
 public:
  enum class Stage : std::uint8_t {
    kNone,
    kSweeping,
    kIdentifying,
    kRefining,
    kComparing,  // the active model is laid over the candidate
    kHeldOut,
    kReturning
  };

  IdentificationSequence(const Configuration& configuration, Mover& mover,
                         PointMeasurement& measurement, const Announcer& announcer,
                         Refinement* refinement);

  // What holds where measuring begins. The candidate is of this, whatever holds where it is
  // accepted.
  struct Conditions {
    const SignatureRecord* active = nullptr;  // in use; null: the nominal model
    const Machine* machine = nullptr;         // null: not known
    std::int64_t now_s = 0;                   // of the calendar
  };

  // Forgets candidate and log. The active signature must stay as it is until the sequence is over;
  // `begun` is the kBeginSequence that it needs. Precondition: not is_running().
  void begin(const Conditions& conditions, Ticket begun);
  [[nodiscard]] bool can_refine() const { return kMayRefine && refinement_ != nullptr; }
  // Further poses are being measured.
  [[nodiscard]] bool is_refining() const { return kMayRefine && stage_ == Stage::kRefining; }
  // What is asked of a refinement.
  struct Refining {
    double accuracy_m = 0;
    hal::Duration time;  // from now on
    bool anew = false;   // what an interrupted one has measured is not wanted
  };
  // The same, and refines until the accuracy is reached or the time is over. Where an earlier one
  // on this machine was interrupted, it goes on from there. Precondition: can_refine().
  void begin_refining(const Refining& asked, const Conditions& conditions, Ticket begun);
  // The next part of a candidate from outside (receiving.hpp); true if it is whole then, and is the
  // candidate in place of any other. Errors: those of Receiving. Precondition: not is_running().
  [[nodiscard]] Result<bool> receive(const Request& request, Line& out);
  // Whether there is a candidate from outside that has not been compared.
  [[nodiscard]] bool has_received() const { return received_ && !has_verdict(); }
  // Compares it with the active signature as begin() does in the end; what was measured before
  // stays in the log. Preconditions: has_received(), not is_running().
  void begin_comparison(const Conditions& conditions, Ticket begun);
  // A person confirms it in place of a comparison. It is of the machine of `conditions` from now
  // on. Precondition: has_received().
#ifndef ARMSIG_SMALL_IMAGE
  void confirm(const Conditions& conditions, const Persons& persons);
  // Who has sent the candidate that was received. Precondition: has_received().
  void name_sender(const PersonName& sender) { candidate_->persons.sender = sender; }
#endif
  void pause() { paused_ = true; }
  void resume();
  // Ends it with `error` as the reason, wherever it is.
  void end(Error error, std::optional<std::size_t> joint = {});

  [[nodiscard]] bool is_running() const { return stage_ != Stage::kNone; }
  [[nodiscard]] bool is_paused() const { return is_running() && paused_; }
  // Neither moving nor measuring.
  [[nodiscard]] bool is_computing() const {
    return is_running() && !paused_ && !visit_.is_under_way();
  }
  [[nodiscard]] Stage stage() const { return stage_; }
  [[nodiscard]] std::optional<Error> pause_reason() const { return pause_reason_; }
  [[nodiscard]] std::size_t points_done() const { return points_done_; }
  [[nodiscard]] std::size_t points_planned() const;
  // Empty before the first point, and once there are more than planned.
  [[nodiscard]] std::optional<double> left_s() const;
  // For `status`. Precondition: is_refining().
  void tell_refinement(Line& line) const { refinement_->tell_state(line); }
  // The candidate with its figures, and against which signature it was validated. Precondition:
  // has_verdict().
  void tell_verdict(Line& line) const;
  // Index of the joint that is being swept; nothing in another stage.
  [[nodiscard]] std::optional<std::size_t> swept_joint() const {
    return stage_ == Stage::kSweeping ? std::optional(joint_) : std::nullopt;
  }
  // How well its axis is known so far; nothing before there are points enough.
  [[nodiscard]] std::optional<double> axis_sigma_rad() const {
    const Sweep* const sweep = std::get_if<Sweep>(&work_);
    return sweep != nullptr ? sweep->axis_sigma_rad() : std::nullopt;
  }

  // With the air and the error that it was identified with; its number is for the store to give.
  [[nodiscard]] const std::optional<SignatureRecord>& candidate() const { return candidate_; }
  [[nodiscard]] bool has_verdict() const { return report_.poses > 0; }
  [[nodiscard]] const HeldOutReport& report() const { return report_; }
  [[nodiscard]] const MeasurementLog& log() const { return log_; }
  void forget_candidate();
  // The machine is `found`, and `active` in use, null: the nominal model. A candidate that was
  // measured on another machine, or compared with another model, is dropped, and that is told.
  void compare_conditions(const Machine& found, const SignatureRecord* active);

 private:
  friend class VisitingSequence<IdentificationSequence>;

  void start(const Conditions& conditions, Ticket begun);
  void stamp(const Conditions& conditions);
  [[nodiscard]] bool refines() const { return kMayRefine && refines_; }
  void ready();
  void refuse(Error error, std::optional<std::size_t> joint);
  void keep(const MeasuredPoint* point);
  void forget_kept();
  [[nodiscard]] bool recall(const JointVector& wanted);
  [[nodiscard]] bool recall_next(const JointVector& q);
  void begin_sweep();
  // Of the stage.
  [[nodiscard]] Sweep& sweep() { return *std::get_if<Sweep>(&work_); }
  [[nodiscard]] Identification& identification() { return *std::get_if<Identification>(&work_); }
  [[nodiscard]] HeldOutComparison& comparison() { return *std::get_if<HeldOutComparison>(&work_); }
  void finish_sweep();
  void step_identification();
  void follow_refinement(Refinement::Next next);
  void arrived();
  void finish_held_out();
  void finish();
  void add_targets();
  void take(const MeasuredPoint& point);
  void take(const MeasuredPoint& point, const JointVector& readings);
  void lose(Error error);
  void skip();
  void pass_over();
  void pause_for(Error error);
  void tell_progress(std::string_view what) const;

  Refinement* refinement_;  // null: there is no memory for it
  Stage stage_ = Stage::kNone;
  bool paused_ = false;
  std::optional<Error> pause_reason_;
  const SignatureRecord* active_ = nullptr;
  std::size_t joint_ = 0;
  std::size_t held_out_ = 0;
  std::size_t points_done_ = 0;
  unsigned lost_in_a_row_ = 0;
  bool refines_ = false;
  double asked_m_ = 0;             // of the candidate; 0: no accuracy was asked for
  bool approached_ = false;        // the pose of the refinement, from its side
  std::uint16_t recalled_ = 0;     // of the points, those that an interrupted run had measured
  std::uint16_t passed_over_ = 0;  // of the held-out poses, as they are outside of the box
  std::size_t refines_from_ = 0;   // points that were measured before
  hal::Instant began_;
  // In it a candidate from outside comes in, too, part after part.
  std::variant<std::monostate, Sweep, Identification, HeldOutComparison, Receiving> work_;
  bool received_ = false;                     // the candidate came from outside
  std::uint32_t compared_with_ = 0;           // number of the active signature; 0: nominal model
  std::optional<SignatureRecord> candidate_;  // being made until there is a verdict
  HeldOutReport report_;
  MeasurementLog log_;
};

}  // namespace armsig::controller
