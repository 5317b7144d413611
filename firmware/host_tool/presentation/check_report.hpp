// SPDX-License-Identifier: MIT
// What `armsig check` says of an arm.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "firmware/drift/check_drift.hpp"
#include "firmware/host_tool/diagnosis/place.hpp"
#include "firmware/host_tool/identification/nominal_fit.hpp"
#include "firmware/host_tool/reading/measurement_log.hpp"

namespace armsig::tool {

struct Checked {
  drift::DriftReport report;   // with the sensor where `place` puts it
  std::optional<Place> place;  // where that is another one than at the identification
  std::optional<ResidualSummary> nominal;
  std::vector<std::size_t> rejected_lines;
  std::vector<DisbelievedReceiver> disbelieved;
  std::size_t copied = 0;  // rows that are copies of others
};

// `joints`: how many the arm has.
void print_checked(const Checked& checked, std::size_t joints, const std::string& measurements);
[[nodiscard]] nlohmann::ordered_json json_of(const Checked& checked, int status);

}  // namespace armsig::tool
