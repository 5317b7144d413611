// SPDX-License-Identifier: MIT
// A whole cabinet without hardware: the controller with its CANopen stack, virtual CAN buses,
// emulated drives, an arm with its manufacturing errors, and an ultrasonic sensor that measures the
// target on its hand. In virtual time, or in real time by threads as in a real cabinet.
#pragma once

#include <optional>
#include <span>

#include "firmware/controller/controller.hpp"
#include "firmware/controller/latest_value.hpp"
#include "firmware/controller/length_points.hpp"
#include "firmware/virtual_cabinet/bent_arm.hpp"
#include "firmware/virtual_cabinet/hand_leading.hpp"
#include "hal/canopen/configuration.hpp"
#include "hal/canopen/master.hpp"
#include "hal/length_instrument.hpp"
#include "hal/point_instrument.hpp"
#include "hal/simulated/arm.hpp"
#include "hal/simulated/cartesian_sensor.hpp"
#include "hal/simulated/drive.hpp"
#include "hal/simulated/gravity.hpp"
#include "hal/simulated/ultrasonic_field.hpp"
#include "hal/simulated/virtual_can_bus.hpp"
#include "hal/simulated/virtual_clock.hpp"

namespace armsig::cabinet {

// The arm as it is, behind the drives as they are.
struct World {
  simulated::SimulatedArm arm;  // as it was built; its last target is on the hand
  JointVector start;            // readings at power-up
  // Of every joint, but for its node and where it starts; none: drives as they are, of each joint's
  // own counts (simulated::honest_drive(), honest_slide_drive()), which home where the
  // configuration says so (simulated::let_home()).
  std::optional<simulated::DriveConfiguration> drive;
  // Maps of the readings and sag, of the arm as drawn; none: its joints turn as the encoders read.
  std::optional<calibration::ArmModel> bent;
  double play_rad =
      0;  // between each motor and its joint, beside what the drives have of their own
  // All lengths of the arm grow by this share of themselves while it warms up, from power-up on: by
  // 63 % of it in each time constant. Steel that warms by 10 K: 1.2e-4.
  double growth = 0;
  hal::Duration warming = std::chrono::minutes(20);
  simulated::Limbs limbs;  // what gravity pulls at
  unsigned sync_loss_periods = simulated::DriveConfiguration{}.sync_loss_periods;
  simulated::UltrasonicConfig sensor;
  hal::Duration ping_period = std::chrono::milliseconds(20);
  // Where the configuration says that points are measured: what tells them instead of an emulated
  // tracker, and outlives the cabinet.
  hal::PointInstrument* points = nullptr;
  // The same where it says that lengths are measured, from the places of the receivers: what the
  // controller adds to each. Empty: an emulated tracker tells points.
  controller::LengthOffsets length_offsets_m{};
  EmulatedSockets sockets{};  // none: nobody leads the arm
  std::uint64_t seed = 1;
  std::uint32_t first_serial = 1001;  // of the drives, one after the other
};

// Measures the hand target where the drives really are. Time is the servo thread's, polling the
// background's.
class VirtualSensor final : public hal::RangeSensor, public simulated::TimeDriven {
 public:
  VirtualSensor(const World& world, const canopen::CheckedConfiguration& drives,
                std::span<const std::optional<simulated::Drive>> motors);

  // Trouble on command: readings cease, are repeated, or tell this air temperature; or their stamps
  // are off.
  void set_error(std::optional<Error> error) { error_ = error; }
  [[nodiscard]] std::optional<Error> error() const { return error_; }
  void set_stamp_error(hal::Duration error) { stamp_error_ = error; }
  [[nodiscard]] simulated::UltrasonicConfig& field() { return field_.config(); }
  // Exact readings of the joints, which the drives only round.
  [[nodiscard]] JointVector true_readings() const;
  // The arm `now`, as warm as it is.
  [[nodiscard]] simulated::SimulatedArm arm_at(hal::Instant now);
  // Where the target truly is, `now`: with the arm's bends, and as warm as it is.
  [[nodiscard]] Vector3 target(hal::Instant now);

 private:
  Result<std::optional<hal::RangeReading>> do_poll(hal::Instant now) override;
  void do_advance(hal::Instant until) override;

  const World& world_;
  const canopen::CheckedConfiguration& drives_;
  std::span<const std::optional<simulated::Drive>> motors_;
  controller::LatestValue<JointVector> readings_;
  simulated::UltrasonicField field_;
  std::optional<hal::Instant> powered_at_;
  std::optional<hal::Instant> pinged_at_;
  std::optional<Error> error_;
  hal::Duration stamp_error_{};
};

// A tracker that sees the same target, with the faults of the sensor: its sigma is that of a range,
// its dropouts and reflections are those of a receiver.
class VirtualTracker final : public hal::PointInstrument {
 public:
  VirtualTracker(const World& world, VirtualSensor& sensor);

 private:
  Result<std::optional<hal::PointReading>> do_poll(hal::Instant now) override;

  const World& world_;
  VirtualSensor& sensor_;
  simulated::CartesianSensor tracker_;
  std::optional<hal::Instant> sighted_at_;
  std::uint32_t sequence_ = 0;
};

// Wires from anchors at the places of the receivers to the same target, with the faults of the
// sensor: what is a reflection there is a wire off its pulley here.
class VirtualWires final : public hal::LengthInstrument {
 public:
  // `offsets_m` are what the controller adds to each length.
  VirtualWires(const World& world, VirtualSensor& sensor,
               const controller::LengthOffsets& offsets_m);

 private:
  Result<std::optional<hal::LengthReading>> do_poll(hal::Instant now) override;

  const World& world_;
  VirtualSensor& sensor_;
  controller::LengthOffsets offsets_m_;
  simulated::UltrasonicField wires_;
  std::optional<hal::Instant> read_at_;
};

// Gravity, by the pose that the motors have brought the arm into.
class VirtualGravity final : public simulated::TimeDriven {
 public:
  VirtualGravity(const World& world, const canopen::CheckedConfiguration& drives,
                 const VirtualSensor& sensor, std::span<std::optional<simulated::Drive>> motors);

 private:
  void do_advance(hal::Instant until) override;

  const World& world_;
  const canopen::CheckedConfiguration& drives_;
  const VirtualSensor& sensor_;
  std::span<std::optional<simulated::Drive>> motors_;
  hal::Instant next_;
};

class VirtualCabinet {
 public:
  // Preconditions: check() of both configurations; `memory`, `consoles`, and the `real_time`,
  // `refinement` and `checks` of the cabinet, where it has them, outlive it.
  VirtualCabinet(const controller::Configuration& configuration,
                 const canopen::Configuration& drives, const World& world,
                 hal::NonvolatileMemory& memory, std::span<hal::Console* const> consoles,
                 hal::Clock* real_time = nullptr, controller::Refinement* refinement = nullptr,
                 controller::CheckMemory* checks = nullptr);
  VirtualCabinet(const VirtualCabinet&) = delete;
  VirtualCabinet& operator=(const VirtualCabinet&) = delete;

  // One tick, the background after it, and the time until the next tick.
  void step();

  [[nodiscard]] hal::Clock& clock() { return clock_; }
  [[nodiscard]] controller::Controller& controller() { return *controller_; }
  [[nodiscard]] const controller::Background& state() const { return controller_->state(); }
  [[nodiscard]] simulated::Drive& drive(std::size_t joint) { return *motors_[joint]; }
  // A fault of the drive of `joint`; of its whole node, where it is one of those.
  void inject(std::size_t joint, simulated::DriveFault fault, std::int32_t code = 0);
  [[nodiscard]] std::size_t joint_count() const { return drives_->axes.size(); }
  [[nodiscard]] JointType joint_type(std::size_t joint) const {
    return drives_->axes[joint].scaling.type;
  }
  [[nodiscard]] const cia402::Scaling& scaling(std::size_t joint) const {
    return drives_.scaling(joint);
  }
  [[nodiscard]] simulated::VirtualCanPort& master_port(std::size_t bus = 0) {
    return master_ports_[bus];
  }
  [[nodiscard]] std::size_t bus_count() const { return drives_->buses.count; }
  [[nodiscard]] VirtualSensor& sensor() { return *sensor_; }
  // To be asked of by the thread that steps.
  [[nodiscard]] HandLeading& hand() { return *hand_; }
  // A link that bends, a foot or a sensor that is pushed: changed between two steps, and not while
  // the threads of a real time run.
  [[nodiscard]] simulated::SimulatedArm& arm() { return world_.arm; }
  // How it bends: loaded otherwise.
  [[nodiscard]] std::optional<calibration::ArmModel>& bent() { return world_.bent; }

 private:
  [[nodiscard]] controller::Instrument instrument(const controller::Sensor& sensor);

  World world_;
  canopen::CheckedConfiguration drives_;
  hal::Duration period_;
  simulated::VirtualClock clock_;
  std::array<simulated::VirtualCanBus, canopen::kMostBuses> buses_;
  std::array<simulated::VirtualCanPort, canopen::kMostBuses> master_ports_;
  std::array<simulated::VirtualCanPort, kMaxJoints> ports_;
  std::array<std::optional<simulated::Drive>, kMaxJoints> motors_;
  std::optional<canopen::Master> master_;
  std::optional<VirtualSensor> sensor_;
  std::optional<VirtualTracker> tracker_;
  std::optional<VirtualWires> wires_;
  std::optional<controller::LengthPoints> of_wires_;
  std::optional<VirtualGravity> gravity_;
  std::optional<HandLeading> hand_;
  std::optional<controller::Controller> controller_;
  hal::Instant next_;
};

}  // namespace armsig::cabinet
