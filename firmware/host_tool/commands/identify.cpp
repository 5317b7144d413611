// SPDX-License-Identifier: MIT
// armsig identify: measurements to a signature.
#include <algorithm>
#include <filesystem>
#include <functional>

#include "core/base/error.hpp"
#include "core/refinement/chain.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/foreign_columns.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/diagnosis/collector.hpp"
#include "firmware/host_tool/diagnosis/gate.hpp"
#include "firmware/host_tool/identification/identification_run.hpp"
#include "firmware/host_tool/identification/undone.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/identify_report.hpp"
#include "firmware/host_tool/presentation/progress.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/reading/copied_rows.hpp"
#include "firmware/host_tool/reading/range_health.hpp"
#include "firmware/host_tool/reading/ranging.hpp"
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

// The words of --correct.
Read<FurtherUnknowns> further_unknowns(const IdentifyOptions& options) {
  FurtherUnknowns further;
  if (options.correct.empty()) return further;
  if (options.method != "refined") {
    return std::unexpected(Problem{"--correct", 0, 0, "the method is " + options.method,
                                   "--method refined, which can find corrections"});
  }
  for (const std::string& word : options.correct) {
    further.readings.gain |= word == "gain";
    further.readings.first |= word == "first-order";
    further.readings.second |= word == "second-order";
    further.choose_readings |= word == "readings-that-help";
    further.receiver_offsets |= word == "range-offsets";
    further.scale |= word == "scale";
    further.as_read |= word == "none";
  }
  if (further.as_read && options.correct.size() > 1) {
    return std::unexpected(
        Problem{"--correct", 0, 0, "none, and corrections beside it", "either of them"});
  }
  if (further.receiver_offsets && options.sensor.empty()) {
    return std::unexpected(Problem{"--correct", 0, 0, "range-offsets without receivers",
                                   "ranges, and --sensor with where the receivers stand"});
  }
  return further;
}

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

// Fewer rows than these say nothing against an arm.
constexpr std::size_t kFewestToDoubt = 12;

std::optional<Doubt> doubt_of(const Evidence& evidence, const ArmLimits& limits,
                              const SignatureRecord& record, double enlarged) {
  if (evidence.rows.size() < kFewestToDoubt) return std::nullopt;
  const refinement::PoeChain chain(record.signature, record.readings());
  const auto& targets = record.signature.targets;
  const auto predicted_S = [&](const EvidenceRow& row) -> std::optional<Vector3> {
    const auto* target = std::ranges::find(targets, row.target, &Target::number);
    if (target == targets.end()) return std::nullopt;
    return chain.point(chain.motion(row.q), *target);
  };
  return doubt(evidence, limits,
               FoundArm{.predicted_S = predicted_S,
                        .predicted_error_m = record.predicted_tool_error_m.value_or(0) / enlarged});
}

// A refusal, with the mistake that explains it where one is found.
Problem explained(Problem problem, const Evidence& evidence, const ArmLimits& limits) {
  if (evidence.rows.size() < kFewestToDoubt) return problem;
  const auto found = doubt(evidence, limits, std::nullopt);
  if (!found || found->cause.empty()) return problem;
  problem.what += "; most likely " + found->cause;
  problem.expected += (problem.expected.empty() ? "" : "; ") + found->expected;
  return problem;
}

Problem problem_of(const Doubt& doubt, const std::string& file) {
  const std::string cause = doubt.cause.empty() ? "" : "; " + doubt.cause;
  return {file, 0, 0, doubt.what + cause, doubt.expected};
}

// What the doubt leaves open is part of what is stated.
void state(const Doubt& doubt, SignatureRecord& record, Found& found) {
  const double stated_m = state_doubt(record, doubt);
  found.scale_stated = found.scale_stated || (doubt.lengths_factor != 1 && stated_m > 0);
  if (found.refinement && found.refinement->predicted_over_limits_m) {
    double& over_limits_m = *found.refinement->predicted_over_limits_m;
    over_limits_m = std::hypot(over_limits_m, stated_m);
  }
}

int run(IdentifyOptions options) {
  const auto apart = check_roles({{"--arm", options.arm},
                                  {"--measurements", options.measurements},
                                  {"--sensor", options.sensor}},
                                 {{"--out", options.out}});
  if (!apart) return fail(apart.error(), kBadInput, options);
  const auto serial = check_option_text("--serial", options.serial);
  if (!serial) return fail(serial.error(), kBadInput, options);
  const auto further = further_unknowns(options);
  if (!further) return fail(further.error(), kBadInput, options);
  const auto arm = read_arm(options.arm);
  if (!arm) return fail(arm.error(), kBadInput, options);
  if (!options.columns.empty()) {
    auto mapped =
        map_measurements(options.measurements, options.columns, types_of(arm->arm.joints));
    if (!mapped) return fail(mapped.error(), kBadInput, options);
    say(stderr, "{}", in_words(*mapped));
    options.mapped = std::move(*mapped);
  }
  std::optional<SensorDescription> sensor;
  if (!options.sensor.empty()) {
    const auto read = read_checked_sensor(options.sensor);
    if (!read) return fail(read.error(), kBadInput, options);
    sensor = *read;
    if (further->receiver_offsets) sensor->unknown_offset_m = kUnknownOffset_m;
  }

  const bool refine = options.method == "refined";
  IdentificationRun identification(
      arm->arm, sensor, options.measurements,
      options.method == "paper" ? features::Method::kPaper : features::Method::kEncoder,
      refine ? Purpose::kRefinement : Purpose::kValidatedFeatures);
  EvidenceCollector collector(arm->arm, sensor);
  RangeHealth health(sensor);
  Read<void> taken;  // the first row that was refused says why; the others are evidence
  const auto read = read_all(options, arm->arm, "Reading measurements",
                             [&](const MeasurementRow& row) -> Read<void> {
                               const auto scale = range_scale(row, sensor, options.measurements);
                               if (!scale) return std::unexpected(scale.error());
                               collector.add(row);
                               health.add(row, *scale);
                               if (taken) taken = identification.take(row);
                               return {};
                             });
  if (!read && taken) return fail(read.error(), kBadInput, options);
  const auto refuse = [&](const Problem& problem) {
    // Of rows without a position nothing else can be said.
    if (const auto ranges = health.problem(options.measurements)) {
      return fail(*ranges, kNoAnswer, options);
    }
    Problem said = explained(problem, collector.evidence(), arm->limits);
    if (read && *read > 0)
      said.what += fmt::format("; {} rows are copies of others, and count once", *read);
    return fail(said, kNoAnswer, options);
  };
  if (!taken) return refuse(taken.error());
  auto found = refine ? identified_by_refinement(identification, *further)
                      : identified_by_features(options, arm->arm, identification);
  if (!found) return refuse(found.error());

  SignatureRecord record = record_of(found->identified, *arm, options.method, options.serial);
  const std::size_t receivers = sensor ? sensor->receivers_S.size() : 0;
  const Evidence evidence =
      refine ? undone(collector.evidence(), *found->refinement, sensor) : collector.evidence();
  double enlarged = 1;  // what is stated, over what the method itself predicts
  if (refine) {
    enlarged = add_refinement(record, *found->refinement, receivers, evidence);
  } else {
    enlarged = add_features(record, found->validation, evidence);
  }
  const auto doubt = doubt_of(evidence, arm->limits, record, enlarged);
  if (doubt) {
    const Problem problem = problem_of(*doubt, options.measurements);
    if (doubt->refuses && !options.accept_different_arm) return fail(problem, kNoAnswer, options);
    record.warnings.push_back(doubt->refuses
                                  ? "accepted as a different arm: " + problem.what
                                  : fmt::format("{}: {}", problem.what, problem.expected));
    state(*doubt, record, *found);
  }
  if (const auto slide = doubt_of_slide(record.signature); slide && !found->scale_stated) {
    record.warnings.push_back(fmt::format("{}: {}", slide->what, slide->expected));
    state(*slide, record, *found);
  }
  if (*read > 0) {
    record.warnings.push_back(
        fmt::format("{}: {} rows are copies of others to the last digit, and count once",
                    options.measurements, *read));
  }
  const auto written = write_signature_file(options.out, record);
  if (!written) return fail(written.error(), kBadInput, options);
  for (const std::string& warning : record.warnings) {
    complain("armsig: warning: {}", shown(warning));
  }
  const ReportedFiles files{options.measurements, options.out};
  if (options.json) {
    print_json(json_of(*found, record, files, receivers));
  } else {
    print_identified(*found, record, files, receivers);
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
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace armsig::tool
