// SPDX-License-Identifier: MIT
#include "core/base/error.hpp"

namespace armsig {

std::string_view describe(Error error) {
  switch (error) {
    case Error::kNotFinite:
      return "a number is not finite";
    case Error::kCapacityExceeded:
      return "more items than the fixed capacity holds";
    case Error::kNotConverged:
      return "the iteration did not converge within its bound";
    case Error::kSingular:
      return "the equations have no unique solution";
    case Error::kNotPositive:
      return "a length or a sigma that must be positive is not";
    case Error::kTooFewReceivers:
      return "fewer than three receivers heard the target";
    case Error::kReceiversCollinear:
      return "the receivers stand on one line";
    case Error::kMirrorAmbiguity:
      return "the receivers stand in one plane and nothing says on which side the target is";
    case Error::kRangesInconsistent:
      return "the ranges do not meet in a point";
    case Error::kTemperatureImplausible:
      return "the air temperature is implausible";
    case Error::kTooFewPoints:
      return "fewer points than unknowns";
    case Error::kCoincidentPoints:
      return "the target did not move while the joint did";
    case Error::kJointDidNotMove:
      return "the joint did not move";
    case Error::kArcTooShort:
      return "the arc is too short to tell the axis";
    case Error::kRadiusTooSmall:
      return "the target is on the joint axis";
    case Error::kTooManyOutliers:
      return "no circle or line explains half of the points";
    case Error::kNotACircle:
      return "the points do not follow the joint's motion";
    case Error::kMirroredSense:
      return "the joint turns against the sense of the arm description";
    case Error::kScaleUndetermined:
      return "the scale needs a reference path, a prismatic joint or a prior";
    case Error::kNotARotation:
      return "the matrix is not a rotation";
    case Error::kOutOfReach:
      return "the pose is out of reach";
    case Error::kJointLimit:
      return "a joint limit is in the way";
    case Error::kBusDown:
      return "the CAN interface is down or gone";
    case Error::kBusOff:
      return "the CAN controller is bus-off";
    case Error::kBusBusy:
      return "the CAN send queue stays full";
    case Error::kTooFewAxes:
      return "no drive is configured";
    case Error::kNodeOutOfRange:
      return "a CAN node number is outside 1 to 127 or is the master's own";
    case Error::kNodeTwice:
      return "two devices share one CAN node number";
    case Error::kScaleInvalid:
      return "counts per revolution, gear ratio or lead is not a positive number, or not what "
             "the drive says";
    case Error::kResolutionTooCoarse:
      return "one count is too large a motion: counts per revolution or gear ratio is in a wrong "
             "unit";
    case Error::kLimitsReversed:
      return "the lower joint limit is not below the upper one";
    case Error::kLimitsImplausible:
      return "the joint limits are larger than any arm's: wrong unit";
    case Error::kPositionOverflow:
      return "the position does not fit into the drive's 32-bit counts";
    case Error::kPeriodInvalid:
      return "a period or speed setting is not usable";
    case Error::kBusOverload:
      return "the CAN bus would be loaded above its limit";
    case Error::kDrivesNotReady:
      return "a drive is not set up or is faulted";
    case Error::kTargetStep:
      return "the target steps faster than the joint's speed limit";
    case Error::kDriveAbsent:
      return "the drive did not answer the reset";
    case Error::kDriveWrongType:
      return "the device is not a CiA 402 drive with cyclic synchronous position mode";
    case Error::kDriveEmergency:
      return "the drive sent an emergency message";
    case Error::kDriveFault:
      return "the drive is in its fault state";
    case Error::kDriveDroppedOut:
      return "the drive left its commanded state by itself";
    case Error::kDriveRebooted:
      return "the drive restarted";
    case Error::kDriveNotOperational:
      return "the drive left the NMT state Operational";
    case Error::kHeartbeatLost:
      return "the drive's heartbeat is lost";
    case Error::kFeedbackLost:
      return "the drive's position feedback is lost";
    case Error::kFeedbackImplausible:
      return "the drive's position jumped";
    case Error::kTransitionTimeout:
      return "the drive did not change its state in time";
    case Error::kTargetsIgnored:
      return "the drive does not follow its targets";
    case Error::kDriveLimited:
      return "the drive limits the motion by itself";
    case Error::kDriveLags:
      return "the drive reports a following error";
    case Error::kDriveWarning:
      return "the drive's warning persists";
    case Error::kVoltageLost:
      return "the drive has lost its motor supply";
    case Error::kStopTimeout:
      return "the joint did not come to rest in time";
    case Error::kSecondMaster:
      return "another master commands the drives";
    case Error::kSdoTimeout:
      return "the drive did not answer an SDO request";
    case Error::kSdoAborted:
      return "the drive refused an SDO request";
    case Error::kSdoUnexpectedValue:
      return "an object of the drive holds another value than the one needed";
    case Error::kProfileInvalid:
      return "the sensor profile contradicts itself";
    case Error::kSensorPortGone:
      return "the range sensor's serial port is missing or cannot be opened";
    case Error::kSensorSilent:
      return "the range sensor is silent";
    case Error::kSensorStale:
      return "the range sensor repeats an old reading";
    case Error::kSensorBadCrc:
      return "the range sensor's answer has a wrong checksum";
    case Error::kSensorWrongUnit:
      return "the answer is from another Modbus unit or function";
    case Error::kSensorException:
      return "the range sensor answered with an exception";
    case Error::kSensorMalformed:
      return "the range sensor's answer is malformed";
    case Error::kPointTimeout:
      return "the range sensor's readings give no point in time";
    case Error::kAddressOutOfRange:
      return "the address is outside the memory or not aligned";
    case Error::kNotErased:
      return "the page is not erased";
    case Error::kStorageFull:
      return "the storage is full";
    case Error::kStorageFault:
      return "the storage failed";
    case Error::kStorageReplaced:
      return "the file of the storage was removed or replaced";
    case Error::kStorageLayout:
      return "the storage was made by another version of the program";
    case Error::kLineTooLong:
      return "the line is too long";
    case Error::kNotText:
      return "the line is not text";
    case Error::kCharactersLost:
      return "characters of the serial line were lost";
    case Error::kConsoleGone:
      return "the console client is gone";
    case Error::kSystemRefused:
      return "the operating system refused a resource";
    case Error::kWrongMode:
      return "the present mode does not allow it";
    case Error::kQuickStop:
      return "the arm was stopped by the operator";
    case Error::kFollowingError:
      return "the joint is too far from its commanded position";
    case Error::kLateTick:
      return "the servo tick came too late";
    case Error::kSingularPath:
      return "the path passes a singular configuration";
    case Error::kSpeedLimit:
      return "the path needs a joint faster than its limit";
    case Error::kOutOfRange:
      return "a value is outside its range";
    case Error::kUnsupported:
      return "this kind of arm or request is not supported";
    case Error::kUnknownRequest:
      return "the request or one of its keys is unknown";
    case Error::kContradiction:
      return "two keys of the request tell the same quantity";
    case Error::kAirChanged:
      return "the air temperature jumped";
    case Error::kSequenceStopped:
      return "the sequence was stopped";
    case Error::kNoCandidate:
      return "there is no candidate signature";
    case Error::kCandidateNoBetter:
      return "the candidate has not beaten the active model on held-out poses";
    case Error::kNoSignature:
      return "no such signature is stored";
    case Error::kRecordCorrupt:
      return "the stored record is corrupt";
    case Error::kRecordUnsuitable:
      return "the stored record is of another arm";
    case Error::kNotSettled:
      return "the joint did not settle in time";
    case Error::kArmMoved:
      return "the arm moved while a point was measured";
    case Error::kOutsideWorkspace:
      return "outside its box";
    case Error::kToleranceTooFine:
      return "the tolerance is below one count of the encoder";
    case Error::kRecordOtherMachine:
      return "the stored record is of other drives or another drawing";
    case Error::kDrawingUnacknowledged:
      return "a stored signature is not in use, and nobody has acknowledged that";
  }
  return "unknown error";
}

}  // namespace armsig
