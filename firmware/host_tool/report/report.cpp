// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/report.hpp"

#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/report/report_page.hpp"

namespace armsig::tool {

Read<std::string> report_page(const nlohmann::ordered_json& report) {
  const std::size_t at = kReportPage.find(kDataMarker);
  if (at == std::string_view::npos) {
    return std::unexpected(Problem{"", 0, 0, "this armsig was built without the report",
                                   "a build where npm is found"});
  }
  // "</script>" in a name must not end the page's data.
  std::string data = json_text(report, -1);
  for (std::size_t k = 0; (k = data.find('<', k)) != std::string::npos;) {
    data.replace(k, 1, "\\u003c");
  }
  std::string page(kReportPage.substr(0, at));
  page += data;
  page += kReportPage.substr(at + kDataMarker.size());
  return page;
}

}  // namespace armsig::tool
