// SPDX-License-Identifier: MIT
#include "firmware/analysis/differences/bends.hpp"

#include "core/base/check.hpp"

namespace armsig::differences {

void Bends::evaluate(const Side& side, const JointVector& readings, const JointVector& effective,
                     BendValues& map, BendValues& gravity) {
  map.fill(0);
  gravity.fill(0);
  if (side.model == nullptr) return;
  const calibration::ArmModel& model = *side.model;
  if (!model.gravity.empty()) {
    calibration::GravityLevers levers;
    calibration::gravity_levers(model, effective, levers);
    for (std::size_t t = 0; t < model.gravity.size(); ++t) {
      gravity[model.gravity[t].joint] += model.gravity[t].coefficient * levers[t];
    }
  }
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    if (model.joints[i].domain.per_length > 0) {
      map[i] = calibration::map_at(model.joints[i], readings[i]);
    }
    map[i] -= side.map_at_rest[i];
    gravity[i] -= side.gravity_at_rest[i];
  }
}

Bends::Side Bends::side_of(const Bending& bending) {
  Side side{.model = bending.model};
  if (side.model == nullptr) return side;
  ARMSIG_CHECK(bending.configuration.size() == side.model->joint_count());
  BendValues map;
  BendValues gravity;
  evaluate(side, readings_for(side.model->couplings, bending.configuration), bending.configuration,
           map, gravity);
  side.map_at_rest = map;
  side.gravity_at_rest = gravity;
  return side;
}

Bends::Bends(const Bendings& bendings)
    : drawn_(side_of(bendings.drawn)), actual_(side_of(bendings.actual)) {}

Bend Bends::at(const JointVector& readings, const JointVector& effective) const {
  Bend bend;
  BendValues drawn_map;
  BendValues drawn_gravity;
  evaluate(drawn_, readings, effective, drawn_map, drawn_gravity);
  evaluate(actual_, readings, effective, bend.more_by_map, bend.more_by_gravity);
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    bend.drawn[i] = drawn_map[i] + drawn_gravity[i];
    bend.more_by_map[i] -= drawn_map[i];
    bend.more_by_gravity[i] -= drawn_gravity[i];
  }
  return bend;
}

}  // namespace armsig::differences
