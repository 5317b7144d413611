// SPDX-License-Identifier: MIT
#include "firmware/host_tool/joining/standstills.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/pose.hpp"

namespace armsig::tool {
namespace {

double tolerance_of(JointType type) { return type == JointType::kRevolute ? radians(0.01) : 5e-5; }

// A tracker's point wanders by some hundredths of a millimetre while it stands.
constexpr double kStill_m = 2e-4;
// So many more points than standstills are no single shots.
constexpr std::size_t kStream = 4;

}  // namespace

bool are_same_readings(const JointVector& a, const JointVector& b, const JointTypes& types) {
  for (std::size_t j = 0; j < types.size(); ++j) {
    if (std::abs(a[j] - b[j]) > tolerance_of(types[j])) return false;
  }
  return true;
}

std::vector<Standstill> standstills_of(std::span<const LoggedPose> poses, const Clock& clock,
                                       const JointTypes& types) {
  std::vector<Standstill> standstills;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const double at_s = clock.seconds[k];
    if (standstills.empty() ||
        !are_same_readings(poses[standstills.back().first].q, poses[k].q, types)) {
      standstills.push_back({at_s, at_s, k, k});
    }
    standstills.back().to_s = at_s;
    standstills.back().last = k;
  }
  return standstills;
}

std::vector<Standstill> usable(std::vector<Standstill> standstills, double within_s) {
  const bool single = std::ranges::all_of(
      standstills, [](const Standstill& still) { return still.first == still.last; });
  const double inwards_s = single ? -within_s : within_s;
  for (Standstill& still : standstills) {
    still.from_s += inwards_s;
    still.to_s -= inwards_s;
  }
  std::erase_if(standstills, [](const Standstill& still) { return still.to_s < still.from_s; });
  return standstills;
}

std::vector<double> events_of(std::span<const TrackedPoint> points, const Clock& clock,
                              std::size_t standstills, double within_s) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return clock.seconds[k]; });
  std::vector<double> events;
  if (points.size() <= kStream * standstills) {
    for (const std::size_t k : order) events.push_back(clock.seconds[k]);
    return events;
  }
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last + 1 < order.size() &&
           (points[order[last + 1]].p_S - points[order[first]].p_S).norm() <= kStill_m) {
      ++last;
    }
    const double from_s = clock.seconds[order[first]];
    const double to_s = clock.seconds[order[last]];
    if (last > first && to_s - from_s >= within_s) events.push_back((from_s + to_s) / 2);
    first = last + 1;
  }
  return events;
}

}  // namespace armsig::tool
