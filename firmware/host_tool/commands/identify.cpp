// SPDX-License-Identifier: MIT
// armsig identify: measurements to a signature.
#include "firmware/host_tool/commands/identify.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>

#include <fmt/ranges.h>

#include "core/base/error.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/commands/identify_doubts.hpp"
#include "firmware/host_tool/commands/identify_places.hpp"
#include "firmware/host_tool/commands/measurement_options.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/diagnosis/collector.hpp"
#include "firmware/host_tool/identification/identification_run.hpp"
#include "firmware/host_tool/identification/undone.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/identify_report.hpp"
#include "firmware/host_tool/presentation/refinement_report.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/reading/copied_rows.hpp"
#include "firmware/host_tool/reading/range_health.hpp"
#include "firmware/host_tool/reading/read_rows.hpp"
#include "firmware/host_tool/refinement/corrections_option.hpp"
#include "firmware/host_tool/signature/doubt_stated.hpp"
#include "firmware/host_tool/signature/record.hpp"

namespace armsig::tool {
namespace {

// Free poses are counted among so many rows; of more rows it is enough that there is one.
constexpr std::size_t kRowsCounted = 20'000;

// So many rows back a copy is found: of features, whose memory does not grow with the file, fewer.
constexpr std::size_t kRemembered = std::size_t{8} << 10U;

RowReading reading_of(const IdentifyOptions& options, const char* what) {
  return {.progress = what,
          .remembered = options.method == "refined" ? kRememberedInMemory : kRemembered};
}

// Of the ranges of receivers whose offsets are asked for, 1 sigma.
constexpr double kUnknownOffset_m = 5e-3;

// Whether the rows can be read a second time: a pipe is gone by then.
bool can_be_read_again(const OpenRows& rows) {
  return rows.mapped || std::filesystem::is_regular_file(rows.source.measurements);
}

// Puts the method that the rows support best in the place of "auto", and says why; nothing where a
// method was asked for.
Read<std::string> choose_method(IdentifyOptions& options, const OpenRows& source) {
  if (options.method != kBestMethod) return {};
  const auto take = [&](const char* method, std::string why) {
    options.method = method;
    return why;
  };
  if (!options.correct.empty()) return take("refined", "which can find the corrections");
  if (!can_be_read_again(source)) {
    return take("encoder", "as a pipe is read only once; --method refined uses free poses too");
  }
  ARMSIG_TRY(reader, open_reader(source));
  std::size_t rows = 0;
  std::size_t free_poses = 0;
  for (MeasurementRow row; rows <= kRowsCounted || free_poses == 0; ++rows) {
    const auto more = reader.next(row);
    if (!more || !*more) break;  // whoever reads the rows in earnest says what is wrong
    free_poses += row.sweep == 0 && was_seen(row) ? 1 : 0;
  }
  if (free_poses == 0) return take("encoder", "as there are no free poses (sweep 0)");
  if (rows > kRowsCounted) return take("refined", "which uses the free poses (sweep 0) too");
  return take("refined", fmt::format("which uses the {} free poses (sweep 0) too", free_poses));
}

Read<Found> identified_by_features(const IdentifyOptions& options, const OpenRows& rows,
                                   IdentificationRun& identification) {
  auto identified = identification.finish();
  if (!identified) return std::unexpected(identified.error());
  Found found{.identified = std::move(*identified), .refinement = {}, .validation = {}};
  // Features are validated in a second pass.
  if (!can_be_read_again(rows) || !identification.settle_validation()) return found;
  const auto scored = read_rows(rows, reading_of(options, "Scoring validation rows"),
                                [&](const MeasurementRow& row, double /*scale*/) -> Read<void> {
                                  identification.score(row);
                                  return {};
                                });
  if (!scored) return std::unexpected(scored.error());
  found.validation = identification.validation();
  return found;
}

Read<Found> identified_by_refinement(IdentificationRun& identification,
                                     const FurtherUnknowns& further) {
  auto refined = identification.finish_refined(further);
  if (!refined) return std::unexpected(refined.error());
  const auto validation = refined->second.cross_validation;
  return Found{.identified = std::move(refined->first),
               .refinement = std::move(refined->second),
               .validation = validation};
}

// What the command line says.
struct Asked {
  FurtherUnknowns further;
  ArmDescription arm;
  OpenRows rows;

  [[nodiscard]] const std::optional<SensorDescription>& sensor() const { return rows.sensor; }
  [[nodiscard]] std::size_t receivers() const {
    return rows.sensor ? rows.sensor->receivers_S.size() : 0;
  }
};

Read<Asked> read_asked(const IdentifyOptions& options) {
  const RowSource& source = options.rows;
  if (auto apart = check_roles({{"--arm", options.arm},
                                {"--measurements", source.measurements},
                                {"--sensor", source.sensor}},
                               {{"--out", options.out}});
      !apart) {
    return std::unexpected(std::move(apart).error());
  }
  if (auto serial = check_option_text("--serial", options.serial); !serial) {
    return std::unexpected(std::move(serial).error());
  }
  ARMSIG_TRY(further, parse_corrections(options.correct, options.method, !source.sensor.empty()));
  ARMSIG_TRY(arm, read_arm(options.arm));
  ARMSIG_TRY(rows, open_rows(source, arm.arm, {types_of(arm.arm.joints), arm.joint_names}));
  if (rows.sensor && further.receiver_offsets) rows.sensor->unknown_offset_m = kUnknownOffset_m;
  return Asked{.further = further, .arm = std::move(arm), .rows = std::move(rows)};
}

// Whether the method fits it; all rows are evidence for and against the result.
bool is_fitted(const IdentifyOptions& options, const MeasurementRow& row) {
  return options.method == "refined" || row.sweep > 0;
}

// What decides the result beside the rows.
std::string fit_options(const IdentifyOptions& options) {
  std::string words = "--method " + options.method;
  if (!options.correct.empty()) {
    words += fmt::format(" --correct {}", fmt::join(options.correct, ","));
  }
  if (options.accept_different_arm) words += " --accept-different-arm";
  return words;
}

Origin fitted_origin(const IdentifyOptions& options, const OpenRows& rows, const RowsRead& read,
                     std::vector<std::uint64_t> fitted) {
  Origin origin = origin_of(rows, read, std::move(fitted));
  origin.arm = shown(options.arm);
  origin.options = fit_options(options);
  return origin;
}

Problem with_copies(Problem problem, std::size_t copies) {
  if (copies > 0) {
    problem.what += fmt::format("; {} rows are copies of others, and count once", copies);
  }
  return problem;
}

// What the rows give, and what they say of themselves.
struct FromRows {
  Found found;
  Evidence evidence;
  std::size_t copies = 0;
  Origin origin;
  RangeHealth health;
};

Attempt<FromRows> find(const IdentifyOptions& options, const Asked& asked) {
  const Arm& arm = asked.arm.arm;
  const std::string& file = options.rows.measurements;
  const bool refine = options.method == "refined";
  IdentificationRun identification(
      arm, asked.sensor(), file,
      options.method == "paper" ? features::Method::kPaper : features::Method::kEncoder,
      refine ? Purpose::kRefinement : Purpose::kValidatedFeatures);
  EvidenceCollector collector(arm, asked.sensor());
  RangeHealth health(asked.sensor());
  std::vector<std::uint64_t> fitted;
  Read<void> taken;  // the first row that was refused says why; the others are evidence
  const auto read = read_rows(asked.rows, reading_of(options, "Reading measurements"),
                              [&](const MeasurementRow& row, double scale) -> Read<void> {
                                const auto hash = row_hash(row, asked.rows.types);
                                if (hash && is_fitted(options, row)) fitted.push_back(*hash);
                                collector.add(row);
                                health.add(row, scale);
                                if (taken) taken = identification.take(row);
                                return {};
                              });
  if (!read && taken) return std::unexpected(read.error());
  // A scale that is asked for is found from ranges that do not meet.
  if (read && !asked.further.scale) {
    if (auto ranges = health.contradiction(file)) return no_answer(std::move(*ranges));
  }
  Read<Found> found = !taken   ? std::unexpected(taken.error())
                      : refine ? identified_by_refinement(identification, asked.further)
                               : identified_by_features(options, asked.rows, identification);
  const std::size_t copies = read ? read->copies : 0;
  if (found) {
    return FromRows{std::move(*found), collector.evidence(), copies,
                    fitted_origin(options, asked.rows, *read, std::move(fitted)),
                    std::move(health)};
  }
  // Of rows without a position nothing else can be said.
  if (auto ranges = health.problem(file)) return no_answer(std::move(*ranges));
  return no_answer(with_copies(
      explained(std::move(found).error(), collector.evidence(), asked.arm.limits), copies));
}

// What is warned of whatever the arm is like.
void warn_of_rows(const IdentifyOptions& options, FromRows& rows, SignatureRecord& record) {
  Found& found = rows.found;
  if (const auto slide = doubt_of_slide(record.signature); slide && !found.scale_stated) {
    warn_of(*slide, fmt::format("{}: {}", slide->what, slide->expected), record, found);
  }
  if (const auto drift = rows.health.drift(); drift && !found.scale_stated) {
    warn_of({.what = drift->in_words(),
             .cause = {},
             .expected = kCureOfDrift,
             .refuses = false,
             .probability = 1,
             .lengths_factor = 1 + drift->excess(drift->last_line)},
            fmt::format("{}; {}", drift->in_words(), kCureOfDrift), record, found);
  }
  if (rows.copies > 0) {
    record.warnings.push_back(
        fmt::format("{}: {} rows are copies of others to the last digit, and count once",
                    options.rows.measurements, rows.copies));
  }
}

// The record, with its doubts as warnings.
Attempt<SignatureRecord> record_for(const IdentifyOptions& options, const Asked& asked,
                                    FromRows& rows) {
  Found& found = rows.found;
  SignatureRecord record = record_of(found.identified, asked.arm, options.method, options.serial);
  record.origin = rows.origin;
  const Evidence evidence =
      found.refinement ? undone(rows.evidence, *found.refinement, asked.sensor()) : rows.evidence;
  // What is stated, over what the method itself predicts.
  const double enlarged =
      found.refinement ? add_refinement(record, *found.refinement, asked.receivers(), evidence)
                       : add_features(record, found.validation, evidence);
  const auto doubt = doubt_of(evidence, asked.arm.limits, record, enlarged,
                              found.refinement ? &*found.refinement : nullptr);
  // Ranges to receivers at known places tell how long a millimetre is.
  const bool ruled_out = doubt && !doubt->refuses && doubt->lengths_factor != 1 &&
                         rows.health.rules_out(doubt->lengths_factor);
  if (doubt && !ruled_out) {
    const Problem problem = problem_of(*doubt, options.rows.measurements);
    if (doubt->refuses && !options.accept_different_arm) return no_answer(problem);
    warn_of(*doubt,
            doubt->refuses ? "accepted as a different arm: " + problem.what
                           : fmt::format("{}: {}", problem.what, problem.expected),
            record, found);
  }
  warn_of_rows(options, rows, record);
  return record;
}

// The page of what was found; nothing where it, or what it was found from, cannot be read again.
void say_how_to_report(const IdentifyOptions& options) {
  if (!is_there_to_read(options.out) || !is_there_to_read(options.rows.measurements)) return;
  TypedCommand report("report");
  report.file_option("--signature", options.out);
  say_next(add_rows(report, options.rows).option("--out", "report.html"));
}

Attempt<ExitStatus> run(const IdentifyOptions& options) {
  if (!options.instrument.empty()) return identify_by_places(options);
  ARMSIG_TRY(identified, identify_file(options));
  for (const std::string& warning : identified.record.warnings) {
    complain("armsig: warning: {}", shown(warning));
  }
  const ReportedFiles files{options.rows.measurements, options.out};
  if (options.json) {
    print_json(json_of(identified.found, identified.record, files, identified.receivers));
  } else {
    print_identified(identified.found, identified.record, files, identified.receivers);
    const auto& refined = identified.found.refinement;
    if (options.explain) print_models_tried(refined ? &*refined : nullptr);
    say_how_to_report(options);
  }
  return kDone;
}

}  // namespace

Attempt<IdentifiedFile> identify_file(IdentifyOptions options) {
  ARMSIG_TRY(asked, read_asked(options));
  ARMSIG_TRY(why, choose_method(options, asked.rows));
  ARMSIG_TRY(rows, find(options, asked));
  rows.found.why_method = std::move(why);
  ARMSIG_TRY(record, record_for(options, asked, rows));
  if (auto written = write_signature_file(options.out, record); !written) {
    return std::unexpected(std::move(written).error());
  }
  return IdentifiedFile{
      .found = std::move(rows.found), .record = std::move(record), .receivers = asked.receivers()};
}

void add_identify(CLI::App& app, int& status) {
  auto options = std::make_shared<IdentifyOptions>();
  CLI::App* command = app.add_subcommand("identify", "find the arm signature from measured sweeps");
  command
      ->add_option("--arm", options->arm,
                   "arm description (YAML), or a name that `armsig arms` lists: the nominal model")
      ->required();
  add_measurement_options(*command, options->rows, "sweeps (CSV)")->required();
  command
      ->add_option(
          "--method", options->method,
          "auto: refined where there are free poses (sweep 0), else encoder; encoder: circles "
          "follow the joint reading; paper: plane and centre of rotation alone; refined: maximum "
          "likelihood over all rows, those with sweep 0 too")
      ->transform(CLI::IsMember({kBestMethod, "encoder", "paper", "refined"}, CLI::ignore_case))
      ->capture_default_str();
  command
      ->add_option(
          "--correct", options->correct,
          "find as well, with --method refined: gain, first-order, second-order (errors "
          "of every joint reading: proportional, once a turn, twice a turn), "
          "readings-that-help (those of the three by which validation rows are predicted "
          "better), range-offsets (of each receiver), scale (of all lengths); none: no errors of "
          "readings even where the rows need them, as for exports that cannot hold them")
      ->delimiter(',')
      ->transform(CLI::IsMember({"gain", "first-order", "second-order", "readings-that-help",
                                 "range-offsets", "scale", "none"},
                                CLI::ignore_case));
  command->add_option("--instrument", options->instrument,
                      "instrument description (YAML), where the rows are touches of sockets and "
                      "planes or lengths of wires, a place by its name, and no positions");
  command->add_option("--serial", options->serial, "serial number of the arm, for the record");
  command->add_option("-o,--out", options->out, "signature file to write (YAML)")->required();
  command->add_flag("--accept-different-arm", options->accept_different_arm,
                    "write the signature of an arm that is far from its nominal model, or that the "
                    "measurements contradict, all the same; the record keeps a warning");
  command->add_flag("--explain", options->explain,
                    "list the models that were tried, and how each predicts validation rows");
  add_common(*command, *options);
  command->callback([options, &status] { status = status_of(run(*options), *options); });
}

}  // namespace armsig::tool
