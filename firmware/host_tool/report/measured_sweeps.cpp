// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/measured_sweeps.hpp"

#include <algorithm>

namespace armsig::tool {

void MeasuredSweeps::add(const LocatedRow& row) {
  if (row.sweep == 0) {
    ++mixed;
    return;
  }
  const std::size_t joint = row.sweep - 1;
  const auto key = [](const MeasuredSweep& sweep) { return std::pair(sweep.joint, sweep.target); };
  auto place = std::ranges::lower_bound(sweeps, std::pair(joint, row.target), {}, key);
  if (place == sweeps.end() || key(*place) != std::pair(joint, row.target)) {
    place = sweeps.insert(place, {.joint = joint, .target = row.target, .points = {}});
  }
  place->points.push_back({row.q[joint], row.p_S, row.covariance_m2});
}

Read<MeasuredSweeps> read_measured_sweeps(const std::string& path, const SignatureRecord& record,
                                          const std::optional<SensorDescription>& sensor) {
  IdentificationRun run(record.nominal, sensor, path);
  MeasuredSweeps measured;
  const auto rows =
      read_measurements(path, record.signature.types, [&](const MeasurementRow& row) -> Read<void> {
        const auto located = run.located(row);
        if (!located) return std::unexpected(located.error());
        if (*located) {
          measured.add(**located);
        } else {
          ++measured.not_located;
        }
        return {};
      });
  if (!rows) return std::unexpected(rows.error());
  measured.rows = *rows;
  return measured;
}

}  // namespace armsig::tool
