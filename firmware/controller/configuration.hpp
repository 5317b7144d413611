// SPDX-License-Identifier: MIT
// Everything that the controller must be told, checked as a whole before anything moves. What the
// drives must be told besides is in hal/canopen/configuration.hpp.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string_view>

#include "core/base/arm.hpp"
#include "core/base/error.hpp"
#include "core/clearance/clearance.hpp"
#include "core/evaluation/grid.hpp"
#include "core/measurement/ranges.hpp"
#include "core/measurement/receivers.hpp"
#include "hal/clock.hpp"

namespace armsig::controller {

// Per joint in rad or m and seconds; of the tool point in m, rad and seconds.
struct MotionLimits {
  JointVector speed;
  JointVector acceleration;
  double tool_speed = 0.25;
  double tool_turn_rate = 1.0;
  // A tool line is refused, or stopped, where the regularity of the arm (kinematics/regularity.hpp)
  // falls below this.
  double least_regularity = 0.001;
};

struct Supervision {
  // Commanded less actual position that is a fault, per joint; covers the delay of the bus.
  JointVector following_error;
  hal::Duration latest_tick = std::chrono::milliseconds(10);  // a tick later than this is a fault
#ifndef ARMSIG_SMALL_IMAGE                                    // which hears no torque
  // Largest torque of each joint in a sequence, as a share of the rated one, where it is watched.
  FixedVector<std::optional<double>, kMaxJoints> sequence_torque;
#endif
};

// What locates the target.
enum class Measures : std::uint8_t {
  kRanges,  // a range sensor
  kPoints,  // an instrument that says where it is
  kNothing,
};

struct Sensor {
#ifndef ARMSIG_RANGES_ALONE
  Measures measures = Measures::kRanges;
  // 1 sigma along each axis of a point that does not tell its own.
  double point_sigma_m = 0;
  // Of all that the configuration file says of it: where that differs, readings mean others.
  std::uint32_t settings_crc = 0;
#endif
  measurement::ReceiverArray receivers;  // of ranges; of lengths that tell points: their anchors
  double lowest_air_celsius = 0;
  double highest_air_celsius = 45;
  // Air that warms faster than this between two readings is a broken thermometer.
  double largest_air_step_kelvin = 2;
  hal::Duration reading_timeout = std::chrono::milliseconds(1000);  // without a usable reading
};

struct Dwell {
  // Standstill: commanded less actual position of every joint, rad or m, for the time.
  double tolerance = 1e-3;
  hal::Duration settle = std::chrono::milliseconds(200);
  // A joint that has not settled so long after its move is told, and ends the sequence.
  hal::Duration settle_timeout = std::chrono::seconds(5);
  std::size_t pings = 5;        // whose median is a point
  std::size_t most_pings = 15;  // tried for them, at most measurement::kMaxPings
};

struct SweepPlan {
  JointVector configuration;  // the signature configuration
  double arc_rad = kPi / 2;   // of revolute joints, as far as the limits allow
  JointVector arcs_rad;       // the same of each joint; empty: arc_rad
  // What limits and surroundings leave of each joint's sweep (limit_sweeps()); empty: the limits.
  FixedVector<JointLimits, kMaxJoints> free;
  std::size_t points = 24;       // over that arc, or over a prismatic joint's whole stroke
  std::size_t most_points = 48;  // to which a sweep that is not accurate enough is extended
  // 1 sigma of the axis, at which a sweep is long enough.
  double axis_sigma_rad = 2e-4;
  double point_sigma_m = 1e-4;
  std::size_t validation_poses = 8;  // by which a candidate is compared with the active model
  double validation_reach = 0.5;     // part of each joint's limits that they spread over
  int target = 1;                    // number of the target on the hand, which all sweeps follow
};

// How far revolute joint `joint` is swept by plan.
[[nodiscard]] inline double arc_of(const SweepPlan& plan, std::size_t joint) {
  return plan.arcs_rad.empty() ? plan.arc_rad : plan.arcs_rad[joint];
}

// The grid-touching task; empty readings: none is set up.
struct GridTask {
  evaluation::Grid grid;
  std::array<JointVector, 3> taught;  // readings at origin, x axis, xy plane of the workspace
  // How long the tool stays at each vertex after it is told, for a measuring machine to read it.
  hal::Duration dwell{};
};

// Of whether the arm still is the one that was accepted.
struct CheckPlan {
  std::size_t poses = 16;  // spread as the held-out ones
  hal::Duration every{};   // by schedule, counted from the last check or from power-up; zero: never
};

// What a signature that was sent needs before it is accepted.
enum class SentNeeds : std::uint8_t {
  kMeasured,   // to be better on validation poses, as any other
  kConfirmed,  // that, or a second person who confirms it
};

// What a joint's encoder knows at power-up.
enum class Reference : std::uint8_t {
  kAbsolute,  // where the joint is
  kNone,      // nothing: it counts from there on
  kHomed,     // nothing, until its drive has homed
};

struct Configuration {
  // With limits for every joint, which its motor keeps as well. Where joints are coupled, every
  // reading here and on the console is the effective one, of the joint and not of its motor.
  Arm drawing;
  hal::Duration period = std::chrono::milliseconds(2);
  hal::Duration feedback_age{};  // a drive that is silent for longer has failed
  JointVector resolution;        // worth of a count of each joint, rad or m; empty: not known
  FixedVector<Reference, kMaxJoints> references;  // of each joint; empty: absolute
  [[nodiscard]] Reference reference(std::size_t joint) const {
    return references.empty() ? Reference::kAbsolute : references[joint];
  }
  MotionLimits limits;
  Supervision supervision;
  Sensor sensor;
  Dwell dwell;
  SweepPlan sweeps;
  GridTask grid;
  CheckPlan check;
#ifndef ARMSIG_SMALL_IMAGE  // where it is measured
  SentNeeds sent_needs = SentNeeds::kMeasured;
#endif
  // What the whole arm stays clear of. The R5F has no memory to look at it (workspace.hpp).
  clearance::Surroundings around;
};

struct ConfigurationRefusal {
  std::string_view setting;  // "sweeps.points", ...
  Error error = Error::kNotFinite;
  std::optional<std::size_t> joint;  // from 0
  double found = 0;
  double needed = 0;
  std::string_view reason = {};  // why that is needed; may be empty
  clearance::Room room = {};     // kOutsideWorkspace: what is too near to what
};

// Works out what limits and surroundings leave of each joint's sweep about the signature
// configuration. To be called before check(), where the surroundings are not empty.
void limit_sweeps(Configuration& configuration);

// Errors: kTooFewAxes, kNotFinite, kCapacityExceeded, kLimitsReversed, kLimitsImplausible,
// kNotPositive, kJointLimit (a reading outside its limits), kPeriodInvalid, kOutOfRange (a count,
// or a value that is not plausible, with the reason of plausibility.hpp), kToleranceTooFine (below
// a count), kOutsideWorkspace (signature configuration, a sweep or the grid), kCoincidentPoints
// (corners of the grid taught at one place, or in a line), kUnsupported (a coupling that leads
// back), and those of measurement::check().
[[nodiscard]] std::expected<void, ConfigurationRefusal> check(const Configuration& configuration);

}  // namespace armsig::controller
