// SPDX-License-Identifier: MIT
// Sessions without any place known: zeros 2 degrees wrong (1 sigma), the tool 100 mm off where it
// is said to be.
#pragma once

#include "host_tests/support/touching_arm.hpp"

namespace armsig::touching {

inline void touch_three_planes(Session& session, int count) {
  const double z = session.lift_m();
  session.touch_plane("table", {0.45, 0.1, z + 0.1}, Vector3d::UnitZ(), count);
  session.touch_plane("shelf", {-0.1, 0.45, z + 0.4}, Vector3d::UnitZ(), count);
  session.touch_plane("ramp", {-0.3, -0.35, z + 0.25}, Vector3d(0.5, 0.3, 0.8).normalized(), count);
}

inline void read_three_wires(Session& session, int count) {
  const double z = session.lift_m();
  session.read_wire("W1", {1.2, 0, z + 0.1}, 1e-3, 5e-3, count);
  session.read_wire("W2", {-0.7, 1.0, z + 0.2}, 1e-3, 5e-3, count);
  session.read_wire("W3", {-0.6, -0.9, z + 1.3}, 1e-3, 5e-3, count);
}

enum class Instruments { kSockets, kPlanes, kWires, kMixture };

inline Session with_unknown_places(const Drawing& drawing, Instruments instruments, unsigned seed) {
  Faults faults;
  faults.zero = 2 * kDegree;
  Session session(drawing, seed, faults);
  session.nominal_tool() = session.tool() + 0.1 * any_stem(session.random());
  switch (instruments) {
    case Instruments::kSockets:
      session.add_bars(4, 0.3, 0.02e-3);
      session.touch_sockets(80);
      break;
    case Instruments::kPlanes:
      touch_three_planes(session, 40);
      break;
    case Instruments::kWires:
      read_three_wires(session, 40);
      break;
    case Instruments::kMixture:
      session.add_bars(2, 0.3, 0.02e-3);
      session.touch_sockets(32);
      session.touch_plane("table", {0.45, 0.1, session.lift_m() + 0.1}, Vector3d::UnitZ(), 30);
      session.read_wire("W1", {1.2, 0, session.lift_m() + 0.1}, 1e-3, 5e-3, 40);
      break;
  }
  return session;
}

}  // namespace armsig::touching
