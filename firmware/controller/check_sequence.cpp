// SPDX-License-Identifier: MIT
#include "firmware/controller/check_sequence.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::controller {

CheckSequence::CheckSequence(const Configuration& configuration, Mover& mover,
                             PointMeasurement& measurement, const Announcer& announcer,
                             const Link& link, const Custody& custody, CheckMemory* memory)
    : VisitingSequence(configuration, mover, measurement, announcer, "check"),
      link_(link),
      custody_(custody),
      memory_(memory),
      due_(configuration.check.every) {}

Result<Ticket> CheckSequence::begin() {
  const auto& active = custody_.active();
  if (!active || !link_.models[mover_.now().model].identified) {
    return std::unexpected(Error::kNoSignature);
  }
  if (const auto trouble = measurement_.trouble()) return std::unexpected(*trouble);
  const auto ticket = mover_.begin_sequence();
  if (!ticket) return std::unexpected(Error::kBusBusy);
  visit_.begin(*ticket);
  if (history_.begin(active->sequence, active->identified_at_s) && memory_ != nullptr) {
    memory_->recall({configuration_, announcer_, custody_.active_crc()}, history_.state());
  }
  stage_ = Stage::kApproaching;
  pose_ = 0;
  home_ = mover_.now().commanded;
  checked_.poses.clear();
  checked_.places.clear();
  variance_m2_ = 0;
  trouble_.reset();
  due_ = mover_.now().now + configuration_.check.every;
  notice_.reset();
  return *ticket;
}

void CheckSequence::end(Error error, std::optional<std::size_t> joint) {
  if (!is_running()) return;
  stage_ = Stage::kNone;
  measurement_.end();
  mover_.send(CommandKind::kEndSequence);
  tell_failure(error, joint);
}

// By way of the signature configuration, so that every pose is always reached from the same one and
// play leaves it on the same side.
void CheckSequence::ready() {
  if (stage_ == Stage::kPosing && (trouble_ || pose_ == configuration_.check.poses)) {
    stage_ = Stage::kReturning;
  }
  JointVector q = configuration_.sweeps.configuration;
  if (stage_ == Stage::kPosing) q = spread_pose(configuration_, pose_);
  if (stage_ == Stage::kReturning) q = home_;
  if (!kMayBound || may_go_to(q)) go_to(q);
}

void CheckSequence::arrived() {
  if (stage_ == Stage::kApproaching) {
    stage_ = Stage::kPosing;
  } else if (stage_ == Stage::kPosing) {
    visit_.measure();
  } else {
    finish();
  }
}

// A function of its own, because of the pose's place on the stack.
[[gnu::noinline]] Result<Vector3> CheckSequence::predicted() const {
  ARMSIG_TRY(X_ST, tool_pose(link_.models[mover_.now().model], mover_.now().positions));
  return X_ST.p;
}

void CheckSequence::take(const MeasuredPoint& point) {
  const auto p_S = predicted();
  if (!p_S) {
    end(p_S.error());
    return;
  }
  checked_.poses.push_back({.p_R = *p_S, .residual_m = point.p_S - *p_S});
  checked_.places.push_back(static_cast<std::uint8_t>(pose_++));
  variance_m2_ += point.covariance_m2.trace() / 3;
}

void CheckSequence::lose(Error error) {
  if (is_of_the_place(error)) {
    ++pose_;
  } else {
    trouble_ = error;
  }
}

void CheckSequence::pass_over() {
  if (stage_ == Stage::kPosing) {
    ++pose_;
  } else {
    end(Error::kOutsideWorkspace);
  }
}

void CheckSequence::finish() {
  stage_ = Stage::kNone;
  mover_.send(CommandKind::kEndSequence);
  if (trouble_) {
    tell_failure(*trouble_, {});
    return;
  }
  if (!checked_.poses.empty()) {
    checked_.sigma_m = std::sqrt(variance_m2_ / static_cast<double>(checked_.poses.size()));
  }
  tell_residuals();
  const std::size_t poses = checked_.poses.size();
  const auto report =
      history_.take(checked_, custody_.active() ? validation_rms_m(*custody_.active()) : 0);
  if (!report) {
    tell_failure(report.error(), {});
    return;
  }
  if (memory_ != nullptr) {
    memory_->keep({configuration_, announcer_, custody_.active_crc()}, history_.state());
  }
  last_ = *report;
  just_accepted_ = report->verdict == CheckVerdict::kAsAccepted;
  tell(*report, poses);
  tell_people(*report);
}

void CheckSequence::look_at_schedule(bool others) {
  const hal::Duration every = configuration_.check.every;
  if (every <= hal::Duration{} || is_running()) return;
  const Snapshot& snapshot = mover_.now();
  const bool idle = !others && snapshot.mode == Mode::kHolding && snapshot.settled >= kQuiet &&
                    custody_.active().has_value();
  if (!idle || snapshot.now < due_) {
    notice_.reset();
  } else if (!notice_) {
    notice_ = snapshot.now;
    tell_notice();
  } else if (snapshot.now - *notice_ >= kNotice) {
    notice_.reset();
    if (const auto begun = begin(); !begun) {
      due_ = snapshot.now + every;
      tell_failure(begun.error(), {});
    }
  }
}

void CheckSequence::postpone() {
  notice_.reset();
  due_ = std::max(due_, mover_.now().now + std::min(kPostponed, configuration_.check.every));
}

// Functions of their own, here and below: a line would stand on the stack below what a step calls.
[[gnu::noinline]] void CheckSequence::tell_notice() const {
  announcer_.say(Line()
                     .text("# check due begins_in_s=")
                     .number(hal::seconds(kNotice), 0)
                     .text(" the arm is going to move; halt puts it off by an hour"));
}

[[gnu::noinline]] void CheckSequence::tell_failure(Error error,
                                                   std::optional<std::size_t> joint) const {
  Line line;
  line.text("# check verdict=\"").text(describe(CheckVerdict::kNotMeasured)).text("\"");
  line.reason(error);
  if (joint) line.text(" joint=").integer(*joint + 1);
  announcer_.say(line);
}

[[gnu::noinline]] void CheckSequence::tell_residuals() const {
  Line line;
  line.text("# check residuals");
  for (std::size_t i = 0; i < checked_.poses.size(); ++i) {
    const Vector3& residual_m = checked_.poses[i].residual_m;
    line.text(" r").integer(checked_.places[i] + 1U).text("_mm=");
    line.number(1e3 * residual_m.x(), 3).text(",");
    line.number(1e3 * residual_m.y(), 3).text(",");
    line.number(1e3 * residual_m.z(), 3);
  }
  announcer_.say(line);
}

[[gnu::noinline]] void CheckSequence::tell(const CheckReport& report, std::size_t poses) const {
  Line line;
  line.text("# check verdict=\"").text(describe(report.verdict)).text("\"");
  if (custody_.active()) line.text(" signature=").integer(custody_.active()->sequence);
  line.text(" dx_mm=").number(1e3 * report.mean_m.x(), 4);
  line.text(" dy_mm=").number(1e3 * report.mean_m.y(), 4);
  line.text(" dz_mm=").number(1e3 * report.mean_m.z(), 4);
  line.text(" sigma_mm=").number(1e3 * report.sigma_m, 4);
  line.text(" poses=").integer(poses);
  line.text(" rms_mm=").number(1e3 * report.rms_m, 4);
  line.text(" sum=").number(report.sum, 2).text(" named_above=").number(kCheckThreshold, 2);
  line.text(" learnt=").integer(static_cast<std::uint64_t>(report.learnt));
  announcer_.say(line.text(" of=").integer(static_cast<std::uint64_t>(kCheckBaseline)));
}

[[gnu::noinline]] void CheckSequence::tell_people(const CheckReport& report) const {
  Line line;
  switch (report.verdict) {
    case CheckVerdict::kAsAccepted:
      line.text("# the arm is as it was accepted");
      break;
    case CheckVerdict::kDrifting:
      line.text("# the arm drifts: look for wear or backlash, then identify anew");
      break;
    case CheckVerdict::kStepped:
      line.text("# the arm changed at once: look for a collision or a loose part, identify anew");
      break;
    case CheckVerdict::kReferenceMoved:
      line.text("# the sensor moved, or the foot of the arm as a whole: look at both");
      break;
    case CheckVerdict::kNotMeasured:
      break;
  }
  announcer_.say(line.text("; the tool is ")
                     .number(1e3 * report.rms_m, 3)
                     .text(" mm (RMS) from where the signature puts it"));
}

}  // namespace armsig::controller
