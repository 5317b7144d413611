// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/certificate_json.hpp"

namespace armsig::tool {
namespace {

using CertificateJson = nlohmann::ordered_json;

CertificateJson known_or_null(const std::optional<double>& value) {
  return value ? CertificateJson(*value) : CertificateJson(nullptr);
}

// The signature's checksum, without 0x: with another signature it is another number.
std::string number_of(const ReportInput& input) {
  return input.names.number.empty() ? input.signature.crc32.substr(2) : input.names.number;
}

CertificateJson names_json(const ReportInput& input) {
  const CertificateNames& names = input.names;
  return {{"number", number_of(input)},
          {"number_is_stated", !names.number.empty()},
          {"laboratory", names.laboratory},
          {"customer", names.customer},
          {"place", names.place},
          {"measured_on", names.measured_on},
          {"conditions", names.conditions},
          {"serial", input.record.serial.empty() ? names.serial : input.record.serial},
          {"operator", names.operator_name},
          {"instrument", names.instrument},
          {"instrument_serial", names.instrument_serial},
          {"instrument_certificate", names.instrument_certificate}};
}

CertificateJson expanded_json(const ExpandedUncertainty& expanded) {
  return {{"length_m", expanded.length_m},
          {"probability", expanded.probability},
          {"factor", expanded.factor},
          {"factor_per_axis", expanded.factor_per_axis},
          {"probability_at_2", expanded.probability_at_2},
          {"freedom", expanded.freedom}};
}

}  // namespace

nlohmann::ordered_json certificate_json(const ReportInput& input,
                                        const std::vector<SweepPicture>& sweeps,
                                        const std::optional<ToolErrorMap>& map,
                                        const std::optional<PoseResiduals>& poses) {
  CertificateJson json = names_json(input);
  json["adjustment"] = CertificateJson::array();
  for (const AdjustmentLine& line : before_and_after(input.record, map, poses)) {
    json["adjustment"].push_back({{"parameters", line.parameters},
                                  {"basis", line.basis},
                                  {"mean_m", known_or_null(line.mean_m)},
                                  {"rms_m", line.rms_m},
                                  {"largest_m", known_or_null(line.largest_m)}});
  }
  const UncertaintyBudget budget = uncertainty_budget(input.record, map);
  json["sources"] = CertificateJson::array();
  for (const UncertaintySource& source : budget.sources) {
    json["sources"].push_back({{"source", source.source},
                               {"basis", source.basis},
                               {"sigma_m", known_or_null(source.sigma_m)}});
  }
  json["combined_m"] = known_or_null(budget.combined_m);
  json["expanded"] = budget.expanded ? expanded_json(*budget.expanded) : CertificateJson(nullptr);
  json["over"] = map ? map->over : "";
  json["accuracy"] = accuracy_in_words(input.record);
  json["not_measured"] = not_measured(
      input.record, sweeps,
      input.measured ? input.measured->mixed_reach : FixedVector<JointLimits, kMaxJoints>());
  return json;
}

}  // namespace armsig::tool
