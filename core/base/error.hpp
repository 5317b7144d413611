// SPDX-License-Identifier: MIT
// What can go wrong in the world: one enumeration for core, hal and the controller.
//
// Mistakes of ours are assertions (core/base/check.hpp); what a sensor, a drive, a file or a person
// can do to us is an Error inside a std::expected, and every function lists the ones it can return.
#pragma once

#include <cstdint>
#include <expected>
#include <string_view>
#include <utility>

namespace armsig {

enum class Error : std::uint8_t {
  // Any stage.
  kNotFinite,         // a number is NaN or infinite
  kCapacityExceeded,  // more items than the fixed capacity holds
  kNotConverged,      // an iteration used up its bound
  kSingular,          // equations without a unique solution
  kNotPositive,       // a length or a sigma that must be positive is not
  // Measurement.
  kTooFewReceivers,     // fewer than three receivers, or fewer than three heard the target
  kReceiversCollinear,  // the receivers stand on one line
  kMirrorAmbiguity,  // the receivers stand in one plane and nothing says on which side the target
                     // is
  kRangesInconsistent,  // the ranges do not meet in a point
  kTemperatureImplausible,
  // Features.
  kTooFewPoints,      // fewer points than unknowns
  kCoincidentPoints,  // the target did not move while the joint did
  kJointDidNotMove,   // every row has the same reading
  kArcTooShort,       // the arc swept does not determine the axis
  kRadiusTooSmall,    // the target is on the axis
  kTooManyOutliers,   // no circle or line explains half of the points
  kNotACircle,  // residuals far above the noise stated: another joint moved, or the reading is
                // coupled
  // Identification.
  kMirroredSense,  // a joint turns against the sense of the arm description
  // Refinement.
  kScaleUndetermined,  // the scale was asked for, and nothing in the log has a known length
  // Kinematics.
  kNotARotation,  // the columns of a pose's R are not right-handed, perpendicular unit vectors
  kOutOfReach,
  kJointLimit,
  // Buses and drives.
  kBusDown,              // the CAN interface is down or gone
  kBusOff,               // the CAN controller took itself off the bus
  kBusBusy,              // the send queue is full
  kTooFewAxes,           // a machine without a drive
  kNodeOutOfRange,       // a CAN node number outside 1 to 127, or the master's own
  kNodeTwice,            // two devices with one node number
  kScaleInvalid,         // counts, gear ratio or lead not positive, or not what the drive says
  kResolutionTooCoarse,  // a count is worth more than an encoder's count can be: a wrong unit
  kLimitsReversed,       // the lower limit is not below the upper one
  kLimitsImplausible,    // limits no arm has: a wrong unit
  kPositionOverflow,     // a position that 32-bit counts cannot hold
  kPeriodInvalid,        // a cycle, heartbeat or speed setting that the wire cannot carry
  kBusOverload,          // the frames of one cycle need more of the bus than is allowed
  kDrivesNotReady,       // a drive is not set up or is faulted
  kTargetStep,           // the target moved further in a tick than the joint's speed allows
  kDriveAbsent,          // no boot-up message after the reset
  kDriveWrongType,       // the device is not a CiA 402 drive or lacks the mode
  kDriveEmergency,       // the drive sent an emergency message
  kDriveFault,           // the drive is in the state Fault
  kDriveDroppedOut,      // the drive left the state it was commanded to hold
  kDriveRebooted,        // a boot-up message in operation
  kDriveNotOperational,  // a heartbeat tells another NMT state than Operational
  kHeartbeatLost,        // no heartbeat within the consumer time
  kFeedbackLost,         // no position from the drive after SYNC
  kFeedbackImplausible,  // a position that the joint cannot have reached
  kTransitionTimeout,    // a commanded CiA 402 transition did not happen
  kSecondMaster,         // somebody else sends the master's frames
  kSdoTimeout,           // no answer to an SDO request after every retry
  kSdoAborted,           // the drive aborted an SDO transfer
  kSdoUnexpectedValue,   // an object holds another value than the one needed
  // Range sensor.
  kProfileInvalid,   // a register profile or sensor description that contradicts itself
  kSensorPortGone,   // the serial port of the sensor is missing or can't be opened
  kSensorSilent,     // no answer within the time allowed
  kSensorStale,      // the sequence number does not advance
  kSensorBadCrc,     // a frame with a wrong checksum
  kSensorWrongUnit,  // an answer from another unit or to another function
  kSensorException,  // the sensor answered with a Modbus exception
  kSensorMalformed,  // an answer of a wrong length or with impossible content
  // Storage, console and operating system.
  kAddressOutOfRange,  // outside the memory, or not on a page or sector boundary
  kNotErased,          // a page is programmed that was not erased
  kStorageFull,        // no space on the device
  kStorageFault,       // the device failed
  kStorageReplaced,    // the file of the storage was removed or replaced
  kStorageLayout,      // the storage was made by another version, for another layout
  kLineTooLong,        // a console line above its bound
  kNotText,            // a console line with bytes that are no text
  kCharactersLost,     // a serial line was not emptied in time
  kConsoleGone,        // the client has left or does not take its replies
  kSystemRefused,      // the operating system refused a resource
  // Controller.
  kWrongMode,              // the controller's mode does not allow the request
  kQuickStop,              // the operator stopped the arm
  kFollowingError,         // a joint is too far from where it is commanded to be
  kLateTick,               // the servo tick came too late
  kSingularPath,           // the line passes a singular configuration
  kSpeedLimit,             // the line would need a joint faster than its limit
  kOutOfRange,             // a count, share or argument outside its range
  kUnsupported,            // the arm or the request is of a kind that is not supported
  kUnknownRequest,         // a console line with an unknown verb or key
  kContradiction,          // two keys of a request tell the same quantity
  kAirChanged,             // the air temperature jumped
  kSequenceStopped,        // the sequence was ended before it was done
  kNoCandidate,            // there is no candidate signature
  kCandidateNoBetter,      // the candidate has not beaten the active model on held-out poses
  kNoSignature,            // no signature, or no former one, is stored
  kRecordCorrupt,          // a stored record fails its check
  kRecordUnsuitable,       // a stored record is of another arm
  kRecordOtherMachine,     // a stored record is of other drives or another drawing
  kDrawingUnacknowledged,  // a stored signature is not in use, and nobody has acknowledged that
  kNotSettled,             // a joint did not settle within the time and tolerance configured
  kArmMoved,               // a joint left its place while a point was measured
  kToleranceTooFine,       // a tolerance below the worth of one count
  kOutsideWorkspace,       // the arm would leave the box that it is to stay in
  kPointTimeout,           // readings of the sensor come, but none of them gives a point
  // What a drive says of itself while it is enabled.
  kTargetsIgnored,  // the target is not followed
  kDriveLimited,    // an internal limit, for longer than allowed
  kDriveLags,       // a following error, for longer than allowed
  kDriveWarning,    // a warning, for longer than allowed
  kVoltageLost,     // the motor supply is gone
  kStopTimeout,     // a joint did not come to rest in the time that its ramp may take
};

// A short English phrase for `error`, without a full stop.
[[nodiscard]] std::string_view describe(Error error);

template <typename T>
using Result = std::expected<T, Error>;

// An error with the two numbers that a person needs to see: what was found, and what was needed (SI
// units; for kArcTooShort the arc and the least arc, for kRadiusTooSmall the radius and the least
// radius, ...).
struct Refusal {
  Error error = Error::kNotFinite;
  double found = 0;
  double needed = 0;
};

template <typename T>
using Judged = std::expected<T, Refusal>;

}  // namespace armsig

// NOLINTBEGIN(bugprone-macro-parentheses): `name` is declared, and can't be in parentheses
// ARMSIG_TRY(name, expression): binds `name` to the value of a Result, or returns its error from
// this function.
#define ARMSIG_TRY(name, expression)                                                \
  auto name##_or_error = (expression);                                              \
  if (!name##_or_error) return std::unexpected(std::move(name##_or_error).error()); \
  auto& name = *name##_or_error
// NOLINTEND(bugprone-macro-parentheses)
