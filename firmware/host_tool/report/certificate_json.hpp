// SPDX-License-Identifier: MIT
// The certificate as the page takes it.
#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "firmware/host_tool/report/report_input.hpp"

namespace armsig::tool {

[[nodiscard]] nlohmann::ordered_json certificate_json(const ReportInput& input,
                                                      const std::vector<SweepPicture>& sweeps,
                                                      const std::optional<ToolErrorMap>& map,
                                                      const std::optional<PoseResiduals>& poses);

}  // namespace armsig::tool
