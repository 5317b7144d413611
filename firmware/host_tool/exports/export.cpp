// SPDX-License-Identifier: MIT
#include "firmware/host_tool/exports/export.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "core/base/check.hpp"
#include "firmware/host_tool/exports/provenance.hpp"

namespace armsig::tool {
namespace {

struct Format {
  std::string_view name;
  Read<std::string> (*text)(const SignatureRecord&);
  Carries carries = Carries::kGeometry;
};
constexpr std::array kFormats{
    Format{"urdf", urdf_text},
    Format{"ur-yaml", ur_yaml_text},
    Format{"linuxcnc", linuxcnc_text, Carries::kMaps},
    Format{"linuxcnc-kins", linuxcnc_kins_text, Carries::kEverything},
    Format{"dh-csv", dh_csv_text},
    Format{"mdh-csv", mdh_csv_text},
    Format{"rtb", rtb_text},
    Format{"json", json_text, Carries::kEverything},
    Format{"maps-csv", maps_csv_text, Carries::kEverything},
};

}  // namespace

std::vector<std::string> export_formats() {
  std::vector<std::string> names;
  names.reserve(kFormats.size());
  for (const Format& format : kFormats) names.emplace_back(format.name);
  return names;
}

Read<Carried> exportable(std::string_view format, Carries carries, const SignatureRecord& record) {
  if (record.corrections.empty()) return carried_by(format, carries, record);
  return cannot_hold(format, "its joint readings are corrected, and not by an offset alone",
                     "a signature identified with --correct none");
}

Read<Exported> export_text(const std::string& format, const SignatureRecord& record) {
  const auto* known = std::ranges::find(kFormats, format, &Format::name);
  ARMSIG_CHECK(known != kFormats.end());
  // LinuxCNC couples joints as its tables have corrected them, not as the encoders read.
  const bool maps_apart = known->carries == Carries::kMaps && record.nominal.couplings.empty();
  const Carries carries =
      known->carries == Carries::kMaps && !maps_apart ? Carries::kGeometry : known->carries;
  ARMSIG_TRY(carried, exportable(format, carries, record));
  ARMSIG_TRY(text, known->text(carried.record));
  Exported exported{std::move(text), {}, carried.lost_rms_m, carried.lost_largest_m};
  if (maps_apart) exported.companions = linuxcnc_tables(carried.record);
  return exported;
}

}  // namespace armsig::tool
