// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/row_groups.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/core.h>

namespace armsig::tool {
namespace {

constexpr std::size_t kFewestOfGroup = 6;
constexpr std::size_t kRunsOfPoses = 4;
constexpr std::size_t kFewestOfRun = 8;
constexpr double kSharePassing = 0.4;

using Groups = std::map<std::pair<std::size_t, std::size_t>, std::vector<std::size_t>>;

Groups groups_of(const Evidence& evidence, const std::vector<double>& lengths_m) {
  const auto poses =
      static_cast<std::size_t>(std::ranges::count(evidence.rows, 0U, &EvidenceRow::sweep));
  const std::size_t run = std::max(kFewestOfRun, (poses + kRunsOfPoses - 1) / kRunsOfPoses);
  Groups groups;
  std::size_t pose = 0;
  for (std::size_t k = 0; k < evidence.rows.size(); ++k) {
    const std::size_t sweep = evidence.rows[k].sweep;
    const std::size_t part = sweep == 0 ? pose++ / run : 0;
    if (lengths_m[k] >= 0) groups[{sweep, part}].push_back(k);
  }
  return groups;
}

}  // namespace

GroupMiss worst_group(const Evidence& evidence, const std::vector<double>& lengths_m) {
  GroupMiss worst;
  for (const auto& [key, rows] : groups_of(evidence, lengths_m)) {
    if (rows.size() < kFewestOfGroup) continue;
    std::vector<double> lengths;
    for (const std::size_t k : rows) lengths.push_back(lengths_m[k]);
    const auto at = lengths.begin() + static_cast<std::ptrdiff_t>(
                                          kSharePassing * static_cast<double>(lengths.size()));
    std::ranges::nth_element(lengths, at);
    if (*at <= worst.length_m) continue;
    worst.length_m = *at;
    worst.name = fmt::format("{} (lines {} to {})",
                             key.first == 0 ? "poses" : fmt::format("sweep {}", key.first),
                             evidence.rows[rows.front()].line, evidence.rows[rows.back()].line);
  }
  return worst;
}

}  // namespace armsig::tool
