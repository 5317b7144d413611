// SPDX-License-Identifier: MIT
#include "firmware/host_tool/joining/implausible_positions.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/core.h>

#include "core/frames/link_frames.hpp"

namespace armsig::tool {
namespace {

constexpr double kFarthest = 20;      // times the reach
constexpr double kLeast = 0.01;       // of what the flange moves by
constexpr double kFlangeMoves = 0.1;  // of the reach; less is as well the hand's turning

double reach_m(const Arm& arm) {
  double reach = 0;
  for (std::size_t j = 0; j < arm.joints.size(); ++j) {
    reach += std::hypot(arm.joints[j].a_m, arm.joints[j].d_m);
    if (arm.joints[j].type != JointType::kPrismatic || j >= arm.limits.size()) continue;
    reach += std::max(std::abs(arm.limits[j].lower), std::abs(arm.limits[j].upper));
  }
  return reach;
}

// How far positions are from the first of them.
struct Spread {
  Vector3 first = Vector3::Zero();
  bool any = false;
  double farthest_m = 0;

  void add(const Vector3& p) {
    if (!any) first = p;
    any = true;
    farthest_m = std::max(farthest_m, (p - first).norm());
  }
};

}  // namespace

std::optional<std::string> implausible_positions(const Arm& nominal,
                                                 std::span<const MeasurementRow> rows) {
  const double reach = reach_m(nominal);
  std::map<int, Spread> measured;  // by target
  std::map<int, Spread> flange;
  for (const MeasurementRow& row : rows) {
    if (!row.p_S) continue;
    measured[row.target].add(*row.p_S);
    const auto frames = frames::link_frames(nominal.joints, effective_readings(nominal, row.q));
    flange[row.target].add(frames.X_0L.back().p);
  }
  for (const auto& [target, spread] : measured) {
    if (spread.farthest_m > kFarthest * reach) {
      return fmt::format("positions of target {} lie {:.0f} m apart, and the arm reaches {:.2f} m",
                         target, spread.farthest_m, reach);
    }
    const double moved_m = flange[target].farthest_m;
    if (moved_m > kFlangeMoves * reach && spread.farthest_m < kLeast * moved_m) {
      return fmt::format(
          "positions of target {} stay within {:.3f} mm, and the arm moves it by some {:.0f} mm",
          target, 1e3 * spread.farthest_m, 1e3 * moved_m);
    }
  }
  return std::nullopt;
}

}  // namespace armsig::tool
