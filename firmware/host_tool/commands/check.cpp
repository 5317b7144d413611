// SPDX-License-Identifier: MIT
// armsig check: is the arm still the one that was identified?
#include <algorithm>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/drift/check_drift.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/diagnosis/place.hpp"
#include "firmware/host_tool/identification/nominal_fit.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/check_report.hpp"
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

Read<std::optional<SensorDescription>> sensor_for(const CheckOptions& options) {
  if (options.sensor.empty()) return std::nullopt;
  return read_checked_sensor(options.sensor);
}

Attempt<ExitStatus> run(const CheckOptions& options) {
  ARMSIG_TRY(record, read_signature_file(options.signature));
  ARMSIG_TRY(estimate, estimate_of(record, options.signature));
  ARMSIG_TRY(drawing, drawing_for(options, record));
  ARMSIG_TRY(sensor, sensor_for(options));
  const Signature& signature = record.signature;
  CopiedRows copies(kRememberedInMemory);
  ARMSIG_TRY(log, read_log(options, signature, sensor, copies));

  std::vector<refinement::RowOutcome> outcomes(log.observations().size());
  refinement::Receivers receivers;
  if (sensor) receivers = receivers_of(*sensor).p_S;
  const Judgement judgement = judged(*estimate, log, receivers, outcomes);
  const auto& report = judgement.report;
  if (!report) return no_answer(problem_of(report.error(), options.measurements));

  const Checked checked{
      .report = *report,
      .place = judgement.place,
      .nominal = nominal_residuals(drawing, log.observations(), log.positions(),
                                   {signature.targets.data(), signature.targets.size()}, receivers,
                                   outcomes),
      .rejected_lines = log.rejected_lines(outcomes),
      .disbelieved = log.disbelieved_receivers(outcomes),
      .copied = copies.count()};
  const bool healthy = report->verdict == drift::DriftVerdict::kConsistent && !judgement.place;
  const ExitStatus status = healthy ? kDone : kNoAnswer;
  if (options.json) {
    print_json(json_of(checked, status));
  } else {
    print_checked(checked, signature.joint_count(), options.measurements);
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
  command->callback([options, &status] { status = status_of(run(*options), *options); });
}

}  // namespace armsig::tool
