// SPDX-License-Identifier: MIT
#include "firmware/virtual_cabinet/virtual_cabinet.hpp"

#include <cmath>

namespace armsig::cabinet {

VirtualSensor::VirtualSensor(const World& world, const canopen::CheckedConfiguration& drives,
                             std::span<const std::optional<simulated::Drive>> motors)
    : world_(world),
      drives_(drives),
      motors_(motors),
      field_(world.sensor, simulated::Random(world.seed)) {
  do_advance({});
}

void VirtualSensor::do_advance(hal::Instant /*until*/) {
  readings_.writing() = true_readings();
  readings_.publish();
}

JointVector VirtualSensor::true_readings() const {
  JointVector q;
  for (std::size_t i = 0; i < drives_->axes.size(); ++i) {
    // Scaling is linear: whole counts, and the part of one that the encoder does not see.
    const cia402::Scaling& scaling = drives_.scaling(i);
    const double counts = motors_[i]->joint_position();
    const auto whole = static_cast<std::int32_t>(counts);
    const double one = scaling.reading(whole + 1) - scaling.reading(whole);
    q.push_back(scaling.reading(whole) + one * (counts - whole));
  }
  return q;
}

simulated::SimulatedArm VirtualSensor::arm_at(hal::Instant now) {
  if (!powered_at_) powered_at_ = now;
  const double part =
      1 - std::exp(-hal::seconds(now - *powered_at_) / hal::seconds(world_.warming));
  return simulated::grown(world_.arm, world_.growth * part);
}

Vector3 VirtualSensor::target(hal::Instant now) {
  const JointVector& readings = readings_.read();
  const JointVector q = world_.bent ? turned(*world_.bent, readings) : readings;
  const simulated::SimulatedArm arm = arm_at(now);
  return simulated::target_position(arm, q, arm.targets[arm.targets.size() - 1]);
}

Result<std::optional<hal::RangeReading>> VirtualSensor::do_poll(hal::Instant now) {
  if (pinged_at_ && now - *pinged_at_ < world_.ping_period) return std::nullopt;
  pinged_at_ = now;
  if (error_) return std::unexpected(*error_);
  const simulated::Sounding sounding = field_.measure(target(now));
  hal::RangeReading reading;
  for (std::size_t j = 0; j < sounding.time_ns.size(); ++j) {
    reading.receivers.push_back(
        {.valid = sounding.valid[j], .flight_s = 1e-9 * sounding.time_ns[j]});
  }
  reading.air_celsius = sounding.air_celsius;
  reading.at = now + stamp_error_;
  reading.sequence = sounding.sequence;
  return reading;
}

VirtualTracker::VirtualTracker(const World& world, VirtualSensor& sensor)
    : world_(world), sensor_(sensor), tracker_({}, simulated::Random(world.seed)) {}

Result<std::optional<hal::PointReading>> VirtualTracker::do_poll(hal::Instant now) {
  if (sighted_at_ && now - *sighted_at_ < world_.ping_period) return std::nullopt;
  sighted_at_ = now;
  if (sensor_.error()) return std::unexpected(*sensor_.error());
  const simulated::UltrasonicConfig& field = sensor_.field();
  tracker_.config().sigma_m = field.range_sigma_m;
  tracker_.config().dropout_probability = field.dropout_probability;
  tracker_.config().outlier_probability = field.multipath_probability;
  const simulated::Sighting sighting = tracker_.measure(sensor_.target(now));
  if (!sighting.seen) return std::nullopt;
  return hal::PointReading{
      .p_S = sighting.p_S, .covariance_m2 = {}, .at = now, .sequence = ++sequence_};
}

VirtualWires::VirtualWires(const World& world, VirtualSensor& sensor,
                           const controller::LengthOffsets& offsets_m)
    : world_(world),
      sensor_(sensor),
      offsets_m_(offsets_m),
      wires_(world.sensor, simulated::Random(world.seed)) {}

Result<std::optional<hal::LengthReading>> VirtualWires::do_poll(hal::Instant now) {
  if (read_at_ && now - *read_at_ < world_.ping_period) return std::nullopt;
  read_at_ = now;
  if (sensor_.error()) return std::unexpected(*sensor_.error());
  wires_.config() = sensor_.field();
  const simulated::Sounding sounding = wires_.measure(sensor_.target(now));
  hal::LengthReading reading{.lengths_m = {}, .at = now, .sequence = sounding.sequence};
  for (std::size_t i = 0; i < offsets_m_.size(); ++i) {
    reading.lengths_m.push_back(
        sounding.valid[i] ? std::optional(sounding.range_m[i] - offsets_m_[i]) : std::nullopt);
  }
  return reading;
}

VirtualGravity::VirtualGravity(const World& world, const canopen::CheckedConfiguration& drives,
                               const VirtualSensor& sensor,
                               std::span<std::optional<simulated::Drive>> motors)
    : world_(world), drives_(drives), sensor_(sensor), motors_(motors) {
  do_advance({});
}

void VirtualGravity::do_advance(hal::Instant until) {
  // In which even a fast arm turns by a few degrees only.
  constexpr hal::Duration kStep = std::chrono::milliseconds(10);
  if (until < next_) return;
  next_ = until + kStep;
  const JointVector pull =
      simulated::gravity_pull(world_.arm, sensor_.true_readings(), world_.limbs);
  for (std::size_t i = 0; i < pull.size(); ++i) {
    const cia402::Scaling& scaling = drives_.scaling(i);
    motors_[i]->set_gravity(pull[i] / (scaling.reading(1) - scaling.reading(0)));
  }
}

namespace {

// As `emulate can=` and `can2=` name them.
constexpr std::array<std::string_view, canopen::kMostBuses> kBusNames{"can", "can2"};

// Of a drive that homes.
constexpr double kHomingTurnRate = radians(10);  // rad/s
constexpr double kHomingSpeed = 0.05;            // m/s

simulated::DriveConfiguration drive_of(const World& world, const canopen::AxisConfiguration& axis,
                                       bool homes) {
  const double counts_per_unit = 1 / cia402::Scaling::make(axis.scaling)->resolution();
  const JointType type = axis.scaling.type;
  simulated::DriveConfiguration drive;
  if (world.drive) {
    drive = *world.drive;
  } else {
    drive = type == JointType::kRevolute
                ? simulated::honest_drive(axis.node, counts_per_unit)
                : simulated::honest_slide_drive(axis.node, counts_per_unit);
    const double speed = type == JointType::kRevolute ? kHomingTurnRate : kHomingSpeed;
    if (homes) simulated::let_home(drive, speed * counts_per_unit);
  }
  drive.motion.play += bend_amount(type, world.play_rad) * counts_per_unit;
  return drive;
}

// Those of its node that are joints, a bit each.
std::uint8_t axes_of(const canopen::Configuration& drives,
                     const canopen::AxisConfiguration& of_node) {
  unsigned axes = 0;
  for (const canopen::AxisConfiguration& axis : drives.axes) {
    if (axis.shares_node(of_node)) axes |= 1U << (axis.axis - 1U);
  }
  return static_cast<std::uint8_t>(axes);
}

std::size_t first_of_node(const canopen::Configuration& drives, std::size_t axis) {
  std::size_t first = 0;
  while (!drives.axes[first].shares_node(drives.axes[axis])) ++first;
  return first;
}

}  // namespace

VirtualCabinet::VirtualCabinet(const controller::Configuration& configuration,
                               const canopen::Configuration& drives, const World& world,
                               hal::NonvolatileMemory& memory,
                               std::span<hal::Console* const> consoles, hal::Clock* real_time,
                               controller::Refinement* refinement, controller::CheckMemory* checks)
    : world_(world),
      drives_(*canopen::check(drives)),
      period_(configuration.period),
      clock_(real_time ? simulated::VirtualClock(*real_time) : simulated::VirtualClock()),
      buses_{simulated::VirtualCanBus(drives.bits_per_second),
             simulated::VirtualCanBus(drives.bits_per_second)} {
  canopen::NamedBuses ports;
  for (std::uint8_t bus = 0; bus < drives.buses.count; ++bus) {
    buses_[bus].connect(master_ports_[bus]);
    ports.push_back({&master_ports_[bus], kBusNames[bus]});
  }
  for (std::size_t i = 0; i < drives.axes.size(); ++i) {
    const bool homes = configuration.reference(i) == controller::Reference::kHomed;
    simulated::DriveConfiguration drive = drive_of(world, drives.axes[i], homes);
    drive.node = drives.axes[i].node;
    drive.axis = {.number = drives.axes[i].axis, .emulated = axes_of(drives, drives.axes[i])};
    drive.encoder_counts =
        static_cast<std::uint32_t>(std::lround(drives.axes[i].scaling.counts_per_revolution));
    drive.serial = world.first_serial + static_cast<std::uint32_t>(first_of_node(drives, i));
    drive.sync_loss_periods = world.sync_loss_periods;
    drive.motion.start = drives_.scaling(i).counts(world.start[i]).value_or(0);
    motors_[i].emplace(drive, ports_[i]);
    buses_[drives.axes[i].bus].connect(ports_[i], &*motors_[i]);
  }
  master_.emplace(drives_, ports);
  sensor_.emplace(world_, drives_, motors_);
  for (simulated::VirtualCanBus& bus : buses_) clock_.add(bus);
  clock_.add(*sensor_);
  gravity_.emplace(world_, drives_, *sensor_, motors_);
  clock_.add(*gravity_);
  hand_.emplace(world_, drives_, *sensor_, motors_);
  clock_.add(*hand_);
  controller_.emplace(configuration, *master_, instrument(configuration.sensor), clock_, memory,
                      consoles, refinement, checks);
}

controller::Instrument VirtualCabinet::instrument(const controller::Sensor& sensor) {
  if (sensor.measures == controller::Measures::kRanges) return *sensor_;
  if (sensor.measures == controller::Measures::kNothing) return {};
  if (world_.points != nullptr) return *world_.points;
  if (!world_.length_offsets_m.empty()) {
    wires_.emplace(world_, *sensor_, world_.length_offsets_m);
    return of_wires_.emplace(sensor.receivers, world_.length_offsets_m, *wires_);
  }
  return tracker_.emplace(world_, *sensor_);
}

void VirtualCabinet::inject(std::size_t joint, simulated::DriveFault fault, std::int32_t code) {
  for (std::size_t other = 0; other < drives_->axes.size(); ++other) {
    const bool same_node = drives_->axes[other].shares_node(drives_->axes[joint]);
    if (other == joint || (same_node && simulated::concerns_node(fault))) {
      motors_[other]->inject(fault, code);
    }
  }
}

void VirtualCabinet::step() {
  controller_->tick(clock_.wait_until(next_));
  controller_->background();
  next_ += period_;
}

}  // namespace armsig::cabinet
