// SPDX-License-Identifier: MIT
// `status`, `signature`, `candidate`, `log`: what the controller says about itself. A key whose
// value is not known is left out.
#include <algorithm>

#include "core/base/error_name.hpp"
#include "firmware/controller/fault_words.hpp"
#include "firmware/controller/verbs.hpp"

namespace armsig::controller {
namespace {

void tell(Line& line, std::string_view what, const Histogram& histogram) {
  if (histogram.total == 0) return;
  line.text(" ").text(what).text("_mean_us=").number(histogram.mean_us(), 1);
  line.text(" ").text(what).text("_max_us=").number(1e6 * hal::seconds(histogram.largest), 1);
  line.text(" ").text(what).text("_bins=");
  for (std::size_t i = 0; i < Histogram::kBins; ++i) {
    line.text(i == 0 ? "" : ",").integer(histogram.counts[i]);
  }
}

// Readings of the joints whose bit is set in `known`, with `decimals`: ` q1_deg=10.0000 q2_mm=...`.
void tell_readings(Line& line, const Arm& drawing, const JointVector& q, unsigned decimals,
                   unsigned known = ~0U) {
  for (std::size_t i = 0; i < q.size(); ++i) {
    if ((known >> i & 1U) == 0) continue;
    const bool turns = drawing.joints[i].type == JointType::kRevolute;
    line.text(" q").integer(i + 1).text(turns ? "_deg=" : "_mm=");
    line.number(turns ? degrees(q[i]) : 1e3 * q[i], decimals);
  }
}

void tell_point(Line& line, const Vector3& p, unsigned decimals) {
  line.text(" x_mm=").number(1e3 * p.x(), decimals);
  line.text(" y_mm=").number(1e3 * p.y(), decimals);
  line.text(" z_mm=").number(1e3 * p.z(), decimals);
}

// The joints whose drives have faults, where there are several.
void tell_faulted(Line& line, const Controls& controls) {
  if constexpr (!hal::kSmallImage) {
    const DriveFaults& faults = controls.link.faults.read();
    std::uint32_t joints = 0;
    for (const Fault& fault : faults) joints |= 1U << *fault.joint;
    if (faults.size() > 1) line.text(" faulted=").numbers(joints);
  }
}

// Where drives tell their torque: of each joint, "-" of one that does not.
void tell_torque([[maybe_unused]] Line& line, [[maybe_unused]] const Snapshot& s) {
#ifndef ARMSIG_SMALL_IMAGE
  const std::size_t joints = s.positions.size();
  const auto tell = [&](std::string_view key, const auto& shares) {
    line.text(key);
    for (std::size_t joint = 0; joint < joints; ++joint) {
      if (joint > 0) line.text(",");
      if (!s.torque[joint]) line.text("-");
      if (s.torque[joint]) line.number(100 * shares(joint), 0);
    }
  };
  if (std::ranges::none_of(s.torque, [](const hal::Torque& torque) { return bool(torque); }))
    return;
  tell(" torque_percent=", [&](std::size_t joint) { return *s.torque[joint]; });
  tell(" largest_torque_percent=", [&](std::size_t joint) { return s.largest_torque[joint]; });
#endif
}

void tell_arm(Line& line, const Controls& controls) {
  const Snapshot& s = controls.mover.now();
  line.text(" mode=").text(name(s.mode));
  if (s.fault) {
    line.text(" fault=").text(name(s.fault->error));
    if (s.fault->joint) line.text(" fault_joint=").integer(*s.fault->joint + 1);
    line.device_object(s.fault->object, "fault_");
    tell_words(line, *s.fault, "fault_");
    line.device_details(s.fault->details, "fault_");
  }
  tell_faulted(line, controls);
  line.text(" moving=").text(s.moving ? "yes" : "no");
  if (s.limits_active != 0) line.text(" limits_active=").numbers(s.limits_active);
  if (s.warning != 0) line.text(" warning=").numbers(s.warning);
  if (s.unsupervised != 0) line.text(" unsupervised=").numbers(s.unsupervised);
  if (const auto joints = controls.references.unreferenced(); joints != 0) {
    line.text(" unreferenced=").numbers(joints);
  }
  tell_readings(line, controls.configuration.drawing, s.positions, 4, s.known);
  tell_torque(line, s);
  if (s.X_RT) tell_point(line, s.X_RT->p, 3);
  const Model& model = controls.link.models[s.model];
  line.text(" model=").text(model.identified ? "signature" : "nominal");
  if (!model.identified) return;
  model.figures.tell(line);
  line.text(" maps=").text(model.joints.exact() ? "no" : "yes");
}

void tell_sensor(Line& line, const PointMeasurement& measurement) {
  if (measurement.trouble()) {
    line.text(" sensor=").text(name(*measurement.trouble()));
  } else if (measurement.has_heard()) {
    line.text(" sensor=well");
  }
  if constexpr (kMayTakePoints) {
    if (!measurement.has_instrument()) line.text(" sensor=none");
    if (const auto malformed = measurement.malformed(); malformed > 0) {
      line.text(" sensor_malformed=").integer(malformed);
    }
    if (const auto failing = measurement.failing_unit()) {
      line.text(" sensor_unit=").integer(failing->unit);
      line.text(" sensor_unit_error=").text(name(failing->error));
    }
  }
  if (const std::string_view words = measurement.trouble_words(); !words.empty()) {
    line.text(" sensor_says=\"").text(words).text("\"");
  }
}

void tell_sequence(Line& line, const Controls& controls) {
  const IdentificationSequence& identification = controls.identification;
  if (identification.is_running()) {
    line.text(" sequence=").text(identification.is_paused() ? "paused" : "identifying");
    if (identification.is_refining()) {
      line.text(" refining=yes");
      identification.tell_refinement(line);
    }
    line.text(" points=").integer(identification.points_done());
    line.text(" planned=").integer(identification.points_planned());
    if (const auto left_s = identification.left_s()) line.text(" left_s=").number(*left_s, 0);
    if (const auto joint = identification.swept_joint()) {
      line.text(" sweep=").integer(*joint + 1);
      const auto sigma_rad = identification.axis_sigma_rad();
      if (sigma_rad) line.text(" axis_sigma_deg=").number(degrees(*sigma_rad), 5);
    }
  } else if (controls.grid.is_running()) {
    line.text(" sequence=touching touched=").integer(controls.grid.touched());
  } else if (controls.check.is_running()) {
    line.text(" sequence=checking points=").integer(controls.check.poses_done());
    line.text(" planned=").integer(controls.configuration.check.poses);
  } else {
    line.text(" sequence=none");
  }
  if (const auto& last = controls.check.last()) {
    line.text(" check=\"").text(describe(last->verdict)).text("\"");
  }
}

void tell_persons([[maybe_unused]] Line& line, [[maybe_unused]] const SignatureRecord& record) {
#ifndef ARMSIG_SMALL_IMAGE
  const Persons& persons = record.persons;
  if (!persons.sender.empty()) line.text(" sent_by=").text(view(persons.sender));
  if (!persons.confirmer.empty()) line.text(" confirmed_by=").text(view(persons.confirmer));
  if (persons.unreadable) line.text(" persons=unreadable");
#endif
}

}  // namespace

Result<Answer> tell_status(Controls& controls, const Request& /*request*/, Line& out) {
  tell_arm(out, controls);
  tell_sensor(out, controls.measurement);
  if (controls.custody.trouble()) out.text(" store=").text(name(*controls.custody.trouble()));
  if (controls.custody.needs_acknowledgement()) out.text(" acknowledge=needed");
  tell_sequence(out, controls);
  const Snapshot& s = controls.mover.now();
  out.text(" ticks=").integer(s.execution.total);
  tell(out, "late", s.lateness);
  tell(out, "exec", s.execution);
  if (controls.longest_step >= hal::Duration::zero()) {
    out.text(" step_max_us=").number(1e6 * hal::seconds(controls.longest_step), 1);
  }
  return Answer();
}

Result<Answer> tell_signature(Controls& controls, const Request& /*request*/, Line& out) {
  const auto& record = controls.custody.active();
  if (!record) {
    out.text(" model=nominal");
    return Answer();
  }
  out.text(" model=signature");
  SignatureFigures(*record).tell(out);
  if (record->identified_at_s > 0) {
    out.text(" identified_unix_s=").integer(static_cast<std::uint64_t>(record->identified_at_s));
  }
  tell_persons(out, *record);
  for (std::size_t i = 0; i < record->signature.pseudo_dh.size(); ++i) {
    const DhJoint& row = record->signature.pseudo_dh[i];
    out.text(" theta").integer(i + 1).text("_deg=").number(degrees(row.theta_rad), 6);
    out.text(" d").integer(i + 1).text("_mm=").number(1e3 * row.d_m, 4);
    out.text(" a").integer(i + 1).text("_mm=").number(1e3 * row.a_m, 4);
    out.text(" alpha").integer(i + 1).text("_deg=").number(degrees(row.alpha_rad), 6);
  }
  return Answer();
}

Result<Answer> tell_candidate(Controls& controls, const Request& /*request*/, Line& out) {
  const IdentificationSequence& identification = controls.identification;
  if (!identification.has_verdict()) return std::unexpected(Error::kNoCandidate);
  identification.tell_verdict(out);
  return Answer();
}

Result<Answer> tell_log(Controls& controls, const Request& request, Line& out) {
  const MeasurementLog& log = controls.identification.log();
  if (request.arguments.empty()) {
    out.text(" rows=").integer(log.size()).text(" capacity=").integer(log.capacity());
    return Answer();
  }
  const auto& [key, value] = request.arguments[0];
  if (request.arguments.size() != 1 || key != "row") {
    return std::unexpected(Error::kUnknownRequest);
  }
  ARMSIG_TRY(index, needed_number(key, value, out));
  if (!(index >= 1 && index <= static_cast<double>(log.size()))) {
    return std::unexpected(Error::kOutOfRange);
  }
  const LogEntry& row = log[static_cast<std::size_t>(index) - 1];
  out.text(" sweep=").integer(row.sweep()).text(" pings=").integer(row.pings());
  tell_readings(out, controls.configuration.drawing, row.readings(), 5);
  tell_point(out, row.p_S(), 4);
  out.text(" sigma_mm=").number(1e3 * row.sigma_m(), 4);
  return Answer();
}

}  // namespace armsig::controller
