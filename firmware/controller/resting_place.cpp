// SPDX-License-Identifier: MIT
#include "firmware/controller/resting_place.hpp"

#include <cmath>

namespace armsig::controller {

void RestingPlace::compare(const JointVector& now, const Announcer& announcer) {
  constexpr double kMoved_rad = radians(0.5);
  constexpr double kMoved_m = 1e-3;
  if (compared_) return;
  compared_ = true;
  const auto kept = keeper_.load(now.size());
  for (std::size_t i = 0; kept && i < now.size(); ++i) {
    const bool turns = drawing_.joints[i].type == JointType::kRevolute;
    const double moved = now[i] - (*kept)[i];
    if (!(std::abs(moved) > (turns ? kMoved_rad : kMoved_m))) continue;
    Line line;
    line.text("# moved without power joint=").integer(i + 1).text(turns ? " by_deg=" : " by_mm=");
    announcer.say(line.number(turns ? degrees(moved) : 1e3 * moved, 3));
  }
}

// Once a `disable`, and not while the arm may be pushed about.
void RestingPlace::step(const Snapshot& now) {
  had_torque_ = had_torque_ || kWithTorque.contains(now.mode);
  if (keeper_.is_writing()) {
    keeper_.step();
  } else if (had_torque_ && now.mode == Mode::kIdle && now.all_disabled && compared_) {
    had_torque_ = false;
    keeper_.begin(now.positions);
  }
}

}  // namespace armsig::controller
