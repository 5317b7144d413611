// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/report_page.hpp"

namespace armsig::tool {

const std::string_view kReportPage;

}  // namespace armsig::tool
