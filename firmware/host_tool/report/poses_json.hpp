// SPDX-License-Identifier: MIT
// Free poses and their residuals as the page takes them.
#pragma once

#include <nlohmann/json.hpp>

#include "firmware/host_tool/report/pose_residuals.hpp"

namespace armsig::tool {

// Of very many poses a part is shown: outliers and the worst in any case.
[[nodiscard]] nlohmann::ordered_json poses_json(const PoseResiduals& poses);

}  // namespace armsig::tool
