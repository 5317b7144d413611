// SPDX-License-Identifier: MIT
// armsig identify: measurements to a signature.
#include <filesystem>
#include <functional>

#include "core/base/error.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/foreign_columns.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/identify_doubts.hpp"
#include "firmware/host_tool/diagnosis/collector.hpp"
#include "firmware/host_tool/identification/identification_run.hpp"
#include "firmware/host_tool/identification/undone.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/identify_report.hpp"
#include "firmware/host_tool/presentation/progress.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/reading/copied_rows.hpp"
#include "firmware/host_tool/reading/range_health.hpp"
#include "firmware/host_tool/reading/ranging.hpp"
#include "firmware/host_tool/refinement/corrections_option.hpp"
#include "firmware/host_tool/signature/doubt_stated.hpp"
#include "firmware/host_tool/signature/record.hpp"

namespace armsig::tool {
namespace {

struct IdentifyOptions : CommonOptions {
  std::string arm, measurements, columns, sensor, out, serial;
  std::string method = "encoder";
  std::vector<std::string> correct;
  bool accept_different_arm = false;
  std::optional<MappedMeasurements> mapped;  // by `columns`
};

// The file as it is, or with its columns mapped.
Read<MeasurementReader> open_measurements(const IdentifyOptions& options, const JointTypes& types) {
  if (!options.mapped) return MeasurementReader::open(options.measurements, types);
  auto reader = MeasurementReader::over(options.mapped->text, options.measurements, types);
  if (!reader) reader.error().column = 0;  // of the mapped line, not of the file's
  return reader;
}

// So many rows back a copy is found: of features, whose memory does not grow with the file, fewer.
constexpr std::size_t kRemembered = std::size_t{8} << 10U;

// Gives every row of the file but copies to `take`, and says how many copies there are.
Read<std::size_t> read_all(const IdentifyOptions& options, const Arm& arm, const char* what,
                           const std::function<Read<void>(const MeasurementRow&)>& take) {
  auto reader = open_measurements(options, types_of(arm.joints));
  if (!reader) return std::unexpected(reader.error());
  Progress progress(what, 1000);
  CopiedRows copies(options.method == "refined" ? kRememberedInMemory : kRemembered);
  for (MeasurementRow row;;) {
    auto more = reader->next(row);
    if (!more && options.mapped) more.error().column = 0;
    if (!more) return std::unexpected(more.error());
    if (!*more) return copies.count();
    if (copies.is_copy(row)) continue;
    if (auto taken = take(row); !taken) return std::unexpected(std::move(taken).error());
    if (const auto share = reader->progress()) {
      progress.update(static_cast<std::size_t>(1000 * *share));
    }
  }
}

// Of the ranges of receivers whose offsets are asked for, 1 sigma.
constexpr double kUnknownOffset_m = 5e-3;

// A file that can be read again: features are validated in a second pass.
bool is_repeatable(const std::string& path) { return std::filesystem::is_regular_file(path); }

Read<Found> identified_by_features(const IdentifyOptions& options, const Arm& arm,
                                   IdentificationRun& identification) {
  auto identified = identification.finish();
  if (!identified) return std::unexpected(identified.error());
  Found found{.identified = std::move(*identified), .refinement = {}, .validation = {}};
  if ((!options.mapped && !is_repeatable(options.measurements)) ||
      !identification.settle_validation()) {
    return found;
  }
  const auto scored =
      read_all(options, arm, "Scoring rows left out", [&](const MeasurementRow& row) -> Read<void> {
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

// As its description says, but for offsets that are asked for.
Read<std::optional<SensorDescription>> sensor_for(const IdentifyOptions& options,
                                                  const FurtherUnknowns& further) {
  if (options.sensor.empty()) return std::nullopt;
  ARMSIG_TRY(sensor, read_checked_sensor(options.sensor));
  if (further.receiver_offsets) sensor.unknown_offset_m = kUnknownOffset_m;
  return sensor;
}

// What the command line says beside the measurements.
struct Asked {
  FurtherUnknowns further;
  ArmDescription arm;
  std::optional<SensorDescription> sensor;

  [[nodiscard]] std::size_t receivers() const { return sensor ? sensor->receivers_S.size() : 0; }
};

// Maps the columns too, where they are those of other software.
Read<Asked> read_asked(IdentifyOptions& options) {
  if (auto apart = check_roles({{"--arm", options.arm},
                                {"--measurements", options.measurements},
                                {"--sensor", options.sensor}},
                               {{"--out", options.out}});
      !apart) {
    return std::unexpected(std::move(apart).error());
  }
  if (auto serial = check_option_text("--serial", options.serial); !serial) {
    return std::unexpected(std::move(serial).error());
  }
  ARMSIG_TRY(further, parse_corrections(options.correct, options.method, !options.sensor.empty()));
  ARMSIG_TRY(arm, read_arm(options.arm));
  if (!options.columns.empty()) {
    ARMSIG_TRY(mapped,
               map_measurements(options.measurements, options.columns, types_of(arm.arm.joints)));
    say(stderr, "{}", in_words(mapped));
    options.mapped = std::move(mapped);
  }
  ARMSIG_TRY(sensor, sensor_for(options, further));
  return Asked{.further = further, .arm = std::move(arm), .sensor = std::move(sensor)};
}

// What the rows give, and what they say of themselves.
struct FromRows {
  Found found;
  Evidence evidence;
  std::size_t copies = 0;
};

Attempt<FromRows> find(const IdentifyOptions& options, const Asked& asked) {
  const Arm& arm = asked.arm.arm;
  const bool refine = options.method == "refined";
  IdentificationRun identification(
      arm, asked.sensor, options.measurements,
      options.method == "paper" ? features::Method::kPaper : features::Method::kEncoder,
      refine ? Purpose::kRefinement : Purpose::kValidatedFeatures);
  EvidenceCollector collector(arm, asked.sensor);
  RangeHealth health(asked.sensor);
  Read<void> taken;  // the first row that was refused says why; the others are evidence
  const auto read =
      read_all(options, arm, "Reading measurements", [&](const MeasurementRow& row) -> Read<void> {
        ARMSIG_TRY(scale, range_scale(row, asked.sensor, options.measurements));
        collector.add(row);
        health.add(row, scale);
        if (taken) taken = identification.take(row);
        return {};
      });
  if (!read && taken) return std::unexpected(read.error());
  const auto identified = [&] {
    return refine ? identified_by_refinement(identification, asked.further)
                  : identified_by_features(options, arm, identification);
  };
  Read<Found> found = taken ? identified() : std::unexpected(taken.error());
  if (found) return FromRows{std::move(*found), collector.evidence(), *read};
  // Of rows without a position nothing else can be said.
  if (auto ranges = health.problem(options.measurements)) return no_answer(std::move(*ranges));
  Problem said = explained(std::move(found).error(), collector.evidence(), asked.arm.limits);
  if (read && *read > 0) {
    said.what += fmt::format("; {} rows are copies of others, and count once", *read);
  }
  return no_answer(std::move(said));
}

// The record, with its doubts as warnings.
Attempt<SignatureRecord> record_for(const IdentifyOptions& options, const Asked& asked,
                                    FromRows& rows) {
  Found& found = rows.found;
  SignatureRecord record = record_of(found.identified, asked.arm, options.method, options.serial);
  const Evidence evidence =
      found.refinement ? undone(rows.evidence, *found.refinement, asked.sensor) : rows.evidence;
  // What is stated, over what the method itself predicts.
  const double enlarged =
      found.refinement ? add_refinement(record, *found.refinement, asked.receivers(), evidence)
                       : add_features(record, found.validation, evidence);
  if (const auto doubt = doubt_of(evidence, asked.arm.limits, record, enlarged)) {
    const Problem problem = problem_of(*doubt, options.measurements);
    if (doubt->refuses && !options.accept_different_arm) return no_answer(problem);
    warn_of(*doubt,
            doubt->refuses ? "accepted as a different arm: " + problem.what
                           : fmt::format("{}: {}", problem.what, problem.expected),
            record, found);
  }
  if (const auto slide = doubt_of_slide(record.signature); slide && !found.scale_stated) {
    warn_of(*slide, fmt::format("{}: {}", slide->what, slide->expected), record, found);
  }
  if (rows.copies > 0) {
    record.warnings.push_back(
        fmt::format("{}: {} rows are copies of others to the last digit, and count once",
                    options.measurements, rows.copies));
  }
  return record;
}

Attempt<ExitStatus> run(IdentifyOptions options) {
  ARMSIG_TRY(asked, read_asked(options));
  ARMSIG_TRY(rows, find(options, asked));
  ARMSIG_TRY(record, record_for(options, asked, rows));
  if (auto written = write_signature_file(options.out, record); !written) {
    return std::unexpected(std::move(written).error());
  }
  for (const std::string& warning : record.warnings) {
    complain("armsig: warning: {}", shown(warning));
  }
  const ReportedFiles files{options.measurements, options.out};
  if (options.json) {
    print_json(json_of(rows.found, record, files, asked.receivers()));
  } else {
    print_identified(rows.found, record, files, asked.receivers());
  }
  return kDone;
}

}  // namespace

void add_identify(CLI::App& app, int& status) {
  auto options = std::make_shared<IdentifyOptions>();
  CLI::App* command = app.add_subcommand("identify", "find the arm signature from measured sweeps");
  command
      ->add_option("--arm", options->arm,
                   "arm description (YAML), or a name that `armsig arms` lists: the drawing")
      ->required();
  command->add_option("--measurements", options->measurements, "sweeps (CSV)")->required();
  command
      ->add_option(
          "--method", options->method,
          "encoder: circles follow the joint reading; paper: plane and centre of rotation alone; "
          "refined: maximum likelihood over all rows, those with sweep 0 too")
      ->check(CLI::IsMember({"encoder", "paper", "refined"}))
      ->capture_default_str();
  command
      ->add_option(
          "--correct", options->correct,
          "find as well, with --method refined: gain, first-order, second-order (errors "
          "of every joint reading: proportional, once a turn, twice a turn), "
          "readings-that-help (those of the three by which rows left out are predicted "
          "better), range-offsets (of each receiver), scale (of all lengths); none: no errors of "
          "readings even where the rows need them, as for exports that cannot hold them")
      ->delimiter(',')
      ->check(CLI::IsMember({"gain", "first-order", "second-order", "readings-that-help",
                             "range-offsets", "scale", "none"}));
  command->add_option("--sensor", options->sensor,
                      "sensor description (YAML), where the rows are ranges to receivers");
  command->add_option("--columns", options->columns,
                      "measurements of other software: auto, or x_mm=THEIR NAME,target=#1,... "
                      "(semicolons, decimal commas and lines before the header are understood)");
  command->add_option("--serial", options->serial, "serial number of the arm, for the record");
  command->add_option("--out", options->out, "signature file to write (YAML)")->required();
  command->add_flag("--accept-different-arm", options->accept_different_arm,
                    "write the signature of an arm that is far from its drawing, or that the "
                    "measurements contradict, all the same; the record keeps a warning");
  add_common(*command, *options);
  command->callback([options, &status] { status = status_of(run(*options), *options); });
}

}  // namespace armsig::tool
