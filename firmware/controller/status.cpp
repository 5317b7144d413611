// SPDX-License-Identifier: MIT
// `status` and `signature`: what the controller says about itself.
#include "core/base/error_name.hpp"
#include "firmware/controller/background.hpp"

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

}  // namespace

void Background::tell_status() {
  const Snapshot& s = mover_.now();
  out_.text(" mode=").text(name(s.mode));
  if (s.fault) {
    out_.text(" fault=").text(name(s.fault->error));
    if (s.fault->joint) out_.text(" fault_joint=").integer(*s.fault->joint + 1);
    out_.device_says(s.fault->code, s.fault->words, "fault_");
  }
  out_.text(" moving=").text(s.moving ? "yes" : "no");
  if (s.limits_active != 0) tell_limits(out_, s);
  for (std::size_t i = 0; i < s.positions.size(); ++i) {
    const bool turns = configuration_.drawing.joints[i].type == JointType::kRevolute;
    out_.text(" q").integer(i + 1).text(turns ? "_deg=" : "_mm=");
    out_.number(turns ? degrees(s.positions[i]) : 1e3 * s.positions[i], 4);
  }
  out_.text(" x_mm=").number(1e3 * s.X_RT.p.x(), 3);
  out_.text(" y_mm=").number(1e3 * s.X_RT.p.y(), 3);
  out_.text(" z_mm=").number(1e3 * s.X_RT.p.z(), 3);
  out_.text(" model=").text(link_.models[s.model].identified ? "signature" : "drawing");
  out_.text(" sensor=");
  out_.text(measurement_.trouble() ? name(*measurement_.trouble()) : "well");
  if (const std::string_view words = measurement_.trouble_words(); !words.empty()) {
    out_.text(" sensor_says=\"").text(words).text("\"");
  }
  if (store_error_) out_.text(" store=").text(name(*store_error_));
  if (identification_.is_running()) {
    out_.text(" sequence=").text(identification_.is_paused() ? "paused" : "identifying");
    out_.text(" points=").integer(identification_.points_done());
    out_.text(" planned=").integer(identification_.points_planned());
    out_.text(" left_s=").number(identification_.left_s(), 0);
  } else if (grid_.is_running()) {
    out_.text(" sequence=touching touched=").integer(grid_.touched());
  } else {
    out_.text(" sequence=none");
  }
  out_.text(" ticks=").integer(s.execution.total);
  tell(out_, "late", s.lateness);
  tell(out_, "exec", s.execution);
  out_.text(" step_max_us=").number(1e6 * hal::seconds(longest_step_), 1);
}

void Background::tell_signature() {
  if (!active_) {
    out_.text(" model=drawing");
    return;
  }
  out_.text(" model=signature sequence=").integer(active_->sequence);
  out_.text(" air_c=").number(active_->air_celsius, 1);
  out_.text(" held_out_rms_mm=").number(1e3 * active_->held_out_rms_m, 4);
  for (std::size_t i = 0; i < active_->signature.pseudo_dh.size(); ++i) {
    const DhJoint& row = active_->signature.pseudo_dh[i];
    out_.text(" theta").integer(i + 1).text("_deg=").number(degrees(row.theta_rad), 6);
    out_.text(" d").integer(i + 1).text("_mm=").number(1e3 * row.d_m, 4);
    out_.text(" a").integer(i + 1).text("_mm=").number(1e3 * row.a_m, 4);
    out_.text(" alpha").integer(i + 1).text("_deg=").number(degrees(row.alpha_rad), 6);
  }
}

}  // namespace armsig::controller
