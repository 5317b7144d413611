// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "firmware/host_tool/joining/join.hpp"

namespace armsig::tool {
namespace {

// A joint rests while its reading stays within this: 0.02 degrees, or 0.1 mm.
double rest_of(JointType type) { return type == JointType::kRevolute ? radians(0.02) : 1e-4; }

// The only joint that moved between two rows of one target, and which way; nothing where none or
// several did.
struct Step {
  std::size_t joint = 0;
  bool forward = true;

  bool operator==(const Step&) const = default;
};

std::optional<Step> step_between(const MeasurementRow& a, const MeasurementRow& b,
                                 const JointTypes& types) {
  if (a.target != b.target) return std::nullopt;
  std::optional<Step> step;
  for (std::size_t j = 0; j < types.size(); ++j) {
    const double moved = b.q[j] - a.q[j];
    if (std::abs(moved) <= rest_of(types[j])) continue;
    if (step) return std::nullopt;
    step = Step{j, moved > 0};
  }
  return step;
}

}  // namespace

std::vector<std::size_t> find_sweeps(std::vector<MeasurementRow>& rows, const JointTypes& types) {
  std::vector<std::size_t> counts(types.size());
  for (std::size_t first = 0; first + 1 < rows.size();) {
    const auto step = step_between(rows[first], rows[first + 1], types);
    std::size_t last = first + 1;
    while (step && last + 1 < rows.size() &&
           step_between(rows[last], rows[last + 1], types) == step) {
      ++last;
    }
    const std::size_t length = last - first + 1;
    if (!step || length < kShortestSweep) {
      first = step ? last : first + 1;
      continue;
    }
    for (std::size_t k = first; k <= last; ++k) rows[k].sweep = step->joint + 1;
    counts[step->joint] += length;
    first = last + 1;
  }
  return counts;
}

}  // namespace armsig::tool
