// SPDX-License-Identifier: MIT
// Where the places of an instrument description are to stand about an arm (docs/model.md, section
// 13).
#pragma once

#include <string>
#include <vector>

#include "firmware/formats/problem.hpp"
#include "firmware/host_tool/places/place_fit.hpp"
#include "firmware/host_tool/places/touch_search.hpp"

namespace armsig::tool {

// Places by the nominal arm, and touches that are possible there.
struct PlaceLayout {
  PlaceTask task;
  std::vector<Vector3> middle_B;    // a place each; of a plane, the middle of what is touched
  std::vector<JointVector> judged;  // readings over which the tool's error counts
};

// What is expected before any touch, 1 sigma. Of an arm of ordinary make: axes turned by 1 mrad and
// shifted by 0.5 mm, zeros off by 3 mrad, each weight bending a joint by 0.3 mrad a metre, joint
// error maps of 0.007 degrees. Of every number of a touch: `sigma_m`.
[[nodiscard]] PlaceScales expected_scales(const PlaceTask& task, double sigma_m);

// Every bar, socket, plane and anchor of the description, one after the other: of some places that
// the arm reaches in several postures, the one after which the predicted tool error is least, by
// geometry and gravity, over readings that the arm may stand at. `most` touches a place. `file`
// names the description in problems. Refuses a description without a place, a place that two
// lengths name, and what can stand nowhere.
[[nodiscard]] Read<PlaceLayout> lay_out(const Arm& nominal,
                                        const InstrumentDescription& description,
                                        const TouchSearch& search, double sigma_m, std::size_t most,
                                        const std::string& file);

}  // namespace armsig::tool
