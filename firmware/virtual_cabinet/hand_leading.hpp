// SPDX-License-Identifier: MIT
// A person who leads an arm without torque, so that the ball on its flange sits in a socket: each
// time from another side, as good touches are made (docs/without-a-tracker.md).
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "core/base/fixed_vector.hpp"
#include "core/base/pose.hpp"
#include "hal/canopen/configuration.hpp"
#include "hal/simulated/arm.hpp"
#include "hal/simulated/drive.hpp"
#include "hal/simulated/random.hpp"
#include "hal/simulated/virtual_clock.hpp"

namespace armsig::cabinet {

struct World;
class VirtualSensor;

struct EmulatedSocket {
  FixedVector<char, 32> place;  // its name
  Vector3 p_0;                  // of a ball that sits in it, in frame 0 of the arm

  [[nodiscard]] std::string_view name() const { return {place.data(), place.size()}; }
};

struct EmulatedSockets {
  FixedVector<EmulatedSocket, 32> all;
  Vector3 ball_F = Vector3::Zero();  // its centre in the last frame, as it truly is
  double seat_sigma_m = 0.05e-3;     // 1 sigma along each axis of where the ball comes to sit
};

class HandLeading final : public simulated::TimeDriven {
 public:
  // All outlive it.
  HandLeading(const World& world, const canopen::CheckedConfiguration& drives,
              VirtualSensor& sensor, std::span<std::optional<simulated::Drive>> motors);

  // Null if there is none.
  [[nodiscard]] const EmulatedSocket* find(std::string_view place) const;

  // From now on, until is_leading() is false; the ball then sits `slip_m` beside its seat.
  // Precondition: no drive has torque. Error: kOutOfReach.
  Result<void> begin(const EmulatedSocket& socket, double slip_m, hal::Instant now);
  [[nodiscard]] bool is_leading() const { return lead_.has_value(); }
  void let_go() { lead_.reset(); }

 private:
  struct Lead {
    JointVector from;
    JointVector to;
    hal::Instant since;
    hal::Duration time{};
  };

  void do_advance(hal::Instant until) override;

  // Where the ball is at these readings, and which way the stem points, out of the flange.
  struct Ball {
    Vector3 p_S;
    Vector3 stem_S;
  };
  [[nodiscard]] Ball ball_at(const simulated::SimulatedArm& arm, const JointVector& readings) const;
  // Readings from which the ball gets there by the shortest ways; nothing where it does not.
  [[nodiscard]] std::optional<JointVector> reached(const simulated::SimulatedArm& arm,
                                                   const Vector3& seat_S, JointVector q) const;
  [[nodiscard]] bool may_stand(const simulated::SimulatedArm& arm, const JointVector& q) const;
  [[nodiscard]] JointVector anywhere();

  const World& world_;
  const canopen::CheckedConfiguration& drives_;
  VirtualSensor& sensor_;
  std::span<std::optional<simulated::Drive>> motors_;
  simulated::Random random_;
  std::optional<Lead> lead_;
};

}  // namespace armsig::cabinet
