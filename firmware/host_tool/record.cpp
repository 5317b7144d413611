// SPDX-License-Identifier: MIT
#include "firmware/host_tool/record.hpp"

#include <ctime>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

std::string now_utc() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace

SignatureRecord record_of(const Identified& identified, const ArmDescription& arm,
                          const std::string& method, const std::string& serial) {
  SignatureRecord record;
  record.signature = identified.signature;
  record.arm_name = arm.name;
  record.serial = serial;
  record.method = method;
  record.nominal = arm.arm;
  record.air_c = identified.air_celsius;
  record.time = now_utc();
  record.version = ARMSIG_VERSION;
  record.warnings = identified.warnings;
  return record;
}

void add_uncertainty(SignatureRecord& record, const RefinementOutcome& outcome) {
  record.covariance = covariance_of(*outcome.refined);
  record.covariance_of =
      "axis lines in their link frames (direction x, y; position x, y of a revolute joint), joint "
      "by "
      "joint, then target points; rad and m";
  record.sigma_m = outcome.refined->quality.sigma_m;
  record.predicted_tool_error_m = outcome.predicted_tool_error_m;
}

SignatureRecord exact_record(const Signature& signature, const ArmDescription& arm) {
  SignatureRecord record;
  record.signature = signature;
  record.arm_name = arm.name;
  record.method = "exact";
  record.nominal = arm.arm;
  record.time = now_utc();
  record.version = ARMSIG_VERSION;
  return record;
}

Read<SensorDescription> read_checked_sensor(const std::string& path) {
  auto sensor = read_sensor_file(path);
  if (!sensor) return sensor;
  const auto usable = measurement::check(receivers_of(*sensor));
  if (!usable) {
    return std::unexpected(Problem{path, 0, 0, std::string(describe(usable.error())),
                                   remedy_in_words(usable.error())});
  }
  return sensor;
}

}  // namespace armsig::tool
