// SPDX-License-Identifier: MIT
// armsig check: is the arm still the one that was identified?
#include <algorithm>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "core/drift/check_drift.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/measurement_options.hpp"
#include "firmware/host_tool/diagnosis/place.hpp"
#include "firmware/host_tool/diagnosis/since_then.hpp"
#include "firmware/host_tool/identification/nominal_fit.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/check_report.hpp"
#include "firmware/host_tool/reading/copied_rows.hpp"
#include "firmware/host_tool/reading/measurement_log.hpp"
#include "firmware/host_tool/reading/range_health.hpp"
#include "firmware/host_tool/reading/ranging.hpp"
#include "firmware/host_tool/reading/read_rows.hpp"
#include "firmware/library/estimate.hpp"

namespace armsig::tool {
namespace {

struct CheckOptions : CommonOptions {
  RowSource rows;
  std::string signature, arm;
};

struct RowsToJudge {
  MeasurementLog log;
  RowsRead read;
  OriginMatch match;
  std::size_t fitted = 0;  // rows left out because the signature was fitted to them
};

// No row that the signature was fitted to says whether it is right.
Read<void> check_some_left(const RowsToJudge& rows, const RowSource& source) {
  if (!rows.match.all_fitted()) return {};
  return std::unexpected(
      Problem{source.measurements, 0, 0,
              fmt::format("{} are among those that the signature was fitted to, and no check of it",
                          fitted_in_words(rows.match)),
              "poses measured since, which had no part in it"});
}

// Every row of the file but copies and those that were fitted, its ranges in metres of its own air.
Attempt<RowsToJudge> read_log(const SignatureRecord& record, const OpenRows& rows) {
  RowsToJudge result;
  RangeHealth health(rows.sensor);
  const auto& origin = record.origin;
  const auto read = read_rows(rows, {.remembered = kRememberedInMemory},
                              [&](const MeasurementRow& row, double scale) -> Read<void> {
                                const auto hash = row_hash(row, rows.types);
                                if (origin && hash && origin->has_fitted(*hash)) {
                                  ++result.fitted;
                                  return {};
                                }
                                result.log.add(row, rows.sensor, scale);
                                health.add(row, scale);
                                if (row.ranges_m.empty()) return {};
                                if (const auto position = locate(row, *rows.sensor, scale)) {
                                  result.log.add_located(position->p_S);
                                }
                                return {};
                              });
  if (!read) return std::unexpected(read.error());
  // Ranges that do not meet for another reason have outliers, which are named receiver by receiver.
  if (auto ranges = health.contradiction(rows.source.measurements); ranges && health.drift()) {
    return no_answer(std::move(*ranges));
  }
  result.read = *read;
  result.match = match_of(origin, rows, *read);
  if (const auto unknown = result.log.index_targets(record.signature.targets)) {
    return std::unexpected(Problem{rows.source.measurements, 0, 0,
                                   fmt::format("target {} is not in the signature", *unknown),
                                   "targets that it has"});
  }
  return result;
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
  std::vector<calibration::Observation> as_seen;  // the rows as they were measured
};

// Judges the rows as they are and, where that does not do, from the place where they fit best: the
// log then holds them as the sensor would have seen them from its place at the identification.
Judgement judged(const calibration::Refined& estimate, MeasurementLog& log,
                 const calibration::Receivers& receivers,
                 std::vector<calibration::RowOutcome>& outcomes) {
  const auto scratch = std::make_unique<calibration::SquareRootFactor>();
  auto& rows = log.observations();
  Judgement result{.report = drift::check_drift(estimate, rows, receivers, outcomes, *scratch),
                   .place = {},
                   .as_seen = rows};
  if (result.report && result.report->verdict == drift::DriftVerdict::kConsistent) return result;
  const auto place = fit_place(estimate, rows);
  if (!place || place->after_m > kLeftFromPlace * place->before_m) return result;
  for (calibration::Observation& row : rows) row.p_S = place->X_ON * row.p_S;
  std::vector<calibration::RowOutcome> from_there(rows.size());
  auto report = drift::check_drift(estimate, rows, receivers, from_there, *scratch);
  if (report) {
    outcomes = std::move(from_there);
    result.report = std::move(report);
    result.place = place;
  } else {
    rows = result.as_seen;
  }
  return result;
}

// Rows that something explains are no worse noise, and poses of which nothing is known are none.
void look_for_causes(const SignatureRecord& record, const calibration::Refined& estimate,
                     const Judgement& judgement,
                     const std::vector<calibration::RowOutcome>& outcomes, Checked& checked) {
  checked.since = since_then(estimate, judgement.as_seen, outcomes, judgement.place);
  if (checked.since && checked.report.verdict == drift::DriftVerdict::kSensorWorse) {
    checked.report.verdict = drift::DriftVerdict::kDrifted;
  }
  if (checked.report.verdict == drift::DriftVerdict::kSensorWorse) {
    checked.unmeasured = unmeasured_joints(record.deflections.get(), judgement.as_seen);
  }
}

Attempt<ExitStatus> run(const CheckOptions& options) {
  const std::string& file = options.rows.measurements;
  ARMSIG_TRY(record, read_signature_file(options.signature));
  ARMSIG_TRY(estimate, estimate_of(record, options.signature));
  ARMSIG_TRY(drawing, drawing_for(options, record));
  const Signature& signature = record.signature;
  ARMSIG_TRY(rows, open_rows(options.rows, record.nominal, {signature.types, record.joint_names}));
  ARMSIG_TRY(read, read_log(record, rows));
  if (auto left = check_some_left(read, options.rows); !left) return no_answer(left.error());

  MeasurementLog& log = read.log;
  std::vector<calibration::RowOutcome> outcomes(log.observations().size());
  calibration::Receivers receivers;
  if (rows.sensor) receivers = receivers_of(*rows.sensor).p_S;
  const Judgement judgement = judged(*estimate, log, receivers, outcomes);
  const auto& report = judgement.report;
  if (!report) return no_answer(problem_of(report.error(), file));

  Checked checked{.report = *report,
                  .place = judgement.place,
                  .since = {},
                  .unmeasured = {},
                  .nominal = nominal_residuals(drawing, log.observations(), log.positions(),
                                               {signature.targets.data(), signature.targets.size()},
                                               receivers, outcomes),
                  .rejected_lines = log.rejected_lines(outcomes),
                  .disbelieved = log.disbelieved_receivers(outcomes),
                  .copied = read.read.copies,
                  .fitted = read.fitted,
                  .origin_stated = read.match.stated};
  const bool healthy = report->verdict == drift::DriftVerdict::kConsistent && !judgement.place;
  if (!healthy) look_for_causes(record, *estimate, judgement, outcomes, checked);
  const ExitStatus status = healthy ? kDone : kNoAnswer;
  if (options.json) {
    print_json(json_of(checked, signature, status));
  } else {
    print_checked(checked, signature, file);
  }
  return status;
}

}  // namespace

void add_check(CLI::App& app, int& status) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command =
      app.add_subcommand("check", "is the arm still the one identified? residuals on later poses");
  command->add_option("--signature", options->signature, "signature with covariance (YAML)")
      ->required();
  add_measurement_options(*command, options->rows, "later poses (CSV)")->required();
  command->add_option("--arm", options->arm,
                      "arm description (YAML) to compare with (default: the signature's)");
  add_common(*command, *options);
  command->callback([options, &status] { status = status_of(run(*options), *options); });
}

}  // namespace armsig::tool
