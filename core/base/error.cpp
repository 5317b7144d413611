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
    case Error::kJointOutOfRange:
      return "the joint number is outside the arm";
    case Error::kJointNotSwept:
      return "the joint is not swept";
    case Error::kHeldJointMoved:
      return "another joint moved during the sweep";
    case Error::kSignatureConfigurationDiffers:
      return "two sweeps hold the joint at different readings";
    case Error::kMirroredSense:
      return "the joint turns against the sense of the arm description";
    case Error::kScaleUndetermined:
      return "the scale needs a reference path, a prismatic joint or a prior";
    case Error::kOutOfReach:
      return "the pose is out of reach";
    case Error::kJointLimit:
      return "a joint limit is in the way";
  }
  return "unknown error";
}

}  // namespace armsig
