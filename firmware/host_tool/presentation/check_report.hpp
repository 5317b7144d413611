// SPDX-License-Identifier: MIT
// What `armsig check` says of an arm.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/drift/check_drift.hpp"
#include "firmware/host_tool/diagnosis/place.hpp"
#include "firmware/host_tool/diagnosis/since_then.hpp"
#include "firmware/host_tool/diagnosis/unmeasured.hpp"
#include "firmware/host_tool/identification/nominal_fit.hpp"
#include "firmware/host_tool/reading/measurement_log.hpp"

namespace armsig::tool {

struct Checked {
  drift::DriftReport report;       // with the sensor where `place` puts it
  std::optional<Place> place;      // where that is another one than at the identification
  std::optional<SinceThen> since;  // what has happened to the arm since it was identified
  // Where only worse noise would explain the rows: joints of which the signature knows nothing.
  std::vector<UnmeasuredJoint> unmeasured;
  std::optional<ResidualSummary> nominal;
  std::vector<std::size_t> rejected_lines;
  std::vector<DisbelievedReceiver> disbelieved;
  std::size_t copied = 0;      // rows that are copies of others
  std::size_t fitted = 0;      // rows left out because the signature was fitted to them
  bool origin_stated = false;  // the signature says to which rows it was
};

void print_checked(const Checked& checked, const Signature& signature,
                   const std::string& measurements);
[[nodiscard]] nlohmann::ordered_json json_of(const Checked& checked, const Signature& signature,
                                             int status);

}  // namespace armsig::tool
