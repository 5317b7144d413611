// SPDX-License-Identifier: MIT
// The truth of a simulated session, for a fit to start at: what a start from nothing is compared
// with.
#pragma once

#include "host_tests/places/task_of_session.hpp"

namespace armsig::tool {

inline void put_true_place(touching::Session& session, TouchedPlace& place) {
  switch (place.kind) {
    case InstrumentKind::kSocket:
      place.point_B = session.sockets().at(place.name);
      return;
    case InstrumentKind::kPlane:
      place.point_B = session.planes().at(place.name).normal;
      place.distance_m = session.planes().at(place.name).distance_m;
      return;
    case InstrumentKind::kWire:
      place.point_B = session.anchors().at(place.name);
      return;
  }
}

// But for gravity and maps, which are zero.
inline PlaceState true_state(touching::Session& session, const PlaceTask& task) {
  PlaceState state = nominal_state(task);
  for (std::size_t j = 0; j < state.arm.joint_count(); ++j) {
    state.arm.joints[j].deviation = session.arm().deviations(j);
  }
  state.tool.p_L = session.tool();
  for (TouchedPlace& place : state.places) {
    put_true_place(session, place);
    if (place.kind != InstrumentKind::kWire) continue;
    state.scales[place.instrument] = {session.wire_gain(), session.wire_zero_m()};
  }
  return state;
}

}  // namespace armsig::tool
