// SPDX-License-Identifier: MIT
// One signature for the eye: a self-contained HTML page, readable offline.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "firmware/host_tool/report/report_input.hpp"

namespace armsig::tool {

// Everything that the page shows, numbers in SI.
[[nodiscard]] nlohmann::ordered_json report_json(const ReportInput& input);

// The page. Refused where armsig was built without it.
[[nodiscard]] Read<std::string> report_page(const nlohmann::ordered_json& report);

}  // namespace armsig::tool
