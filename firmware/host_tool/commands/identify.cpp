// SPDX-License-Identifier: MIT
// armsig identify: measurements to a signature.
#include <algorithm>

#include <fmt/core.h>

#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/formats/arm_file.hpp"
#include "firmware/host_tool/formats/foreign_columns.hpp"
#include "firmware/host_tool/formats/signature_file.hpp"
#include "firmware/host_tool/identification_run.hpp"
#include "firmware/host_tool/presentation/progress.hpp"
#include "firmware/host_tool/presentation/signature_tables.hpp"
#include "firmware/host_tool/record.hpp"

namespace armsig::tool {
namespace {

struct Options : CommonOptions {
  std::string arm, measurements, columns, sensor, out, serial;
  std::string method = "encoder";
};

void print_for_a_person(const Options& options, const SignatureRecord& record,
                        const RowCounts& counts) {
  const Signature& signature = record.signature;
  std::size_t rejected = 0;
  for (const auto& feature : signature.features) rejected += feature.quality.rejected;
  fmt::print("{}: arm signature from {} by the {} method\n\n", record.arm_name,
             options.measurements, options.method);
  fmt::print("  {} rows: {} rejected as outliers", counts.rows, rejected);
  if (counts.missing > 0) fmt::print(", {} without a position", counts.missing);
  if (counts.inconsistent > 0) {
    fmt::print(", {} with ranges that do not meet in a point", counts.inconsistent);
  }
  if (counts.excluded_ranges > 0) {
    fmt::print(", {} single ranges not believed", counts.excluded_ranges);
  }
  if (counts.mixed > 0) {
    fmt::print(", {} with sweep 0, which this method does not use", counts.mixed);
  }
  if (record.air_c) fmt::print("; air {:.1f} °C", *record.air_c);
  fmt::print("\n\n");
  if (!signature.features.empty()) {
    fmt::print("What the sweeps say (residuals are root mean squares)\n\n{}\n",
               sweep_table(signature));
  }
  fmt::print("Pseudo Denavit-Hartenberg parameters\n\n{}\n{}", dh_table(signature.pseudo_dh),
             near_parallel_note(signature));
}

std::string lines_in_words(const std::vector<std::size_t>& lines) {
  constexpr std::size_t kMostShown = 20;
  std::string words;
  for (std::size_t k = 0; k < std::min(lines.size(), kMostShown); ++k) {
    words += fmt::format("{}{}", k == 0 ? "" : ", ", lines[k]);
  }
  if (lines.size() > kMostShown) words += fmt::format(" and {} more", lines.size() - kMostShown);
  return words;
}

void print_refinement(const RefinementOutcome& outcome) {
  const refinement::FitQuality& quality = outcome.refined->quality;
  fmt::print("\nThe refinement\n\n");
  if (outcome.drawing_rms_m) {
    fmt::print("  drawing, base and tool fitted   {:8.3f} mm RMS\n", 1e3 * *outcome.drawing_rms_m);
  }
  fmt::print("  residual of the fit             {:8.3f} mm RMS, {} measurements\n",
             1e3 * quality.rms_m, quality.rows_used);
  const refinement::CrossValidation& crossed = outcome.cross_validation;
  if (crossed.rows > 0) {
    fmt::print(
        "  poses left out of the fit       {:8.3f} mm RMS, {:.3f} mm mean, {:.3f} mm at most\n",
        1e3 * crossed.rms_m, 1e3 * crossed.mean_m, 1e3 * crossed.largest_m);
  }
  fmt::print("  predicted tool error, 1 sigma   {:8.3f} mm RMS over the joint limits\n",
             1e3 * outcome.predicted_tool_error_m);
  if (quality.covariance_enlarged) {
    fmt::print(
        "  the residuals are {:.1f} times the stated noise; the uncertainty is enlarged by as "
        "much\n",
        quality.noise_factor);
  }
  if (!outcome.rejected_lines.empty()) {
    fmt::print("  outliers, by line               {}\n", lines_in_words(outcome.rejected_lines));
  }
}

nlohmann::ordered_json refinement_json(const RefinementOutcome& outcome) {
  nlohmann::ordered_json json{{"rms_m", outcome.refined->quality.rms_m},
                              {"iterations", outcome.refined->quality.iterations},
                              {"noise_factor", outcome.refined->quality.noise_factor},
                              {"predicted_tool_error_m", outcome.predicted_tool_error_m},
                              {"rejected_lines", outcome.rejected_lines},
                              {"undetermined", outcome.undetermined},
                              {"cross_validation",
                               {{"rows", outcome.cross_validation.rows},
                                {"mean_m", outcome.cross_validation.mean_m},
                                {"rms_m", outcome.cross_validation.rms_m},
                                {"largest_m", outcome.cross_validation.largest_m}}}};
  if (outcome.drawing_rms_m) json["drawing_rms_m"] = *outcome.drawing_rms_m;
  return json;
}

// The file as it is, or with its columns mapped: what was made of what is said first.
Read<MeasurementReader> open_measurements(const Options& options, const JointTypes& types) {
  if (options.columns.empty()) return MeasurementReader::open(options.measurements, types);
  ARMSIG_TRY(mapped, map_measurements(options.measurements, options.columns, types));
  fmt::print(stderr, "{}", in_words(mapped));
  auto reader = MeasurementReader::over(mapped.text, options.measurements, types);
  if (!reader) reader.error().column = 0;  // of the mapped line, not of the file's
  return reader;
}

int run(const Options& options) {
  const auto arm = read_arm_file(options.arm);
  if (!arm) return fail(arm.error(), kBadInput, options);
  std::optional<SensorDescription> sensor;
  if (!options.sensor.empty()) {
    const auto read = read_checked_sensor(options.sensor);
    if (!read) return fail(read.error(), kBadInput, options);
    sensor = *read;
  }

  const bool refine = options.method == "refined";
  IdentificationRun identification(arm->arm, sensor, options.measurements,
                                   refine ? KeepLog::kYes : KeepLog::kNo);
  auto reader = open_measurements(options, types_of(arm->arm));
  if (!reader) return fail(reader.error(), kBadInput, options);
  Progress progress("Reading measurements", 1000);
  for (MeasurementRow row;;) {
    auto more = reader->next(row);
    if (!more && !options.columns.empty()) more.error().column = 0;
    if (!more) return fail(more.error(), kBadInput, options);
    if (!*more) break;
    const auto taken = identification.take(row);
    if (!taken) return fail(taken.error(), kNoAnswer, options);
    if (const auto share = reader->progress()) {
      progress.update(static_cast<std::size_t>(1000 * *share));
    }
  }

  Read<Identified> identified;
  std::optional<RefinementOutcome> refinement;
  if (refine) {
    auto refined = identification.finish_refined();
    if (!refined) return fail(refined.error(), kNoAnswer, options);
    identified = std::move(refined->first);
    refinement = std::move(refined->second);
  } else {
    identified = identification.finish(options.method == "paper" ? features::Method::kPaper
                                                                 : features::Method::kEncoder);
    if (!identified) return fail(identified.error(), kNoAnswer, options);
  }

  SignatureRecord record = record_of(*identified, *arm, options.method, options.serial);
  if (refinement) add_uncertainty(record, *refinement);
  const auto written = write_signature_file(options.out, record);
  if (!written) return fail(written.error(), kBadInput, options);
  for (const std::string& warning : record.warnings) {
    fmt::print(stderr, "armsig: warning: {}\n", warning);
  }
  if (options.json) {
    nlohmann::ordered_json json{{"status", 0},
                                {"arm", record.arm_name},
                                {"method", record.method},
                                {"rows", identified->counts.rows},
                                {"rows_missing", identified->counts.missing},
                                {"rows_inconsistent", identified->counts.inconsistent},
                                {"ranges_excluded", identified->counts.excluded_ranges},
                                {"rows_mixed", identified->counts.mixed},
                                {"warnings", record.warnings},
                                {"signature", signature_json(record.signature)},
                                {"out", options.out}};
    if (refinement) json["refinement"] = refinement_json(*refinement);
    print_json(json);
  } else {
    print_for_a_person(options, record, identified->counts);
    if (refinement) print_refinement(*refinement);
    fmt::print("\nWritten: {}\n", options.out);
  }
  return kDone;
}

}  // namespace

void add_identify(CLI::App& app, int& status) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("identify", "find the arm signature from measured sweeps");
  command->add_option("--arm", options->arm, "arm description (YAML): the drawing")->required();
  command->add_option("--measurements", options->measurements, "sweeps (CSV)")->required();
  command
      ->add_option(
          "--method", options->method,
          "encoder: circles follow the joint reading; paper: plane and centre of rotation alone; "
          "refined: maximum likelihood over all rows, those with sweep 0 too")
      ->check(CLI::IsMember({"encoder", "paper", "refined"}))
      ->capture_default_str();
  command->add_option("--sensor", options->sensor,
                      "sensor description (YAML), where the rows are ranges to receivers");
  command->add_option("--columns", options->columns,
                      "measurements of other software: auto, or x_mm=THEIR NAME,target=#1,... "
                      "(semicolons, decimal commas and lines before the header are understood)");
  command->add_option("--serial", options->serial, "serial number of the arm, for the record");
  command->add_option("--out", options->out, "signature file to write (YAML)")->required();
  add_common(*command, *options);
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace armsig::tool
