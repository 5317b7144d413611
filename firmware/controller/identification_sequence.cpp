// SPDX-License-Identifier: MIT
#include "firmware/controller/identification_sequence.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "firmware/controller/signature_figures.hpp"

namespace armsig::controller {
namespace {

std::uint32_t number_of(const SignatureRecord* record) {
  return record == nullptr ? 0 : record->sequence;
}

}  // namespace

IdentificationSequence::IdentificationSequence(const Configuration& configuration, Mover& mover,
                                               PointMeasurement& measurement,
                                               const Announcer& announcer, Refinement* refinement)
    : VisitingSequence(configuration, mover, measurement, announcer, "identify"),
      refinement_(refinement) {
  if (can_refine()) log_.extend(refinement_->further_log());
}

void IdentificationSequence::begin(const Conditions& conditions, Ticket begun) {
  start(conditions, begun);
  stage_ = Stage::kSweeping;
  log_.clear();
  forget_candidate();
  candidate_.emplace().signature.configuration = configuration_.sweeps.configuration;
  stamp(conditions);
  begin_sweep();
}

void IdentificationSequence::begin_refining(const Refining& asked, const Conditions& conditions,
                                            Ticket begun) {
  begin(conditions, begun);
  refines_ = true;
  asked_m_ = asked.accuracy_m;
  const auto kept =
      refinement_->begin({asked.accuracy_m, began_ + asked.time, asked.anew}, candidate_->machine);
  Line line;
  if (!kept) {
    announcer_.say(line.text("# identify begins anew").reason(kept.error()));
  } else if (*kept > 0) {
    announcer_.say(line.text("# identify continues kept_points=").integer(*kept));
  }
}

void IdentificationSequence::begin_comparison(const Conditions& conditions, Ticket begun) {
  start(conditions, begun);
  stamp(conditions);
#ifndef ARMSIG_SMALL_IMAGE
  candidate_->persons.confirmer.clear();  // from now on a measurement answers for it
#endif
  stage_ = Stage::kComparing;
  work_.emplace<HeldOutComparison>(*candidate_, active_, configuration_.drawing);
}

Result<bool> IdentificationSequence::receive(const Request& request, Line& out) {
  if (!std::holds_alternative<Receiving>(work_)) work_.emplace<Receiving>();
  auto& receiving = *std::get_if<Receiving>(&work_);
  ARMSIG_TRY(whole, receiving.take(request, out));
  if (!whole) return false;
  forget_candidate();
  const auto opened = receiving.open(configuration_.drawing, candidate_.emplace());
  work_.emplace<std::monostate>();
  if (!opened) {
    candidate_.reset();
    return std::unexpected(opened.error());
  }
  candidate_->sequence = 0;  // the store gives its own
  return received_ = true;
}

void IdentificationSequence::start(const Conditions& conditions, Ticket begun) {
  paused_ = false;
  pause_reason_.reset();
  active_ = conditions.active;
  joint_ = held_out_ = points_done_ = 0;
  lost_in_a_row_ = 0;
  refines_ = approached_ = false;
  refines_from_ = 0;
  recalled_ = passed_over_ = 0;
  visit_.begin(begun);
  began_ = mover_.now().now;
}

void IdentificationSequence::forget_candidate() {
  candidate_.reset();
  asked_m_ = 0;
  received_ = false;
  report_ = {};
}

void IdentificationSequence::stamp(const Conditions& conditions) {
  candidate_->identified_at_s = conditions.now_s;
  candidate_->machine = {};
  if (conditions.machine != nullptr) candidate_->machine = *conditions.machine;
  compared_with_ = number_of(conditions.active);
}

#ifndef ARMSIG_SMALL_IMAGE
void IdentificationSequence::confirm(const Conditions& conditions, const Persons& persons) {
  stamp(conditions);
  candidate_->persons = persons;
  Line line;
  line.text("# candidate confirmed sent_by=").text(view(persons.sender));
  announcer_.say(line.text(" confirmed_by=").text(view(persons.confirmer)));
}
#endif

[[gnu::noinline]] void IdentificationSequence::compare_conditions(const Machine& found,
                                                                  const SignatureRecord* active) {
  if (!has_verdict()) return;
  auto other = difference(candidate_->machine, found);
  if (!other && number_of(active) != compared_with_) {
    other = MachineDifference{.what = "model",
                              .joint = {},
                              .found = static_cast<double>(number_of(active)),
                              .expected = static_cast<double>(compared_with_)};
  }
  if (!other) return;
  forget_candidate();
  Line line;
  line.text("# candidate dropped");
  tell(*other, line);
  announcer_.say(line);
}

void IdentificationSequence::resume() {
  paused_ = false;
  pause_reason_.reset();
  lost_in_a_row_ = 0;
  approached_ = false;
}

void IdentificationSequence::end(Error error, std::optional<std::size_t> joint) {
  if (!is_running()) return;
  stage_ = Stage::kNone;
  paused_ = false;
  pause_reason_.reset();
  work_.emplace<std::monostate>();
  measurement_.end();
  if (!has_verdict() && !received_) forget_candidate();
  mover_.send(CommandKind::kEndSequence);
  Line line;
  line.text("# identify ended").reason(error);
  if (joint) line.text(" joint=").integer(*joint + 1);
  announcer_.say(line);
}

std::size_t IdentificationSequence::points_planned() const {
  const std::size_t swept =
      received_ ? 0 : configuration_.drawing.joints.size() * configuration_.sweeps.points;
  const std::size_t refining = refines() ? refinement_->planned() : 0;
  return std::max(swept, refines_from_) + refining + configuration_.sweeps.validation_poses;
}

std::optional<double> IdentificationSequence::left_s() const {
  const std::size_t measured = points_done_ - recalled_;
  if (measured == 0 || points_done_ >= points_planned()) return std::nullopt;
  const double elapsed_s = hal::seconds(mover_.now().now - began_);
  return elapsed_s / static_cast<double>(measured) *
         static_cast<double>(points_planned() - points_done_);
}

void IdentificationSequence::tell_progress(std::string_view what) const {
  Line line;
  line.text("# identify ").text(what).text(" joint=").integer(joint_ + 1);
  line.text(" points=").integer(points_done_).text(" planned=").integer(points_planned());
  if (const auto sigma_rad = axis_sigma_rad()) {
    line.text(" axis_sigma_deg=").number(degrees(*sigma_rad), 5);
  }
  if (const auto left = left_s()) line.text(" left_s=").number(*left, 0);
  announcer_.say(line);
}

void IdentificationSequence::arrived() {
  if (stage_ == Stage::kReturning) {
    finish();
  } else if (is_refining() && !approached_) {
    approached_ = true;
  } else {
    visit_.measure();
  }
}

void IdentificationSequence::begin_sweep() { work_.emplace<Sweep>(configuration_, joint_); }

void IdentificationSequence::ready() {
  if (paused_) return;
  JointVector q = configuration_.sweeps.configuration;
  if (stage_ == Stage::kSweeping) {
    if (sweep().step()) return;
    const auto reading = sweep().next();
    if (!reading) {
      finish_sweep();
      return;
    }
    q[joint_] = *reading;
  } else if (stage_ == Stage::kIdentifying) {
    step_identification();
    return;
  } else if (is_refining()) {
    const Refinement::Next next = refinement_->step(mover_.now().now);
    if (next != Refinement::Next::kVisits) {
      follow_refinement(next);
      return;
    }
    const Refinement::Visit& visit = refinement_->visit();
    q = approached_ ? visit.pose : visit.approach;
  } else if (stage_ == Stage::kComparing) {
    if (!comparison().step()) stage_ = Stage::kHeldOut;
    return;
  } else if (stage_ == Stage::kHeldOut) {
    if (held_out_ == configuration_.sweeps.validation_poses) {
      finish_held_out();
      return;
    }
    q = held_out_pose(configuration_, held_out_ + (kMayBound ? passed_over_ : 0));
  }
  if (kMayRefine && (!may_go_to(q) || recall_next(q))) return;
  go_to(q);
}

void IdentificationSequence::finish_sweep() {
  const auto* const feature = sweep().feature();
  if (feature == nullptr) {
    sweep().conclude();
    return;
  }
  if (!*feature) {
    refuse(feature->error().error, joint_);
    return;
  }
  tell_progress("swept");
  candidate_->signature.features.push_back(**feature);
  if (joint_ + 1 < configuration_.drawing.joints.size()) {
    ++joint_;
    begin_sweep();
    return;
  }
  work_.emplace<Identification>(candidate_->signature, configuration_.drawing);
  stage_ = Stage::kIdentifying;
}

void IdentificationSequence::step_identification() {
  if (candidate_->signature.targets.empty()) {
    const auto more = identification().step();
    if (!more) {
      refuse(more.error().refusal.error, more.error().joint);
    } else if (!*more) {
      add_targets();
    }
    return;
  }
  if (refines()) {
    refines_from_ = points_done_;
    refinement_->refine(candidate_->signature);
    stage_ = Stage::kRefining;
    return;
  }
  // In a step of its own: both together hold the core for too long.
  work_.emplace<HeldOutComparison>(*candidate_, active_, configuration_.drawing);
  stage_ = Stage::kComparing;
}

// A line here, and below, would stand on the stack below what a step calls.
[[gnu::noinline]] void IdentificationSequence::follow_refinement(Refinement::Next next) {
  if (next == Refinement::Next::kTells) {
    Line line;
    refinement_->tell(line);
    announcer_.say(line);
  } else if (next == Refinement::Next::kDone) {
    if (const auto written = refinement_->write(*candidate_); !written) {
      refuse(written.error(), {});
      return;
    }
    refines_from_ = points_done_;
    refines_ = false;
    stage_ = Stage::kIdentifying;
  }
}

// Every sweep has seen the one target pass the signature configuration: weighted mean.
void IdentificationSequence::add_targets() {
  Signature& signature = candidate_->signature;
  Matrix3 information = Matrix3::Zero();
  Vector3 weighted = Vector3::Zero();
  for (std::size_t i = 0; i < signature.features.size(); ++i) {
    const features::JointFeature& feature = signature.features[i];
    const double reading = signature.configuration[i];
    const Matrix3 covariance = feature.target_covariance_at(reading);
    const Matrix3 weight =
        (covariance + 1e-14 * Matrix3::Identity()).inverse();  // never singular: 0.1 micrometre
    information += weight;
    weighted += weight * feature.target_at(reading);
  }
  const Matrix3 covariance = information.inverse();
  signature.targets.push_back({.number = configuration_.sweeps.target,
                               .link = signature.joint_count(),
                               .p_S = covariance * weighted,
                               .covariance_m2 = covariance});
  candidate_->accuracy.predicted = {std::sqrt(covariance.trace()),
                                    PredictedRegion::kSignatureConfiguration};
}

void IdentificationSequence::finish_held_out() {
  if (kMayRefine && refines_from_ > 0) forget_kept();
  report_ = comparison().report();
  candidate_->air_celsius = measurement_.air_celsius().value_or(0);
  report_.active = active_ != nullptr ? active_->sequence : 0;
  candidate_->accuracy.validated = {report_.candidate_rms_m,
                                    static_cast<std::uint32_t>(report_.poses)};
  Line line;
  tell_verdict(line.text("# candidate"));
  announcer_.say(line);
  stage_ = Stage::kReturning;
}

void IdentificationSequence::tell_verdict(Line& line) const {
  SignatureFigures(*candidate_).tell(line);
  line.text(" active=");
  if (report_.active == 0) {
    line.text("nominal");
  } else {
    line.integer(report_.active);
  }
  line.text(" active_rms_mm=").number(1e3 * report_.active_rms_m, 4);
  line.text(" better=").text(report_.is_better() ? "yes" : "no");
  if (!kMayRefine || asked_m_ == 0) return;
  const auto& predicted = candidate_->accuracy.predicted;
  line.text(" asked_mm=").number(1e3 * asked_m_, 4);
  line.text(" reached=").text(predicted && predicted->rms_m <= asked_m_ ? "yes" : "no");
}

// A function of its own, as the stack has no room for a line below everything that step() calls.
[[gnu::noinline]] void IdentificationSequence::finish() {
  stage_ = Stage::kNone;
  mover_.send(CommandKind::kEndSequence);
  announcer_.say(Line().text("# identify done"));
}

}  // namespace armsig::controller
