// SPDX-License-Identifier: MIT
// The emulated cell: six drives that turn the joints of an exact arm, and a range sensor that hears
// a target on its hand, on a real CAN bus and a serial line.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "firmware/virtual_cabinet/bent_arm.hpp"
#include "hal/linux/socket_can.hpp"
#include "hal/range_sensor.hpp"
#include "hal/simulated/arm.hpp"
#include "hal/simulated/drive.hpp"
#include "hal/simulated/range_node.hpp"
#include "hal/simulated/ultrasonic_field.hpp"
#include "host_tests/bench/modbus_server.hpp"
#include "host_tests/support/drive_tables.hpp"

namespace armsig::bench {

struct PlantConfiguration {
  std::string can_interface = "vcan0";
  // The upper half of the joints is on it, their nodes counted from 1 too; empty: all are on one.
  std::string second_can_interface;
  std::string sensor_device;     // symbolic link to the sensor's serial line; empty: no such line
  std::uint8_t sensor_node = 0;  // on the CAN bus; 0: not there
  simulated::SimulatedArm arm;   // joint i is node i, unless `dual`; one target
  bool dual = false;             // two joints a node: its first axis, and its second
  // Of every motor; joint reading = (counts - zero) / counts a radian (or a metre, of a slide, at
  // 10 mm a revolution of the output).
  double counts_per_revolution = 4000;
  double gear_ratio = 100;
  std::vector<double> zero_counts;  // one a joint
  JointVector start;                // readings at power-up
  double bandwidth_hz = 25;         // of the position loops: following error = speed / (pi * this)
  unsigned sync_loss_periods = 0;   // that drives bear while enabled; 0: any number
  std::optional<test::DriveTable> drive_table;  // what every drive has and lacks
  std::vector<std::size_t> homed;  // joints from 1 whose drives count anew until they have homed
  bool ideal = false;              // else drives as they are: simulated::honest_drive()
  // Maps of the readings and sag; none: the joints turn as the encoders read.
  std::optional<calibration::ArmModel> bent;
  double play_rad = 0;  // of every joint, beside what its drive has of its own
  simulated::UltrasonicConfig field;
  hal::Duration ping_period = std::chrono::milliseconds(20);
  std::uint64_t seed = 1;
};

// What is wrong with what the sensor measures, whichever bus it is on.
enum class SensorFault : std::uint8_t {
  kNone,
  kStale,   // repeats its last reading
  kSilent,  // on neither bus
};

class Plant {
 public:
  // Throws std::system_error where there can be no pseudo-terminal.
  Plant(const PlantConfiguration& configuration, hal::Instant now);

  // Everything that is due at `now`: frames, motion, pings, requests on the serial line. To be
  // called at least every 500 us for the drives to answer in time.
  void run(hal::Instant now);

  [[nodiscard]] std::size_t joints() const { return drives_.size(); }
  [[nodiscard]] simulated::Drive& drive(std::size_t joint) { return drives_[joint]; }
  [[nodiscard]] simulated::UltrasonicConfig& field() { return field_.config(); }
  [[nodiscard]] ModbusServer* line() { return line_ ? &*line_ : nullptr; }
  // A fault of the drive of a joint; of its whole node, where it is one of those.
  void inject(std::size_t joint, simulated::DriveFault fault, std::int32_t code);
  void set_sensor_fault(SensorFault fault);
  // The drives hear nothing of the next `count` SYNC frames.
  void lose_sync(unsigned count) { sync_to_lose_ = count; }

  // The truth.
  [[nodiscard]] JointVector readings() const;  // beyond the play
  [[nodiscard]] Vector3 target_S() const;
  [[nodiscard]] Pose hand_S() const;  // frame n
  // Fastest that any motor turned since this was last asked for, counts/s.
  [[nodiscard]] double take_peak_speed();
  [[nodiscard]] hal::CanStatus bus_status() { return bus_.status(); }

 private:
  [[nodiscard]] simulated::DriveConfiguration drive_of(std::size_t joint) const;
  // The first joint that is on the second interface.
  [[nodiscard]] std::size_t first_of_second() const;
  // The drives from `begin` on and before `end` take it.
  void take(const hal::ReceivedCanFrame& received, std::size_t begin, std::size_t end);
  [[nodiscard]] JointVector turned() const;  // readings of an arm that does not bend, in that pose
  void feel_gravity();
  [[nodiscard]] double counts_per_unit(std::size_t joint) const;
  void advance(hal::Instant until);
  void ping();
  void publish(const simulated::Sounding& sounding);

  PlantConfiguration configuration_;
  linux_hal::SocketCan bus_;
  std::optional<linux_hal::SocketCan> second_bus_;
  std::deque<simulated::Drive> drives_;  // not movable
  std::optional<simulated::RangeNode> node_;
  std::optional<ModbusServer> line_;
  simulated::UltrasonicField field_;
  SensorFault sensor_fault_ = SensorFault::kNone;
  simulated::Sounding sounding_;  // the last one
  hal::Instant next_ping_;
  hal::Instant next_gravity_;
  hal::Instant now_;
  unsigned sync_to_lose_ = 0;
  double peak_speed_ = 0;
};

}  // namespace armsig::bench
