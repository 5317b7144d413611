// SPDX-License-Identifier: MIT
// `status`, `signature`, `candidate`, `log`: what the controller says about itself.
#include "core/base/error_name.hpp"
#include "firmware/controller/verbs.hpp"

namespace armsig::controller {
namespace {

void tell(Line& line, std::string_view what, const Histogram& histogram) {
  line.text(" ").text(what).text("_mean_us=").number(histogram.mean_us(), 1);
  line.text(" ").text(what).text("_max_us=").number(1e6 * hal::seconds(histogram.largest), 1);
  line.text(" ").text(what).text("_bins=");
  for (std::size_t i = 0; i < Histogram::kBins; ++i) {
    line.text(i == 0 ? "" : ",").integer(histogram.counts[i]);
  }
}

// Joints whose drives limit the motion by themselves: ` limits_active=3,5`.
void tell_limits(Line& line, const Snapshot& snapshot) {
  line.text(" limits_active=");
  bool first = true;
  for (std::size_t joint = 0; joint < snapshot.positions.size(); ++joint) {
    if ((snapshot.limits_active >> joint & 1U) == 0) continue;
    line.text(first ? "" : ",").integer(joint + 1);
    first = false;
  }
}

// Readings of all joints, with `decimals`: ` q1_deg=10.0000 q2_mm=...`.
void tell_readings(Line& line, const Arm& drawing, const JointVector& q, unsigned decimals) {
  for (std::size_t i = 0; i < q.size(); ++i) {
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

void tell_arm(Line& line, const Controls& controls) {
  const Snapshot& s = controls.mover.now();
  line.text(" mode=").text(name(s.mode));
  if (s.fault) {
    line.text(" fault=").text(name(s.fault->error));
    if (s.fault->joint) line.text(" fault_joint=").integer(*s.fault->joint + 1);
    line.device_says(s.fault->code, s.fault->words, "fault_");
  }
  line.text(" moving=").text(s.moving ? "yes" : "no");
  if (s.limits_active != 0) tell_limits(line, s);
  tell_readings(line, controls.configuration.drawing, s.positions, 4);
  tell_point(line, s.X_RT.p, 3);
  const Model& model = controls.link.models[s.model];
  line.text(" model=").text(model.identified ? "signature" : "drawing");
  if (model.identified) line.text(" maps=").text(model.joints.exact() ? "no" : "yes");
}

void tell_sensor(Line& line, const PointMeasurement& measurement) {
  line.text(" sensor=");
  line.text(measurement.trouble() ? name(*measurement.trouble()) : "well");
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
    line.text(" left_s=").number(identification.left_s(), 0);
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
  out.text(" step_max_us=").number(1e6 * hal::seconds(controls.longest_step), 1);
  return Answer();
}

Result<Answer> tell_signature(Controls& controls, const Request& /*request*/, Line& out) {
  const auto& record = controls.custody.active();
  if (!record) {
    out.text(" model=drawing");
    return Answer();
  }
  out.text(" model=signature sequence=").integer(record->sequence);
  out.text(" air_c=").number(record->air_celsius, 1);
  out.text(" held_out_rms_mm=").number(1e3 * record->held_out_rms_m, 4);
  out.text(" predicted_sigma_mm=").number(1e3 * record->predicted_sigma_m, 4);
  if (record->identified_at_s > 0) {
    out.text(" identified_unix_s=").integer(static_cast<std::uint64_t>(record->identified_at_s));
  }
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
  const HeldOutReport& report = identification.report();
  out.text(" held_out=").integer(report.poses);
  out.text(" candidate_rms_mm=").number(1e3 * report.candidate_rms_m, 4);
  out.text(" active_rms_mm=").number(1e3 * report.active_rms_m, 4);
  out.text(" better=").text(report.is_better() ? "yes" : "no");
  return Answer();
}

Result<Answer> tell_log(Controls& controls, const Request& request, Line& out) {
  const MeasurementLog& log = controls.identification.log();
  if (request.arguments.empty()) {
    out.text(" rows=").integer(log.size()).text(" capacity=").integer(log.capacity());
    return Answer();
  }
  const auto index = parse_number(request.arguments[0].second);
  if (request.arguments.size() != 1 || request.arguments[0].first != "row") {
    return std::unexpected(Error::kUnknownRequest);
  }
  if (!index || !(*index >= 1 && *index <= static_cast<double>(log.size()))) {
    return std::unexpected(Error::kOutOfRange);
  }
  const LogEntry& row = log[static_cast<std::size_t>(*index) - 1];
  out.text(" sweep=").integer(row.sweep()).text(" pings=").integer(row.pings());
  tell_readings(out, controls.configuration.drawing, row.readings(), 5);
  tell_point(out, row.p_S(), 4);
  out.text(" sigma_mm=").number(1e3 * row.sigma_m(), 4);
  return Answer();
}

}  // namespace armsig::controller
