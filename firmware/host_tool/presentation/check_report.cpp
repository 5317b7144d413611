// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/check_report.hpp"

#include <string_view>

#include <fmt/core.h>

#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

std::string what_moved(const drift::DriftReport& report, std::size_t joints) {
  if (report.link == 0) return "the base has moved against the sensor";
  if (report.link == joints) {
    return fmt::format("link {} with its target, or the zero of joint {}, has moved", joints,
                       joints);
  }
  return fmt::format("link {}, or the zero of joint {} or {}, has moved", report.link, report.link,
                     report.link + 1);
}

const char* verdict_word(drift::DriftVerdict verdict) {
  switch (verdict) {
    case drift::DriftVerdict::kConsistent:
      return "consistent";
    case drift::DriftVerdict::kDrifted:
      return "drifted";
    case drift::DriftVerdict::kSensorWorse:
      return "sensor-worse";
  }
  return "consistent";
}

// No sensor is so bad: what is wrong is a unit, a column, or the arm.
constexpr double kNoNoise = 300;

void print_residuals(const char* of, double rms_m, double mean_m, double largest_m) {
  say("  {:<37} {:6.3f} mm RMS, {:.3f} mean, {:.3f} at most\n", of, 1e3 * rms_m, 1e3 * mean_m,
      1e3 * largest_m);
}

std::string next_step(const Checked& checked) {
  if (checked.since) return mend_of(*checked.since);
  if (checked.place) return "identify from there, or put the sensor back";
  switch (checked.report.verdict) {
    case drift::DriftVerdict::kConsistent:
      if (!checked.disbelieved.empty()) return "look after the receiver named";
      return "nothing; check again after a collision, a repair, or a season";
    case drift::DriftVerdict::kSensorWorse:
      if (!checked.unmeasured.empty()) {
        return "identify anew, with the rows of both files; or check with poses between the "
               "readings that were measured";
      }
      if (checked.report.noise_factor > kNoNoise) {
        return "look at the units and columns of the measurements, and whose arm they are of";
      }
      return "measure one pose ten times. Where it scatters more than is stated, look after "
             "the sensor: targets, air, its own check. Where it does not, identify anew, with "
             "poses measured since only, --method refined";
    default:
      return "sweep the joints again, and identify";
  }
}

void print_verdict(const Checked& checked, const std::string& measurements) {
  const std::string_view verdict = checked.unmeasured.empty()
                                       ? drift::describe(checked.report.verdict)
                                       : "beyond what was measured";
  if (checked.place) {
    say("{}: measured from another place: {:.1f} mm, {:.2f}°; from there {}\n\n", measurements,
        1e3 * checked.place->shift_m, degrees(checked.place->turn_rad), verdict);
  } else {
    say("{}: {}\n\n", measurements, verdict);
  }
}

// What may have made the rows miss.
void print_cause(const Checked& checked, const Signature& signature) {
  const drift::DriftReport& report = checked.report;
  const std::size_t joints = signature.joint_count();
  if (checked.since) {
    for (const std::string& words : in_words(*checked.since, signature)) {
      say("{}", paragraph("most likely " + words));
    }
    say("  with that the signature misses the rows by {:.3f} mm RMS instead of {:.3f} mm\n",
        1e3 * checked.since->after_m, 1e3 * checked.since->before_m);
    return;
  }
  if (report.verdict == drift::DriftVerdict::kDrifted) {
    say("  most likely {}\n", what_moved(report, joints));
  }
  if (report.verdict != drift::DriftVerdict::kSensorWorse) return;
  if (!checked.unmeasured.empty()) {
    for (const UnmeasuredJoint& one : checked.unmeasured) say("{}", paragraph(in_words(one)));
    say("  what gravity and the joints do there was never measured\n");
    return;
  }
  if (report.noise_factor > kNoNoise) {
    say("  the rows miss by {:.0f} times the noise stated, as no sensor does: they\n"
        "  are not of this arm and tool, or\n"
        "  not in the units and columns that their header says\n",
        report.noise_factor);
  } else {
    // Errors that are no noise look like it at poses that are each measured once.
    say("  the noise is {:.1f} times the one stated; or gravity and the readings do to the\n"
        "  arm what its signature does not know, as sweeps alone hardly show it\n",
        report.noise_factor);
  }
}

void print_rows(const Checked& checked) {
  const drift::DriftReport& report = checked.report;
  say("  {} rows, {} of them outliers\n", report.rows + report.rows_rejected, report.rows_rejected);
  if (checked.copied > 0) {
    say("  {} rows are copies of others, and count once\n", checked.copied);
  }
  if (checked.fitted > 0) {
    say("  {} more rows had a part in the signature, and none in this check\n", checked.fitted);
  }
  if (!checked.origin_stated) {
    say("  whether the signature was fitted to them it does not say\n");
  }
  if (!checked.rejected_lines.empty()) {
    say("  outliers, by line: {}\n", lines_in_words(checked.rejected_lines));
  }
  for (const DisbelievedReceiver& receiver : checked.disbelieved) {
    say("  receiver {}: {} of its {} ranges are outliers: it is not where the\n"
        "  sensor description has it, or hears something else\n",
        receiver.number, receiver.rejected, receiver.ranges);
  }
}

// The residuals by the drawing and by the signature.
void print_fit(const Checked& checked) {
  if (checked.nominal) {
    const ResidualSummary& nominal = *checked.nominal;
    print_residuals("before: nominal, base and tool fitted", nominal.rms_m, nominal.mean_m,
                    nominal.largest_m);
  } else {
    say("  before: these rows are too few to fit base and tool to the nominal model\n");
  }
  const drift::DriftReport& report = checked.report;
  print_residuals(
      checked.place ? "after: the signature, from that place" : "after: the signature as it is",
      report.rms_m, report.mean_m, report.largest_m);
  say("  chi-square {:.1f} with {} degrees of freedom; healthy arms stay below {:.1f}\n",
      report.chi_square, report.freedom, report.allowed);
}

}  // namespace

void print_checked(const Checked& checked, const Signature& signature,
                   const std::string& measurements) {
  print_verdict(checked, measurements);
  print_cause(checked, signature);
  print_rows(checked);
  print_fit(checked);
  say("\n{}", paragraph("Next: " + next_step(checked), 0));
}

namespace {

nlohmann::ordered_json figures_of(const Checked& checked, int status) {
  const drift::DriftReport& report = checked.report;
  return {{"status", status},
          {"verdict", checked.place                ? "another-place"
                      : checked.unmeasured.empty() ? verdict_word(report.verdict)
                                                   : "unmeasured-readings"},
          {"link", report.link},
          {"noise_factor", report.noise_factor},
          {"chi_square", report.chi_square},
          {"degrees_of_freedom", report.freedom},
          {"allowed", report.allowed},
          {"rows", report.rows},
          {"rows_rejected", report.rows_rejected},
          {"rows_copied", checked.copied},
          {"rows_fitted", checked.origin_stated ? nlohmann::ordered_json(checked.fitted) : nullptr},
          {"rejected_lines", checked.rejected_lines},
          {"rms_m", report.rms_m},
          {"mean_m", report.mean_m},
          {"largest_m", report.largest_m}};
}

}  // namespace

nlohmann::ordered_json json_of(const Checked& checked, const Signature& signature, int status) {
  nlohmann::ordered_json json = figures_of(checked, status);
  json["receivers_rejected"] = nlohmann::ordered_json::array();
  for (const DisbelievedReceiver& receiver : checked.disbelieved) {
    json["receivers_rejected"].push_back({{"receiver", receiver.number},
                                          {"rejected", receiver.rejected},
                                          {"ranges", receiver.ranges}});
  }
  json["unmeasured_joints"] = nlohmann::ordered_json::array();
  for (const UnmeasuredJoint& one : checked.unmeasured) {
    json["unmeasured_joints"].push_back(one.joint + 1);
  }
  if (checked.since) {
    json["since_then"] = in_words(*checked.since, signature);
    json["rms_with_that_m"] = checked.since->after_m;
  }
  if (checked.place) {
    json["place"] = {{"shift_m", checked.place->shift_m},
                     {"turn_rad", checked.place->turn_rad},
                     {"verdict_from_there", verdict_word(checked.report.verdict)}};
  }
  if (checked.nominal) {
    json["nominal"] = {{"rms_m", checked.nominal->rms_m},
                       {"mean_m", checked.nominal->mean_m},
                       {"largest_m", checked.nominal->largest_m}};
  }
  return json;
}

}  // namespace armsig::tool
