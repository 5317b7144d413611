// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/identify_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"
#include "firmware/host_tool/presentation/differences.hpp"
#include "firmware/host_tool/presentation/refinement_report.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/signature_tables.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/refinement/corrections_option.hpp"
#include "firmware/host_tool/signature/doubt_stated.hpp"
#include "firmware/host_tool/sweeps_alone/unseen_gear.hpp"

namespace armsig::tool {
namespace {

void print_head(const ReportedFiles& files, const SignatureRecord& record, const Found& found) {
  const Signature& signature = record.signature;
  const RowCounts& counts = found.identified.counts;
  say("{}: arm signature from {} by the {} method\n\n", record.arm_name, files.measurements,
      record.method);
  if (!found.why_method.empty()) {
    say("{}\n", paragraph(fmt::format("the {} method, {}", record.method, found.why_method)));
  }
  say("  {} rows: {} rejected as outliers", counts.rows,
      record.fit ? record.fit->rows_rejected : 0);
  if (found.refinement && found.refinement->free_poses_rejected > 0) {
    say(" ({} of the {} free poses)", found.refinement->free_poses_rejected, counts.mixed);
  }
  if (found.refinement && found.refinement->merged_rows) {
    say(", merged to {} for the fit", *found.refinement->merged_rows);
  }
  if (counts.missing > 0) say(", {} without a position", counts.missing);
  if (counts.inconsistent > 0) {
    say(", {} with ranges that do not meet in a point", counts.inconsistent);
  }
  if (counts.excluded_ranges > 0) {
    say(", {} single ranges not believed", counts.excluded_ranges);
  }
  if (counts.mixed > 0 && record.method != "refined") {
    say(",\n  {} with sweep 0, which this method does not use", counts.mixed);
  }
  if (record.air_c) say("; air {:.1f} °C", *record.air_c);
  say("\n\n");
  if (!signature.features.empty()) {
    say("What the sweeps say (residuals are root mean squares)\n\n{}\n", sweep_table(signature));
  }
  const std::string note = near_parallel_note(signature);
  say("Pseudo Denavit-Hartenberg parameters\n\n{}{}{}", dh_table(signature.pseudo_dh),
      note.empty() ? "" : "\n", note);
}

// With and without the rows that the fit to everything rejects; and what is stated for the latter.
void print_left_out(const calibration::HeldOutScore& score) {
  if (score.rejected > 0) {
    say("  without the {} of them rejected as outliers: {:.3f} mm RMS, {:.3f} mm mean\n",
        score.rejected, 1e3 * score.rms_kept_m, 1e3 * score.mean_kept_m);
  }
  say("  stated for such rows beforehand: {:.3f} mm RMS\n", 1e3 * score.stated_rms_m);
}

// The figures that count, whichever the method: they are not those of the fit.
// Both figures where maps leave the readings that were not measured less certain.
void print_predicted(const Found& found, const ToolAccuracy::Predicted& predicted) {
  constexpr double kNoWorse = 1.1;
  const auto over_limits_m =
      found.refinement ? found.refinement->predicted_over_limits_m : std::nullopt;
  std::string where = region_in_words(predicted.region);
  if (over_limits_m && *over_limits_m > kNoWorse * predicted.rms_m) {
    where += fmt::format(", {:.3f} mm over all that the joint limits allow", 1e3 * *over_limits_m);
  }
  say("{}", paragraph(fmt::format(
                "predicted tool error, 1 sigma, in the sensor's frame: {:.3f} mm RMS over {}",
                1e3 * predicted.rms_m, where)));
}

// What nothing that was measured tells, unless a slide's reading says how long a millimetre is.
constexpr double kScaleToName = 1e-4;
std::optional<double> moved_by_unseen_scale_m(const Found& found, const SignatureRecord& record) {
  const bool slides = std::ranges::find(record.signature.types, JointType::kPrismatic) !=
                      record.signature.types.end();
  const bool asked = found.refinement && found.refinement->fitted.scale;
  if (slides || asked || found.scale_stated || !record.accuracy.predicted) return std::nullopt;
  return moved_by_scale_m(record, 1 + kScaleToName);
}

bool is_from_sweeps_alone(const Found& found) {
  return found.identified.counts.mixed == 0 && found.identified.counts.rows > 0;
}

// How well rows are predicted that the fit did not see.
void print_validation(const Found& found) {
  if (!found.validation || found.validation->rows == 0) {
    say("  too few rows to leave some of them out of the fit\n");
    return;
  }
  const CrossValidation& left_out = *found.validation;
  say("  {} validation rows: {:.3f} mm RMS, {:.3f} mm mean, {:.3f} mm at most\n", left_out.rows,
      1e3 * left_out.rms_m, 1e3 * left_out.mean_m, 1e3 * left_out.largest_m);
  if (found.refinement && found.refinement->left_out) {
    print_left_out(*found.refinement->left_out);
  } else if (left_out.far_off > 0 && left_out.rms_m > kComputed_m) {
    say("  without the {} outliers among them: {:.3f} mm RMS, {:.3f} mm mean\n", left_out.far_off,
        1e3 * left_out.rms_kept_m, 1e3 * left_out.mean_kept_m);
  }
}

// The same by another model than the one that was taken.
void print_other_models(const RefinementOutcome& outcome) {
  if (outcome.geometry_left_out_mean_m) {
    say("{}",
        paragraph(fmt::format(
            "gravity and a map of each reading are part of it: {:.3f} mm mean by geometry alone",
            1e3 * *outcome.geometry_left_out_mean_m)));
  }
  if (outcome.offered) {
    say("  with corrections of the joint readings {:.3f} mm mean: --correct {}\n",
        1e3 * outcome.offered->left_out_mean_m, corrections_in_words(outcome.offered->terms));
  }
}

// What the predicted error leaves out, because the measurements do not tell it.
void print_what_is_left_open(const Found& found, const SignatureRecord& record) {
  if (const auto moved_m = moved_by_unseen_scale_m(found, record)) {
    say("{}", paragraph(fmt::format("not in it: the scale of the sensor, which angles do not tell; "
                                    "{:.0f} ppm of all lengths move the tool by {:.3f} mm, base "
                                    "and tool fitted",
                                    1e6 * kScaleToName, 1e3 * *moved_m)));
  }
  if (!is_from_sweeps_alone(found)) return;
  if (const auto gear = least_seen_gear(record)) {
    say("{}", paragraph(fmt::format("not in it: the gear ratio of joint {}, which is taken as "
                                    "exact; its sweep determines it to "
                                    "{:.3f} %, and so much moves the tool by {:.3f} mm",
                                    gear->joint + 1, 1e2 * gear->sigma, 1e3 * gear->moved_m)));
  }
  say("{}", paragraph("found from sweeps alone, in which gravity, joint errors and tilted "
                      "axes look alike: what that leaves open is counted, backlash is not; some 30 "
                      "poses with all joints anywhere (armsig suggest) distinguish them"));
}

void print_accuracy(const Found& found, const SignatureRecord& record) {
  say("\nHow accurate it is\n\n");
  print_validation(found);
  if (found.refinement) print_other_models(*found.refinement);
  if (record.accuracy.predicted) print_predicted(found, *record.accuracy.predicted);
  print_what_is_left_open(found, record);
}

// Null where no row was left out.
nlohmann::ordered_json validation_json(const Found& found) {
  nlohmann::ordered_json json;
  const bool validated = found.validation && found.validation->rows > 0;
  if (validated) {
    json = {{"rows", found.validation->rows},
            {"mean_m", found.validation->mean_m},
            {"rms_m", found.validation->rms_m},
            {"largest_m", found.validation->largest_m}};
  }
  if (found.refinement && found.refinement->left_out) {
    const calibration::HeldOutScore& score = *found.refinement->left_out;
    json["rejected"] = score.rejected;
    json["mean_kept_m"] = score.mean_kept_m;
    json["rms_kept_m"] = score.rms_kept_m;
    json["stated_rms_m"] = score.stated_rms_m;
    json["enlarged_by"] = score.factor;
    json["region_squares"] = score.region_squares;
  } else if (validated) {
    json["rejected"] = found.validation->far_off;
    json["mean_kept_m"] = found.validation->mean_kept_m;
    json["rms_kept_m"] = found.validation->rms_kept_m;
  }
  return json;
}

// The keys of what is known of the accuracy of the tool, as far as it is.
void add_tool_error(const Found& found, const SignatureRecord& record,
                    nlohmann::ordered_json& json) {
  if (const auto& predicted = record.accuracy.predicted) {
    json["predicted_tool_error_m"] = predicted->rms_m;
    json["predicted_region"] = name(predicted->region);
  }
  if (found.refinement && found.refinement->predicted_over_limits_m) {
    json["predicted_over_limits_m"] = *found.refinement->predicted_over_limits_m;
  }
  if (const auto moved_m = moved_by_unseen_scale_m(found, record)) {
    json["moved_by_100_ppm_scale_m"] = *moved_m;
  }
  if (const auto gear = least_seen_gear(record); gear && is_from_sweeps_alone(found)) {
    json["least_seen_gear"] = {
        {"joint", gear->joint + 1}, {"sigma", gear->sigma}, {"moved_m", gear->moved_m}};
  }
}

}  // namespace

void print_identified(const Found& found, const SignatureRecord& record, const ReportedFiles& files,
                      std::size_t receivers) {
  print_head(files, record, found);
  if (found.refinement) print_refinement(*found.refinement, receivers);
  if (const auto differences = difference_table(record)) {
    say("\n{}", in_words(*differences, record.signature.joint_count()));
  }
  print_accuracy(found, record);
  say("\nWritten: {}\n", file_in_words(files.out));
}

nlohmann::ordered_json json_of(const Found& found, const SignatureRecord& record,
                               const ReportedFiles& files, std::size_t receivers) {
  const RowCounts& counts = found.identified.counts;
  nlohmann::ordered_json json{{"status", 0},
                              {"arm", record.arm_name},
                              {"method", record.method},
                              {"why_method", found.why_method},
                              {"rows", counts.rows},
                              {"rows_missing", counts.missing},
                              {"rows_inconsistent", counts.inconsistent},
                              {"ranges_excluded", counts.excluded_ranges},
                              {"rows_mixed", counts.mixed},
                              {"warnings", record.warnings},
                              {"signature", signature_json(record.signature)},
                              {"out", files.out}};
  json["cross_validation"] = validation_json(found);
  add_tool_error(found, record, json);
  json["differences"] = nullptr;
  if (const auto table = difference_table(record)) json["differences"] = json_of(*table);
  if (found.refinement) json["refinement"] = refinement_json(*found.refinement, receivers);
  return json;
}

}  // namespace armsig::tool
