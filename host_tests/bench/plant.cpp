// SPDX-License-Identifier: MIT
#include "host_tests/bench/plant.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hal/simulated/gravity.hpp"

namespace armsig::bench {
namespace {

constexpr std::size_t kReceiversOnCan = 6;  // TPDO2 to TPDO4, two each
// In which even a fast arm turns by a few degrees only.
constexpr hal::Duration kGravityStep = std::chrono::milliseconds(10);
constexpr double kHomingSpeed = 0.2;  // rad/s or m/s
constexpr double kLead_m = 0.01;      // travel of a slide a revolution of its output

std::vector<std::uint16_t> registers_of(const simulated::Sounding& sounding) {
  unsigned status = 0;
  for (std::size_t j = 0; j < sounding.valid.size(); ++j)
    status |= (sounding.valid[j] ? 1U : 0U) << j;
  const auto decidegrees = static_cast<std::int16_t>(std::lround(10 * sounding.air_celsius));
  std::vector<std::uint16_t> registers{static_cast<std::uint16_t>(status), sounding.sequence,
                                       static_cast<std::uint16_t>(decidegrees),
                                       static_cast<std::uint16_t>(sounding.time_ns.size())};
  for (const std::uint32_t time_ns : sounding.time_ns) {
    registers.push_back(static_cast<std::uint16_t>(time_ns >> 16));
    registers.push_back(static_cast<std::uint16_t>(time_ns & 0xFFFFU));
  }
  return registers;
}

hal::RangeReading reading_of(const simulated::Sounding& sounding) {
  hal::RangeReading reading;
  reading.sequence = sounding.sequence;
  reading.air_celsius = sounding.air_celsius;
  for (std::size_t j = 0; j < std::min(kReceiversOnCan, sounding.time_ns.size()); ++j) {
    reading.receivers.push_back({sounding.valid[j], 1e-9 * sounding.time_ns[j]});
  }
  return reading;
}

}  // namespace

Plant::Plant(const PlantConfiguration& configuration, hal::Instant now)
    : configuration_(configuration),
      bus_({.interface_name = configuration.can_interface, .filters = {}}),
      field_(configuration.field, simulated::Random(configuration.seed)),
      next_ping_(now),
      now_(now) {
  if (!configuration.second_can_interface.empty()) {
    second_bus_.emplace(linux_hal::SocketCanConfiguration{
        .interface_name = configuration.second_can_interface, .filters = {}});
  }
  for (std::size_t i = 0; i < configuration.arm.arm.joints.size(); ++i) {
    drives_.emplace_back(drive_of(i), i < first_of_second() ? bus_ : *second_bus_, now);
  }
  if (configuration.sensor_node != 0) node_.emplace(configuration.sensor_node, bus_, now);
  if (!configuration.sensor_device.empty()) line_.emplace(configuration.sensor_device);
}

simulated::DriveConfiguration Plant::drive_of(std::size_t joint) const {
  const std::size_t joints_a_node = configuration_.dual ? 2 : 1;
  const std::size_t of_bus = joint < first_of_second() ? joint : joint - first_of_second();
  const auto node = static_cast<std::uint8_t>(of_bus / joints_a_node + 1);
  const bool turns = configuration_.arm.arm.joints[joint].type == JointType::kRevolute;
  simulated::DriveConfiguration drive;
  if (!configuration_.ideal) {
    drive = turns ? simulated::honest_drive(node, counts_per_unit(joint))
                  : simulated::honest_slide_drive(node, counts_per_unit(joint));
  }
  drive.node = node;
  if (configuration_.dual) {
    const bool is_last = joint + 1 == configuration_.arm.arm.joints.size();
    drive.axis.number = static_cast<std::uint8_t>(joint % 2 + 1);
    drive.axis.emulated = is_last && joint % 2 == 0 ? 0b01 : 0b11;
  }
  if (configuration_.drive_table) {
    configuration_.drive_table->apply(drive);
  } else {
    drive.encoder_counts =
        static_cast<std::uint32_t>(std::lround(configuration_.counts_per_revolution));
  }
  if (std::ranges::find(configuration_.homed, joint + 1) != configuration_.homed.end()) {
    simulated::let_home(drive, kHomingSpeed * counts_per_unit(joint));
  }
  drive.motion.start =
      configuration_.start[joint] * counts_per_unit(joint) + configuration_.zero_counts[joint];
  drive.motion.bandwidth_hz = configuration_.bandwidth_hz;
  drive.sync_loss_periods = configuration_.sync_loss_periods;
  const JointType type = configuration_.arm.arm.joints[joint].type;
  drive.motion.play += cabinet::bend_amount(type, configuration_.play_rad) * counts_per_unit(joint);
  return drive;
}

std::size_t Plant::first_of_second() const {
  const std::size_t joints = configuration_.arm.arm.joints.size();
  return second_bus_ ? (joints + 1) / 2 : joints;
}

double Plant::counts_per_unit(std::size_t joint) const {
  const bool turns = configuration_.arm.arm.joints[joint].type == JointType::kRevolute;
  return configuration_.counts_per_revolution * configuration_.gear_ratio /
         (turns ? 2 * kPi : kLead_m);
}

JointVector Plant::readings() const {
  JointVector readings;
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    readings.push_back((drives_[i].joint_position() - configuration_.zero_counts[i]) /
                       counts_per_unit(i));
  }
  return readings;
}

JointVector Plant::turned() const {
  return configuration_.bent ? cabinet::turned(*configuration_.bent, readings()) : readings();
}

Vector3 Plant::target_S() const {
  return simulated::target_position(configuration_.arm, turned(), configuration_.arm.targets[0]);
}

Pose Plant::hand_S() const {
  return simulated::link_pose(configuration_.arm, turned(), drives_.size());
}

double Plant::take_peak_speed() { return std::exchange(peak_speed_, 0.0); }

void Plant::inject(std::size_t joint, simulated::DriveFault fault, std::int32_t code) {
  for (std::size_t other = 0; other < drives_.size(); ++other) {
    const bool same_node = configuration_.dual && other / 2 == joint / 2;
    if (other == joint || (same_node && simulated::concerns_node(fault))) {
      drives_[other].inject(fault, code);
    }
  }
}

void Plant::set_sensor_fault(SensorFault fault) {
  sensor_fault_ = fault;
  if (node_) node_->set_silent(fault == SensorFault::kSilent);
  if (line_)
    line_->set_fault(fault == SensorFault::kSilent ? LineFault::kSilent : LineFault::kNone);
}

void Plant::take(const hal::ReceivedCanFrame& received, std::size_t begin, std::size_t end) {
  if (received.frame.id == canopen::kSyncId && sync_to_lose_ > 0) {
    --sync_to_lose_;
    return;
  }
  // What waited in the queue is taken as of when it came.
  advance(std::max(now_, received.at));
  for (std::size_t i = begin; i < end; ++i) drives_[i].take(received);
  if (node_ && begin == 0) node_->take(received);
}

void Plant::advance(hal::Instant until) {
  now_ = until;
  for (simulated::Drive& drive : drives_) {
    drive.advance(until);
    peak_speed_ = std::max(peak_speed_, std::fabs(drive.velocity()));
  }
  if (node_) node_->advance(until);
}

void Plant::run(hal::Instant now) {
  (void)bus_.status();  // opens the interface again when it was away
  while (const auto received = bus_.receive()) take(*received, 0, first_of_second());
  if (second_bus_) {
    (void)second_bus_->status();
    while (const auto received = second_bus_->receive()) {
      take(*received, first_of_second(), drives_.size());
    }
  }
  advance(std::max(now_, now));
  if (now >= next_gravity_) {
    next_gravity_ = now + kGravityStep;
    feel_gravity();
  }
  if (now >= next_ping_) {
    // A ping that the host's scheduling missed is left out.
    next_ping_ = std::max(next_ping_ + configuration_.ping_period, now);
    ping();
  }
  if (line_) line_->serve(now);
}

void Plant::feel_gravity() {
  const JointVector pull = simulated::gravity_pull(configuration_.arm, readings());
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    drives_[i].set_gravity(pull[i] * counts_per_unit(i));
  }
}

void Plant::ping() {
  if (sensor_fault_ != SensorFault::kStale) sounding_ = field_.measure(target_S());
  publish(sounding_);
}

void Plant::publish(const simulated::Sounding& sounding) {
  if (line_) line_->set_registers(registers_of(sounding));
  if (node_) node_->publish(reading_of(sounding));
}

}  // namespace armsig::bench
