// SPDX-License-Identifier: MIT
// armsig check: is the arm still the one that was identified?
#include <algorithm>

#include <fmt/core.h>

#include "firmware/drift/check_drift.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/diagnosis/place.hpp"
#include "firmware/host_tool/identification/nominal_fit.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/reading/copied_rows.hpp"
#include "firmware/host_tool/reading/measurement_log.hpp"
#include "firmware/host_tool/reading/ranging.hpp"
#include "firmware/host_tool/signature/estimate.hpp"
#include "firmware/host_tool/signature/record.hpp"

namespace armsig::tool {
namespace {

struct CheckOptions : CommonOptions {
  std::string signature, measurements, sensor, arm;
};

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

struct Checked {
  drift::DriftReport report;   // with the sensor where `place` puts it
  std::optional<Place> place;  // where that is another one than at the identification
  std::optional<ResidualSummary> nominal;
  std::vector<std::size_t> rejected_lines;
  std::vector<DisbelievedReceiver> disbelieved;
  std::size_t copied = 0;  // rows that are copies of others
};

// No sensor is so bad: what is wrong is a unit, a column, or the arm.
constexpr double kNoNoise = 300;

void print_residuals(const char* of, double rms_m, double mean_m, double largest_m) {
  say("  {:<37} {:6.3f} mm RMS, {:.3f} mean, {:.3f} at most\n", of, 1e3 * rms_m, 1e3 * mean_m,
      1e3 * largest_m);
}

std::string_view next_step(const Checked& checked) {
  if (checked.place) return "identify from there, or put the sensor back";
  switch (checked.report.verdict) {
    case drift::DriftVerdict::kConsistent:
      if (!checked.disbelieved.empty()) return "look after the receiver named";
      return "nothing; check again after a collision, a repair, or a season";
    case drift::DriftVerdict::kSensorWorse:
      if (checked.report.noise_factor > kNoNoise) {
        return "look at the units and columns of the measurements, and whose arm they are of";
      }
      return "measure one pose ten times. Where it scatters more than is stated, look after\n"
             "the sensor: targets, air, its own check. Where it does not, identify with these\n"
             "poses too, --method refined";
    default:
      return "sweep the joints again and armsig identify";
  }
}

void print_for_a_person(const Checked& checked, std::size_t joints,
                        const std::string& measurements) {
  const drift::DriftReport& report = checked.report;
  if (checked.place) {
    say("{}: measured from another place: {:.1f} mm, {:.2f}°; from there {}\n\n", measurements,
        1e3 * checked.place->shift_m, degrees(checked.place->turn_rad),
        drift::describe(report.verdict));
  } else {
    say("{}: {}\n\n", measurements, drift::describe(report.verdict));
  }
  if (report.verdict == drift::DriftVerdict::kDrifted) {
    say("  most likely {}\n", what_moved(report, joints));
  }
  if (report.verdict == drift::DriftVerdict::kSensorWorse) {
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
  say("  {} rows, {} of them outliers\n", report.rows + report.rows_rejected, report.rows_rejected);
  if (checked.copied > 0) {
    say("  {} rows are copies of others, and count once\n", checked.copied);
  }
  if (!checked.rejected_lines.empty()) {
    say("  outliers, by line: {}\n", lines_in_words(checked.rejected_lines));
  }
  for (const DisbelievedReceiver& receiver : checked.disbelieved) {
    say("  receiver {}: {} of its {} ranges are outliers: it is not where the\n"
        "  sensor description has it, or hears something else\n",
        receiver.number, receiver.rejected, receiver.ranges);
  }
  if (checked.nominal) {
    const ResidualSummary& nominal = *checked.nominal;
    print_residuals("before: drawing, base and tool fitted", nominal.rms_m, nominal.mean_m,
                    nominal.largest_m);
  } else {
    say("  before: these rows are too few to fit base and tool to the drawing\n");
  }
  print_residuals(
      checked.place ? "after: the signature, from that place" : "after: the signature as it is",
      report.rms_m, report.mean_m, report.largest_m);
  say("  chi-square {:.1f} with {} degrees of freedom; healthy arms stay below {:.1f}\n",
      report.chi_square, report.freedom, report.allowed);
  say("\nNext: {}\n", next_step(checked));
}

nlohmann::ordered_json json_of(const Checked& checked, int status) {
  const drift::DriftReport& report = checked.report;
  nlohmann::ordered_json json{
      {"status", status},
      {"verdict", checked.place ? "another-place" : verdict_word(report.verdict)},
      {"link", report.link},
      {"noise_factor", report.noise_factor},
      {"chi_square", report.chi_square},
      {"degrees_of_freedom", report.freedom},
      {"allowed", report.allowed},
      {"rows", report.rows},
      {"rows_rejected", report.rows_rejected},
      {"rows_copied", checked.copied},
      {"rejected_lines", checked.rejected_lines},
      {"rms_m", report.rms_m},
      {"mean_m", report.mean_m},
      {"largest_m", report.largest_m}};
  json["receivers_rejected"] = nlohmann::ordered_json::array();
  for (const DisbelievedReceiver& receiver : checked.disbelieved) {
    json["receivers_rejected"].push_back({{"receiver", receiver.number},
                                          {"rejected", receiver.rejected},
                                          {"ranges", receiver.ranges}});
  }
  if (checked.place) {
    json["place"] = {{"shift_m", checked.place->shift_m},
                     {"turn_rad", checked.place->turn_rad},
                     {"verdict_from_there", verdict_word(report.verdict)}};
  }
  if (checked.nominal) {
    json["nominal"] = {{"rms_m", checked.nominal->rms_m},
                       {"mean_m", checked.nominal->mean_m},
                       {"largest_m", checked.nominal->largest_m}};
  }
  return json;
}

// Every row of the file but copies, its ranges in metres of its own air.
Read<MeasurementLog> read_log(const CheckOptions& options, const Signature& signature,
                              const std::optional<SensorDescription>& sensor, CopiedRows& copies) {
  MeasurementLog log;
  const auto rows = read_measurements(
      options.measurements, signature.types, [&](const MeasurementRow& row) -> Read<void> {
        const auto scale = range_scale(row, sensor, options.measurements);
        if (!scale) return std::unexpected(scale.error());
        if (copies.is_copy(row)) return {};
        log.add(row, sensor, *scale);
        if (row.ranges_m.empty()) return {};
        if (const auto position = locate(row, *sensor, *scale)) log.add_located(position->p_S);
        return {};
      });
  if (!rows) return std::unexpected(rows.error());
  if (const auto unknown = log.index_targets(signature.targets)) {
    return std::unexpected(Problem{options.measurements, 0, 0,
                                   fmt::format("target {} is not in the signature", *unknown),
                                   "targets that it has"});
  }
  return log;
}

// The drawing to compare with: the one that the signature keeps, or another one.
Read<Arm> drawing_for(const CheckOptions& options, const SignatureRecord& record) {
  if (options.arm.empty()) return record.nominal;
  const auto arm = read_arm(options.arm);
  if (!arm) return std::unexpected(arm.error());
  if (!std::ranges::equal(types_of(arm->arm.joints), record.signature.types)) {
    return std::unexpected(Problem{options.arm, 0, 0, "its joints are not those of the signature",
                                   "an arm with the same joint types"});
  }
  return arm->arm;
}

Problem problem_of(const Refusal& refusal, const std::string& file) {
  if (refusal.error == Error::kTooManyOutliers) {
    return {file, 0, 0,
            fmt::format("{:.0f} rows are far from what the signature predicts, at most {:.0f} may",
                        refusal.found, refusal.needed),
            "poses of the arm that was identified, seen from where the sensor stood"};
  }
  return {file, 0, 0, std::string(describe(refusal.error)),
          "measured poses of a target of the signature"};
}

// A place of the sensor that leaves less than this of the residuals is another place.
constexpr double kLeftFromPlace = 1.0 / 3;

struct Judgement {
  Judged<drift::DriftReport> report;
  std::optional<Place> place;
};

// Judges the rows as they are and, where that does not do, from the place where they fit best: the
// log then holds them as the sensor would have seen them from its place at the identification.
Judgement judged(const refinement::Refined& estimate, MeasurementLog& log,
                 const refinement::Receivers& receivers,
                 std::vector<refinement::RowOutcome>& outcomes) {
  const auto scratch = std::make_unique<refinement::SquareRootFactor>();
  auto& rows = log.observations();
  Judgement result{.report = drift::check_drift(estimate, rows, receivers, outcomes, *scratch),
                   .place = {}};
  if (result.report && result.report->verdict == drift::DriftVerdict::kConsistent) return result;
  const auto place = fit_place(estimate, rows);
  if (!place || place->after_m > kLeftFromPlace * place->before_m) return result;
  const auto as_seen = rows;
  for (refinement::Observation& row : rows) row.p_S = place->X_ON * row.p_S;
  std::vector<refinement::RowOutcome> from_there(rows.size());
  auto report = drift::check_drift(estimate, rows, receivers, from_there, *scratch);
  if (report) {
    outcomes = std::move(from_there);
    return {.report = std::move(report), .place = place};
  }
  rows = as_seen;
  return result;
}

int run(const CheckOptions& options) {
  const auto record = read_signature_file(options.signature);
  if (!record) return fail(record.error(), kBadInput, options);
  const auto estimate = estimate_of(*record, options.signature);
  if (!estimate) return fail(estimate.error(), kBadInput, options);
  const auto drawing = drawing_for(options, *record);
  if (!drawing) return fail(drawing.error(), kBadInput, options);
  std::optional<SensorDescription> sensor;
  if (!options.sensor.empty()) {
    const auto read = read_checked_sensor(options.sensor);
    if (!read) return fail(read.error(), kBadInput, options);
    sensor = *read;
  }
  const Signature& signature = record->signature;
  CopiedRows copies(kRememberedInMemory);
  auto log = read_log(options, signature, sensor, copies);
  if (!log) return fail(log.error(), kBadInput, options);

  std::vector<refinement::RowOutcome> outcomes(log->observations().size());
  refinement::Receivers receivers;
  if (sensor) receivers = receivers_of(*sensor).p_S;
  Judgement judgement = judged(**estimate, *log, receivers, outcomes);
  const auto& report = judgement.report;
  if (!report) return fail(problem_of(report.error(), options.measurements), kNoAnswer, options);

  Checked checked{.report = *report,
                  .place = judgement.place,
                  .nominal = nominal_residuals(*drawing, log->observations(), log->positions(),
                                               {signature.targets.data(), signature.targets.size()},
                                               receivers, outcomes),
                  .rejected_lines = log->rejected_lines(outcomes),
                  .disbelieved = log->disbelieved_receivers(outcomes),
                  .copied = copies.count()};
  const bool healthy = report->verdict == drift::DriftVerdict::kConsistent && !judgement.place;
  const int status = healthy ? kDone : kNoAnswer;
  if (options.json) {
    print_json(json_of(checked, status));
  } else {
    print_for_a_person(checked, signature.joint_count(), options.measurements);
  }
  return status;
}

}  // namespace

void add_check(CLI::App& app, int& status) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app.add_subcommand(
      "check", "is the arm still the one identified? residuals on held-out poses");
  command->add_option("--signature", options->signature, "signature with covariance (YAML)")
      ->required();
  command->add_option("--measurements", options->measurements, "held-out poses (CSV)")->required();
  command->add_option("--arm", options->arm,
                      "arm description (YAML) to compare with (default: the signature's)");
  command->add_option("--sensor", options->sensor,
                      "sensor description (YAML), where the rows are ranges to receivers");
  add_common(*command, *options);
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace armsig::tool
