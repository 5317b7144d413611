// SPDX-License-Identifier: MIT
// Every error with its words, a short English phrase without a full stop:
// ARMSIG_ERROR(code, words) is what the includer makes of one.

// Any stage.
ARMSIG_ERROR(kNotFinite, "a number is not finite")
ARMSIG_ERROR(kCapacityExceeded, "more items than the fixed capacity holds")
ARMSIG_ERROR(kNotConverged, "the iteration did not converge within its bound")
ARMSIG_ERROR(kSingular, "the equations have no unique solution")
ARMSIG_ERROR(kNotPositive, "a length or a sigma that must be positive is not")

// Measurement.
ARMSIG_ERROR(kTooFewReceivers, "fewer than three receivers heard the target")
ARMSIG_ERROR(kReceiversCollinear, "the receivers stand on one line")
ARMSIG_ERROR(kMirrorAmbiguity,
             "the receivers stand in one plane and nothing says on which side the target is")
ARMSIG_ERROR(kRangesInconsistent, "the ranges do not meet in a point")
ARMSIG_ERROR(kTemperatureImplausible, "the air temperature is implausible")

// Features.
ARMSIG_ERROR(kTooFewPoints, "fewer points than unknowns")
ARMSIG_ERROR(kCoincidentPoints, "the target did not move while the joint did")
ARMSIG_ERROR(kJointDidNotMove, "the joint did not move")  // every row has the same reading
ARMSIG_ERROR(kArcTooShort, "the arc is too short to tell the axis")
ARMSIG_ERROR(kRadiusTooSmall, "the target is on the joint axis")
ARMSIG_ERROR(kTooManyOutliers, "no circle or line explains half of the points")
// Far beyond the noise stated: another joint moved, or the reading is coupled:
ARMSIG_ERROR(kNotACircle, "the points do not follow the joint's motion")

// Identification.
ARMSIG_ERROR(kMirroredSense, "the joint turns against the sense of the arm description")

// Refinement.
// It was asked for, and nothing in the log has a known length:
ARMSIG_ERROR(kScaleUndetermined, "the scale needs a reference path, a prismatic joint or a prior")

// Kinematics.
// A pose's R: columns that are not right-handed, perpendicular unit vectors:
ARMSIG_ERROR(kNotARotation, "the matrix is not a rotation")
ARMSIG_ERROR(kOutOfReach, "the pose is out of reach")
ARMSIG_ERROR(kJointLimit, "a joint limit is in the way")

// Buses and drives.
ARMSIG_ERROR(kBusDown, "the CAN interface is down or gone")
ARMSIG_ERROR(kBusOff, "the CAN controller is bus-off")
ARMSIG_ERROR(kBusBusy, "the CAN send queue stays full")
ARMSIG_ERROR(kTooFewAxes, "no drive is configured")
ARMSIG_ERROR(kNodeOutOfRange, "a CAN node number is outside 1 to 127 or is the master's own")
ARMSIG_ERROR(kNodeTwice, "two devices share one CAN node number")
ARMSIG_ERROR(kScaleInvalid,
             "counts per revolution, gear ratio or lead is not a positive number, or not what the "
             "drive says")
ARMSIG_ERROR(
    kResolutionTooCoarse,
    "one count is too large a motion: counts per revolution or gear ratio is in a wrong unit")
ARMSIG_ERROR(kLimitsReversed, "the lower joint limit is not below the upper one")
ARMSIG_ERROR(kLimitsImplausible, "the joint limits are larger than any arm's: wrong unit")
ARMSIG_ERROR(kPositionOverflow, "the position does not fit into the drive's 32-bit counts")
ARMSIG_ERROR(kPeriodInvalid, "a period or speed setting is not usable")  // on the wire
ARMSIG_ERROR(kBusOverload, "the CAN bus would be loaded above its limit")
ARMSIG_ERROR(kDrivesNotReady, "a drive is not set up or is faulted")
ARMSIG_ERROR(kTargetStep, "the target steps faster than the joint's speed limit")
ARMSIG_ERROR(kDriveAbsent, "the drive did not answer the reset")  // no boot-up message
ARMSIG_ERROR(kDriveWrongType, "the device is not a CiA 402 drive with the mode that is configured")
ARMSIG_ERROR(kDriveEmergency, "the drive sent an emergency message")
ARMSIG_ERROR(kDriveFault, "the drive is in its fault state")
ARMSIG_ERROR(kDriveDroppedOut, "the drive left its commanded state by itself")
ARMSIG_ERROR(kDriveRebooted, "the drive restarted")  // a boot-up message in operation
ARMSIG_ERROR(kDriveNotOperational, "the drive left the NMT state Operational")  // by its heartbeat
ARMSIG_ERROR(kHeartbeatLost, "the drive's heartbeat is lost")  // none within the consumer time
ARMSIG_ERROR(kFeedbackLost, "the drive's position feedback is lost")  // none after SYNC
ARMSIG_ERROR(kFeedbackImplausible, "the drive's position jumped")     // further than it can
ARMSIG_ERROR(kTransitionTimeout, "the drive did not change its state in time")
ARMSIG_ERROR(kSecondMaster, "another master commands the drives")     // sends its frames
ARMSIG_ERROR(kSdoTimeout, "the drive did not answer an SDO request")  // nor any retry
ARMSIG_ERROR(kSdoAborted, "the drive refused an SDO request")
ARMSIG_ERROR(kSdoUnexpectedValue, "an object of the drive holds another value than the one needed")

// Sensor: of ranges, or of points.
ARMSIG_ERROR(kNoSensor, "no sensor is configured")
ARMSIG_ERROR(kProfileInvalid, "the sensor profile contradicts itself")
ARMSIG_ERROR(kSensorPortGone, "the sensor is not connected")
ARMSIG_ERROR(kSensorSilent, "the sensor is silent")  // no answer within the time allowed
ARMSIG_ERROR(kSensorStale, "the sensor repeats an old reading")  // by its sequence number
ARMSIG_ERROR(kSensorBadCrc, "the sensor's answer has a wrong checksum")
ARMSIG_ERROR(kSensorWrongUnit, "the answer is from another Modbus unit or function")
ARMSIG_ERROR(kSensorException, "the sensor answered with an exception")  // of Modbus
ARMSIG_ERROR(kSensorMalformed, "the sensor's answer is malformed")       // in length or content

// Storage, console and operating system.
ARMSIG_ERROR(kAddressOutOfRange,
             "the address is outside the memory or not aligned")  // to a page or sector
ARMSIG_ERROR(kNotErased, "the page is not erased")                // that is to be programmed
ARMSIG_ERROR(kStorageFull, "the storage is full")
ARMSIG_ERROR(kStorageFault, "the storage failed")
ARMSIG_ERROR(kStorageReplaced, "the file of the storage was removed or replaced")
ARMSIG_ERROR(kStorageLayout, "the storage was made by another version of the program")
ARMSIG_ERROR(kLineTooLong, "the line is too long")  // of a console
ARMSIG_ERROR(kNotText, "the line is not text")
ARMSIG_ERROR(kCharactersLost, "characters of the serial line were lost")
ARMSIG_ERROR(kConsoleGone, "the console client is gone")  // or does not take its replies
ARMSIG_ERROR(kSystemRefused, "the operating system refused a resource")

// Controller.
ARMSIG_ERROR(kWrongMode, "the present mode does not allow it")
ARMSIG_ERROR(kQuickStop, "the arm was stopped by the operator")
ARMSIG_ERROR(kFollowingError, "the joint is too far from its commanded position")
ARMSIG_ERROR(kTorqueTooLarge, "a joint needs too much torque")
ARMSIG_ERROR(kLateTick, "the servo tick came too late")
ARMSIG_ERROR(kSingularPath, "the path passes a singular configuration")
ARMSIG_ERROR(kSpeedLimit, "the path needs a joint faster than its limit")
ARMSIG_ERROR(kOutOfRange, "a value is outside its range")  // a count, share or argument
ARMSIG_ERROR(kUnsupported, "this kind of arm or request is not supported")
ARMSIG_ERROR(kUnknownRequest, "the request or one of its keys is unknown")
ARMSIG_ERROR(kContradiction, "two keys of the request tell the same quantity")
ARMSIG_ERROR(kAirChanged, "the air temperature jumped")
ARMSIG_ERROR(kSequenceStopped, "the sequence was stopped")
ARMSIG_ERROR(kNoCandidate, "there is no candidate signature")
ARMSIG_ERROR(kCandidateNoBetter,
             "the candidate has not beaten the active model on validation poses")
ARMSIG_ERROR(kNotConfirmed, "no second person has confirmed it")
ARMSIG_ERROR(kNoSignature, "no such signature is stored")     // or no former one
ARMSIG_ERROR(kRecordCorrupt, "the stored record is corrupt")  // by its own check
ARMSIG_ERROR(kRecordUnsuitable, "the stored record is of another arm")
ARMSIG_ERROR(kRecordOtherMachine,
             "the stored record is of another gear, encoder zero or nominal model")
ARMSIG_ERROR(kDrawingUnacknowledged,
             "a stored signature is not in use, and nobody has acknowledged that")
ARMSIG_ERROR(kUnreferenced, "a joint may stand elsewhere than it reads")
ARMSIG_ERROR(kNotSettled, "the joint did not settle in time")  // within its tolerance
ARMSIG_ERROR(kArmMoved, "the arm moved while a point was measured")
ARMSIG_ERROR(kToleranceTooFine, "the tolerance is below one count of the encoder")
ARMSIG_ERROR(kOutsideWorkspace, "too near to the floor, its box or itself")  // of the whole arm
ARMSIG_ERROR(kPointsDiffer, "the points differ by more than their sigma")
ARMSIG_ERROR(kPointTimeout, "the sensor's readings give no point in time")

// What a drive says of itself while it is enabled.
ARMSIG_ERROR(kTargetsIgnored, "the drive does not follow its targets")
ARMSIG_ERROR(kDriveLimited, "the drive limits the motion by itself")  // for longer than allowed
ARMSIG_ERROR(kDriveLags, "the drive reports a following error")       // for longer than allowed
ARMSIG_ERROR(kDriveWarning, "the drive's warning persists")           // for longer than allowed
ARMSIG_ERROR(kVoltageLost, "the drive has lost its motor supply")
ARMSIG_ERROR(kHomingFailed, "the drive did not find its reference")
ARMSIG_ERROR(kStopTimeout, "the joint did not come to rest in time")  // that its ramp may take
ARMSIG_ERROR(kDriveUnsupervised, "a drive would keep its torque if this controller were gone")
