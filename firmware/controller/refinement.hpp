// SPDX-License-Identifier: MIT
// What a program may give its controller, where there is memory for it: finds more of an arm than
// its sweeps tell, from further poses of its own choice, until a tool accuracy is reached that was
// asked for. The identification moves and measures for it.
#pragma once

#include <optional>
#include <span>

#include "firmware/controller/machine.hpp"
#include "firmware/controller/measurement_log.hpp"
#include "firmware/controller/point_measurement.hpp"
#include "firmware/controller/signature_record.hpp"
#include "firmware/controller/text.hpp"
#include "hal/clock.hpp"

namespace armsig::controller {

// What was measured at a pose, for a later run that goes the same way.
struct KeptPoint {
  std::size_t sweep = 0;                    // joint from 1, 0: a pose
  JointVector wanted;                       // the readings it was sent to, effective ones
  JointVector readings;                     // and those at which it stood
  std::optional<MeasuredPoint> point = {};  // none: the pose gives none
};

class Refinement {
 public:
  struct Aim {
    double accuracy_m = 0;  // of the tool, 1 sigma of the length of its error
    hal::Instant ends;      // by then the last pose is measured
    bool anew = false;      // what was kept of an earlier run is not wanted
  };
  // What is to be done next.
  enum class Next : std::uint8_t {
    kComputes,  // step() again
    kVisits,    // measure visit(): then take() or lose()
    kTells,     // say what tell() makes, then step() again
    kDone
  };
  // The pose is to be reached from `approach`, so that every joint's play is on a known side.
  struct Visit {
    JointVector approach;
    JointVector pose;
    // It was measured before, and is to be compared: nothing is recalled, nor kept.
    bool again = false;
  };

  // Room for what is measured beyond the log's own.
  [[nodiscard]] std::span<LogEntry> further_log() { return do_further_log(); }
  // Forgets everything, but for what was kept of a run on `machine` that was interrupted: so many
  // points. Errors, by which there are none of them: kRecordCorrupt, kRecordOtherMachine,
  // kRecordUnsuitable (of another configuration), those of NonvolatileMemory.
  [[nodiscard]] Result<std::size_t> begin(const Aim& aim, const Machine& machine) {
    return do_begin(aim, machine);
  }
  // What the interrupted run has from the pose that is to be measured next, `wanted` of `sweep`.
  [[nodiscard]] std::optional<KeptPoint> recall(std::size_t sweep, const JointVector& wanted) {
    return do_recall(sweep, wanted);
  }
  // Keeps it for a later run, where there is a place for it. Errors: those of NonvolatileMemory;
  // nothing more is kept then.
  [[nodiscard]] Result<void> keep(const KeptPoint& kept) { return do_keep(kept); }
  // The run has come to an end that is no interruption. Errors: those of NonvolatileMemory; the
  // next run may find what this one kept.
  [[nodiscard]] Result<void> forget() { return do_forget(); }
  // A point of the sweep of joint `sweep` from 1; 0: of visit().
  void take(std::size_t sweep, const JointVector& readings, const MeasuredPoint& point) {
    do_take(sweep, readings, point);
  }
  // visit() gives no point.
  void lose() { do_lose(); }
  // The sweeps are over and have given `signature`, with its target.
  void refine(const Signature& signature) { do_refine(signature); }
  // A bounded step.
  [[nodiscard]] Next step(hal::Instant now) { return do_step(now); }
  [[nodiscard]] const Visit& visit() const { return do_visit(); }
  void tell(Line& line) const { do_tell(line); }
  // For `status`: how far it is, ` candidate_predicted_tool_error_mm=...`; nothing where nothing is
  // known yet.
  void tell_state(Line& line) const { do_tell_state(line); }
  // Poses to be measured in all, as far as is known.
  [[nodiscard]] std::size_t planned() const { return do_planned(); }
  // After kDone: puts what was found into `record`, whose signature is the one of refine(). Where
  // nothing was found that is better than that, it stays. Errors: kNotConverged (arm, target or
  // sensor changed while they were measured: no model is right).
  [[nodiscard]] Result<void> write(SignatureRecord& record) const { return do_write(record); }

 protected:
  ~Refinement() = default;

 private:
  virtual std::span<LogEntry> do_further_log() = 0;
  virtual Result<std::size_t> do_begin(const Aim& aim, const Machine& machine) = 0;
  virtual std::optional<KeptPoint> do_recall(std::size_t sweep, const JointVector& wanted) = 0;
  virtual Result<void> do_keep(const KeptPoint& kept) = 0;
  virtual Result<void> do_forget() = 0;
  virtual void do_take(std::size_t sweep, const JointVector& readings,
                       const MeasuredPoint& point) = 0;
  virtual void do_lose() = 0;
  virtual void do_refine(const Signature& signature) = 0;
  virtual Next do_step(hal::Instant now) = 0;
  [[nodiscard]] virtual const Visit& do_visit() const = 0;
  virtual void do_tell(Line& line) const = 0;
  virtual void do_tell_state(Line& line) const = 0;
  [[nodiscard]] virtual std::size_t do_planned() const = 0;
  virtual Result<void> do_write(SignatureRecord& record) const = 0;
};

}  // namespace armsig::controller
