// SPDX-License-Identifier: MIT
// What a self-calibration says of itself.
#include <algorithm>
#include <cmath>

#include "firmware/controller/signature_figures.hpp"
#include "firmware/self_calibration/self_calibration.hpp"

namespace armsig::controller {
namespace {

// A target nearer to an axis hardly moves when that joint turns.
constexpr double kShortLever_m = 25e-3;
// Of the square of the accuracy asked for, what more poses may leave before it is named first.
constexpr double kMostThatStays = 0.5;

Line& millimetres(Line& line, std::string_view key, double metres) {
  return line.text(" ").text(key).text("_mm=").number(1e3 * metres, 4);
}

void tell_findings(Line& line, const Findings& found, double asked_m) {
  tell_predicted(line.text(" signature=candidate"), found.predicted());
  millimetres(line, "asked", asked_m);
  line.text(" validation=").integer(found.held_out.poses);
  line.text(" outliers=").integer(found.held_out.blunders);
  line.text(" fitted=").integer(found.fitted).text(" rejected=").integer(found.rejected);
  if (found.held_out.poses > 0) millimetres(line, "validation_rms", found.held_out.rms_m);
  millimetres(line, "sensor", found.sensor_m);
  millimetres(line, "model", found.model_m);
  millimetres(line, "backlash", found.play_m);
}

}  // namespace

// What it would take to halve what is predicted.
void SelfCalibration::tell_halving(Line& line, const Findings& found) const {
  const double times = found.times_more(found.predicted_m() / 2);
  line.text(" halve_poses=");
  if (!std::isfinite(times)) {
    line.text("never");  // play alone is more
    return;
  }
  const double poses = (times - 1) * static_cast<double>(count_);
  line.integer(static_cast<std::uint64_t>(std::ceil(poses)));
  if (const auto each = each_visit()) {
    line.text(" halve_minutes=").number(poses * hal::seconds(*each) / 60, 0);
  }
}

void SelfCalibration::do_tell_state(Line& line) const {
  if (findings_.fitted == 0) return;
  tell_predicted(line, findings_.predicted(), "candidate_");
  millimetres(line, "asked", aim_.accuracy_m);
  tell_halving(line, findings_);
}

void SelfCalibration::tell_progress(Line& line) const {
  line.text("# identify refining poses=").integer(visited_);
  line.text(" planned=").integer(planned_);
  tell_findings(line, findings_, aim_.accuracy_m);
  if (recalled_ > 0) line.text(" recalled=").integer(recalled_);
  tell_halving(line, findings_);
  const auto each = each_visit();
  if (!each) return;
  const double poses_s =
      hal::seconds(*each) * static_cast<double>(std::max(planned_, visited_) - visited_);
  const double time_s = std::max(hal::seconds(aim_.ends - now_), 0.0);
  line.text(" left_s=").number(std::min(poses_s, time_s), 0);
}

void SelfCalibration::tell_outcome(Line& line) const {
  line.text("# identify accuracy=");
  line.text(outcome_ == Outcome::kReached ? "reached" : "missed");
  const Found* const found = best();
  if (outcome_ == Outcome::kChanged) {
    line.text(" model=none changed=").text(change_.what);
    millimetres(line, "by", change_.by_m);
    line.text(" again=").integer(repeats_.count());
    return;
  }
  if (found == nullptr) {
    line.text(" model=features");
    if (refused_) line.reason(*refused_);
    return;
  }
  line.text(" model=").text(whole_is_better() ? "maps" : "geometry");
  line.text(" poses=").integer(visited_);
  tell_findings(line, found->findings, aim_.accuracy_m);
  if (geometry_) millimetres(line, "geometry_rms", geometry_->findings.held_out.rms_m);
  tell_halving(line, found->findings);
}

void SelfCalibration::tell_play(Line& line) const {
  line.text("# identify backlash");
  const HalfPlays& halves = best()->findings.play;
  for (std::size_t i = 0; i < halves.size(); ++i) {
    const bool turns = configuration_.drawing.joints[i].type == JointType::kRevolute;
    const auto number = [&](double half) { return 2 * (turns ? degrees(half) : 1e3 * half); };
    const std::string_view unit = turns ? "_deg=" : "_mm=";
    line.text(" q").integer(i + 1).text(unit);
    if (!std::isfinite(halves[i].sigma)) {
      line.text("unknown");
      continue;
    }
    line.number(number(std::abs(halves[i].value)), 5);
    line.text(" s").integer(i + 1).text(unit).number(number(halves[i].sigma), 5);
  }
  // Of the others no more than chance shows.
  line.text(" seen=");
  bool any = false;
  for (std::size_t i = 0; i < halves.size(); ++i) {
    if (!halves[i].is_seen()) continue;
    line.text(any ? "," : "").integer(i + 1);
    any = true;
  }
  if (!any) line.text("none");
}

// Why it was not reached, and what would help.
void SelfCalibration::tell_advice(Line& line) const {
  line.text("# identify the accuracy that was asked for is not reached: ");
  if (outcome_ == Outcome::kChanged) {
    line.text("what was measured first is elsewhere when it is measured again; look at the ")
        .text(change_.what == "arm" ? "arm's load and what holds its parts" : change_.what)
        .text(change_.what == "load"
                  ? " on the flange: weights deflect the joints by another amount"
                  : "")
        .text(change_.what == "target" ? " on the flange and how it is fixed" : "")
        .text(change_.what == "sensor" ? " and what it stands on, and at what the arm carries" : "")
        .text(", then identify once more");
    return;
  }
  const Found* const found = best();
  if (outcome_ == Outcome::kRefused) {
    line.text(
        "no model like the nominal model explains what was measured; look at nominal model, target "
        "and ");
    line.text("sensor");
    return;
  }
  if (found == nullptr) {
    line.text("time was over before enough poses were measured to judge by; give more minutes");
    return;
  }
  const Findings& findings = found->findings;
  const double more = findings.times_more(aim_.accuracy_m);
  if (outcome_ == Outcome::kPlay || !std::isfinite(more)) {
    const Budget::Part& play = findings.budget.play;
    line.text("the joints' backlash alone is more, ").number(1e3 * play.length_m, 3);
    line.text(" mm, joint ").integer(play.joint + 1).text(" has ").number(1e3 * play.of_joint_m, 3);
    line.text(" of it; no measurement takes it out, look at its gears");
    return;
  }
  line.text(outcome_ == Outcome::kMemoryFull ? "the memory is full" : "time is over");
  line.text("; what would help: ");
  tell_help(line, findings);
}

// By what most of the error comes from.
void SelfCalibration::tell_help(Line& line, const Findings& findings) const {
  const Budget& budget = findings.budget;
  const double rest_m = std::hypot(budget.geometry_m, budget.maps.length_m);
  const auto millimetre = [&](double length_m) -> Line& { return line.number(1e3 * length_m, 3); };
  // More poses where the arm is measured already do not take it out.
  const double stays_m = std::hypot(budget.uncovered.length_m, budget.play.length_m);
  if (stays_m * stays_m > kMostThatStays * aim_.accuracy_m * aim_.accuracy_m) {
    const std::size_t joint = budget.uncovered.joint;
    line.text("a wider arc of joint ").integer(joint + 1).text(", whose readings");
    line.text(" that were not measured have ");
    millimetre(budget.uncovered.of_joint_m).text(" mm: more of it in the sensor's sight");
    return;
  }
  // Of few held-out poses chance may show as much: three sigma of the factor's square.
  const double factor = findings.held_out.factor;
  const double chance = 3 * std::sqrt(2 / (3 * static_cast<double>(findings.held_out.poses)));
  if (budget.unexplained_m > rest_m && factor * factor > 1 + chance) {
    line.text("to find what no model of the arm explains, ");
    millimetre(budget.unexplained_m).text(" mm: another target, fixed more firmly, or another ");
    line.text("place of the sensor; then look at load and temperature");
    return;
  }
  const double more = findings.times_more(aim_.accuracy_m);
  const double beyond = std::max(more - 1, 0.0) * static_cast<double>(count_);
  line.text("about ").integer(static_cast<std::uint64_t>(std::ceil(beyond))).text(" more poses");
  if (const auto each = each_visit()) {
    line.text(" (").number(beyond * hal::seconds(*each) / 60, 0).text(" minutes)");
  }
  line.text(", or a sensor of ");
  millimetre(findings.sensor_m / std::sqrt(std::max(more, 1.0))).text(" mm");
  if (budget.lever_m < kShortLever_m) {
    line.text("; another target, farther from the axis of joint ").integer(budget.shortest + 1);
    line.text(" than ");
    millimetre(budget.lever_m).text(" mm, would tell more of that joint");
  }
}

// Where what is predicted comes from.
void SelfCalibration::tell_budget(Line& line) const {
  const Budget& budget = best()->findings.budget;
  line.text("# identify budget");
  millimetres(line, "geometry", budget.geometry_m);
  const auto part = [&](std::string_view name, const Budget::Part& of) {
    millimetres(line, name, of.length_m);
    if (of.length_m <= 0) return;
    line.text(" ").text(name).text("_joint=").integer(of.joint + 1);
    line.text(" ").text(name).text("_joint_mm=").number(1e3 * of.of_joint_m, 4);
  };
  part("maps", budget.maps);
  part("uncovered", budget.uncovered);
  part("backlash", budget.play);
  millimetres(line, "unexplained", budget.unexplained_m);
}

}  // namespace armsig::controller
