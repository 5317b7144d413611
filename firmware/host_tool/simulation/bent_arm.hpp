// SPDX-License-Identifier: MIT
// What real arms do beside their geometry, for a simulated one: transmissions and encoders that
// read a little wrong by waves that repeat with the turn, gravity, play.
#pragma once

#include <memory>

#include "core/calibration/model.hpp"
#include "hal/simulated/arm.hpp"
#include "hal/simulated/random.hpp"

namespace armsig::tool {

struct Bends {
  double map_rad = 0;   // largest error of a reading, of every revolute joint; a slide's in m: so
                        // many times 0.5 m
  double sag_m = 0;     // of the last link's origin, the arm stretched out level
  double play_rad = 0;  // from one end of it to the other; a slide's in m: so many times 0.5 m

  [[nodiscard]] bool any() const { return map_rad > 0 || sag_m > 0 || play_rad > 0; }
};

// Gravity and maps of that size on the drawing: of every joint waves of 1 to 17 a turn, as a spline
// has them, and the lever of the last link's origin.
[[nodiscard]] std::shared_ptr<const calibration::ArmModel> bent_model(const Arm& drawing,
                                                                      const Bends& bends,
                                                                      simulated::Random& random);

// How far the joints of such an arm turn. Play leaves each on the side that it came from.
class BentJoints {
 public:
  BentJoints() = default;  // as the readings say
  BentJoints(std::shared_ptr<const calibration::ArmModel> model, double play_rad)
      : model_(std::move(model)), play_rad_(play_rad) {}

  // Readings that have the arm where it is when its encoders read `readings`, after where the call
  // before had it.
  [[nodiscard]] JointVector turned(const JointVector& readings);

 private:
  std::shared_ptr<const calibration::ArmModel> model_;
  double play_rad_ = 0;
  JointVector before_;
  std::array<double, kMaxJoints> side_{};  // 1: reached upwards, -1: downwards
};

}  // namespace armsig::tool
