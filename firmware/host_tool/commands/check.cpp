// SPDX-License-Identifier: MIT
// armsig check: is the arm still the one that was identified?
#include <fmt/core.h>

#include "core/uncertainty/drift.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/estimate.hpp"
#include "firmware/host_tool/formats/signature_file.hpp"
#include "firmware/host_tool/measurement_log.hpp"
#include "firmware/host_tool/record.hpp"

namespace armsig::tool {
namespace {

struct Options : CommonOptions {
  std::string signature, measurements, sensor;
};

std::string what_moved(const uncertainty::DriftReport& report, std::size_t joints) {
  if (report.link == 0) return "the base has moved against the sensor";
  if (report.link == joints) {
    return fmt::format("link {} with its target, or the zero of joint {}, has moved", joints,
                       joints);
  }
  return fmt::format("link {}, or the zero of joint {} or {}, has moved", report.link, report.link,
                     report.link + 1);
}

const char* word_of(uncertainty::Verdict verdict) {
  switch (verdict) {
    case uncertainty::Verdict::kConsistent:
      return "consistent";
    case uncertainty::Verdict::kDrifted:
      return "drifted";
    case uncertainty::Verdict::kSensorWorse:
      return "sensor-worse";
  }
  return "consistent";
}

void print_for_a_person(const uncertainty::DriftReport& report, std::size_t joints,
                        const std::string& measurements) {
  fmt::print("{}: {}\n\n", measurements, uncertainty::describe(report.verdict));
  if (report.verdict == uncertainty::Verdict::kDrifted) {
    fmt::print("  most likely {}\n", what_moved(report, joints));
  }
  if (report.verdict == uncertainty::Verdict::kSensorWorse) {
    fmt::print("  the noise is {:.1f} times the one stated\n", report.noise_factor);
  }
  fmt::print("  {} rows, {} of them outliers\n", report.rows + report.rows_rejected,
             report.rows_rejected);
  fmt::print("  residuals: {:.3f} mm RMS, {:.3f} mm mean, {:.3f} mm at most\n", 1e3 * report.rms_m,
             1e3 * report.mean_m, 1e3 * report.largest_m);
  fmt::print("  chi-square {:.1f} with {} degrees of freedom; healthy arms stay below {:.1f}\n",
             report.chi_square, report.freedom, report.allowed);
}

int run(const Options& options) {
  const auto record = read_signature_file(options.signature);
  if (!record) return fail(record.error(), kBadInput, options);
  const auto estimate = estimate_of(*record, options.signature);
  if (!estimate) return fail(estimate.error(), kBadInput, options);
  std::optional<SensorDescription> sensor;
  if (!options.sensor.empty()) {
    const auto read = read_checked_sensor(options.sensor);
    if (!read) return fail(read.error(), kBadInput, options);
    sensor = *read;
  }
  MeasurementLog log;
  const auto rows = read_measurements(options.measurements, record->signature.types,
                                      [&](const MeasurementRow& row) -> Read<void> {
                                        log.add(row, sensor, 1.0);
                                        return {};
                                      });
  if (!rows) return fail(rows.error(), kBadInput, options);
  if (const auto unknown = log.index_targets(record->signature.targets)) {
    return fail({options.measurements, 0, 0,
                 fmt::format("target {} is not in the signature", *unknown), "targets that it has"},
                kBadInput, options);
  }

  std::vector<refinement::RowOutcome> outcomes(log.observations().size());
  const auto scratch = std::make_unique<refinement::SquareRootFactor>();
  refinement::Receivers receivers;
  if (sensor) {
    for (const Vector3& p_S : sensor->receivers_S) {
      if (!receivers.full()) receivers.push_back(p_S);
    }
  }
  const auto report =
      uncertainty::check_drift(**estimate, log.observations(), receivers, outcomes, *scratch);
  if (!report) {
    return fail({options.measurements, 0, 0, std::string(describe(report.error().error)),
                 "measured poses of a target of the signature"},
                kNoAnswer, options);
  }
  const int status = report->verdict == uncertainty::Verdict::kConsistent ? kDone : kNoAnswer;
  if (options.json) {
    print_json({{"status", status},
                {"verdict", word_of(report->verdict)},
                {"link", report->link},
                {"noise_factor", report->noise_factor},
                {"chi_square", report->chi_square},
                {"degrees_of_freedom", report->freedom},
                {"allowed", report->allowed},
                {"rows", report->rows},
                {"rows_rejected", report->rows_rejected},
                {"rms_m", report->rms_m},
                {"mean_m", report->mean_m},
                {"largest_m", report->largest_m}});
  } else {
    print_for_a_person(*report, record->signature.joint_count(), options.measurements);
  }
  return status;
}

}  // namespace

void add_check(CLI::App& app, int& status) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "check", "is the arm still the one identified? residuals on held-out poses");
  command->add_option("--signature", options->signature, "signature with covariance (YAML)")
      ->required();
  command->add_option("--measurements", options->measurements, "held-out poses (CSV)")->required();
  command->add_option("--sensor", options->sensor,
                      "sensor description (YAML), where the rows are ranges to receivers");
  add_common(*command, *options);
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace armsig::tool
