// SPDX-License-Identifier: MIT
// What `armsig identify --instrument` says of what it has found.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/places/place_run.hpp"

namespace armsig::tool {

void print_place_calibration(const PlaceCalibration& found, const SignatureRecord& record,
                             const std::string& measurements, const std::string& out);
[[nodiscard]] nlohmann::ordered_json json_of(const PlaceCalibration& found,
                                             const SignatureRecord& record, const std::string& out);

}  // namespace armsig::tool
