// SPDX-License-Identifier: MIT
#include "firmware/host_tool/exports/export.hpp"

#include <array>

#include "core/base/check.hpp"
#include "firmware/host_tool/exports/provenance.hpp"

namespace armsig::tool {
namespace {

struct Format {
  const char* name;
  Read<std::string> (*text)(const SignatureRecord&);
};
constexpr std::array kFormats{
    Format{"urdf", urdf_text},         Format{"ur-yaml", ur_yaml_text},
    Format{"linuxcnc", linuxcnc_text}, Format{"dh-csv", dh_csv_text},
    Format{"mdh-csv", mdh_csv_text},   Format{"rtb", rtb_text},
    Format{"json", json_text},
};

}  // namespace

std::vector<std::string> export_formats() {
  std::vector<std::string> names;
  names.reserve(kFormats.size());
  for (const Format& format : kFormats) names.emplace_back(format.name);
  return names;
}

Read<std::string> export_text(const std::string& format, const SignatureRecord& record) {
  if (!record.corrections.empty()) {
    return cannot_hold(format, "its joint readings are corrected, and not by an offset alone",
                       "a signature identified without --correct");
  }
  for (const Format& known : kFormats) {
    if (format == known.name) return known.text(record);
  }
  ARMSIG_CHECK(false);
}

}  // namespace armsig::tool
