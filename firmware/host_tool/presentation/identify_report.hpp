// SPDX-License-Identifier: MIT
// What `armsig identify` says of what it has found.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/identification/identification_run.hpp"

namespace armsig::tool {

// What identification has found, whichever the method.
struct Found {
  Identified identified;
  std::optional<RefinementOutcome> refinement;
  std::optional<CrossValidation> validation;
  bool scale_stated = false;    // a scale of the sensor is part of the predicted tool error
  std::string why_method = {};  // "which ..."; empty where the method was asked for
};

struct ReportedFiles {
  std::string measurements, out;
};

// `receivers`: how many the sensor has, 0 for one that gives positions.
void print_identified(const Found& found, const SignatureRecord& record, const ReportedFiles& files,
                      std::size_t receivers);
[[nodiscard]] nlohmann::ordered_json json_of(const Found& found, const SignatureRecord& record,
                                             const ReportedFiles& files, std::size_t receivers);

}  // namespace armsig::tool
