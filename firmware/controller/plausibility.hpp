// SPDX-License-Identifier: MIT
// What no arm, sensor or cabinet is like: every bound on a configured value that is not a matter of
// arithmetic, with its reason, in one place. Wide on purpose: a value beyond it is a slip of unit
// or of the pen. check() holds a configuration against them, whether it was read from a file or
// built into an image. SI units.
#pragma once

#include <string_view>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::controller {

struct Bounds {
  double lowest = 0;
  double highest = 0;
  std::string_view reason;
};

// Bounds of a value of joints, which differ by type.
struct JointBounds {
  Bounds revolute;
  Bounds prismatic;

  [[nodiscard]] constexpr const Bounds& of(JointType type) const {
    return type == JointType::kRevolute ? revolute : prismatic;
  }
};

namespace plausible {

inline constexpr JointBounds kLimit{
    {-20 * kPi, 20 * kPi, "no joint turns further than ten times round: degrees as radians?"},
    {-100, 100, "no slide is longer than a hundred metres: millimetres as metres?"}};
inline constexpr JointBounds kSpeed{
    {1e-4, 40, "a joint turns between an hour and a sixth of a second a turn: degrees as radians?"},
    {1e-6, 20, "a slide moves at 20 m/s at most: millimetres as metres?"}};
inline constexpr JointBounds kAcceleration{
    {1e-3, 4000, "a joint speeds up at 4000 rad/s2 at most: degrees as radians?"},
    {1e-5, 400, "a slide speeds up at 400 m/s2 at most: millimetres as metres?"}};
inline constexpr JointBounds kFollowingError{
    {1e-5, kPi, "a joint half a turn from where it is commanded follows nothing"},
    {1e-6, 0.5, "a prismatic joint half a metre from where it is commanded follows nothing"}};
inline constexpr JointBounds kMotorSpeed{
    {1e-4, 100, "no motor is as fast, and no position would be an outlier: degrees as radians?"},
    {1e-6, 50, "no motor is as fast, and no position would be an outlier: millimetres as metres?"}};
inline constexpr Bounds kLatestTick{
    50e-6, 5, "a moving arm is not supervised for as long as a tick may be late"};
inline constexpr Bounds kToolSpeed{1e-5, 20,
                                   "no arm moves its tool faster: millimetres as metres?"};
inline constexpr Bounds kToolTurnRate{1e-4, 40,
                                      "no arm turns its tool faster: degrees as radians?"};
inline constexpr Bounds kLeastRegularity{
    1e-6, 0.5,
    "0 is a singular configuration and 1 the best there is: every line would be refused"};
inline constexpr Bounds kAir{-40, 85, "degrees Celsius that a sensor works at: kelvins?"};
inline constexpr Bounds kAirStep{0.01, 20, "a thermometer's noise, or a fire"};
inline constexpr Bounds kRangeSigma{1e-7, 0.1, "of one range, in metres: millimetres as metres?"};
inline constexpr Bounds kInstrumentSigma{1e-6, 0.05,
                                         "of a point, in metres: millimetres as metres?"};
inline constexpr Bounds kPointAge{0, 60, "no instrument tells a point as late"};
inline constexpr Bounds kReceiver{-100, 100, "a receiver a hundred metres away hears nothing"};
inline constexpr Bounds kAnchor{-100, 100,
                                "no length is as far or as long: millimetres as metres?"};
inline constexpr Bounds kEmitter{-10, 10,
                                 "no target is as far from a flange: millimetres as metres?"};
inline constexpr Bounds kPollPeriod{1e-3, 10, "no sensor measures as often or as seldom"};
inline constexpr Bounds kAnswerTimeout{1e-3, 10, "no sensor answers as soon or as late"};
inline constexpr Bounds kSecondsAStep{1e-12, 1e-4, "of a flight time, in seconds"};
inline constexpr Bounds kPointStep{1e-9, 1, "of a coordinate, in metres: millimetres as metres?"};
inline constexpr Bounds kMetresAStep{1e-7, 0.01,
                                     "of a distance, in metres: millimetres as metres?"};
// A number with a point may be in any unit from metres and seconds down.
inline constexpr Bounds kStepOfFloat{1e-12, 1, "of a number that has a point of its own"};
inline constexpr Bounds kSpeedOfSound{300, 380, "of air, in m/s, from -40 to 85 degrees Celsius"};
inline constexpr Bounds kOffset{-10, 10, "of a range, in metres: millimetres as metres?"};
inline constexpr Bounds kOffsetTime{-0.03, 0.03,
                                    "of a flight, in seconds: milliseconds as seconds?"};
inline constexpr Bounds kCelsiusAStep{1e-4, 10, "of a temperature, in kelvins"};
inline constexpr Bounds kReadingTimeout{
    1e-3, 60, "a sequence would stand still for as long with a sensor that is gone"};
inline constexpr Bounds kDwellTolerance{1e-7, 0.02,
                                        "a joint that far from its place does not stand still"};
inline constexpr Bounds kSettle{0, 60, "every point of a sweep would take as long"};
inline constexpr Bounds kSettleTimeout{
    1e-3, 120, "a joint that does not settle would hold a sequence for as long"};
inline constexpr Bounds kArc{0.05, 2 * kPi,
                             "a shorter arc tells no axis, a longer one nothing new"};
inline constexpr Bounds kAxisSigma{1e-7, 0.1, "of an axis, in radians: degrees as radians?"};
inline constexpr Bounds kPointSigma{1e-8, 0.1, "of a point, in metres: millimetres as metres?"};
inline constexpr Bounds kHeldOutReach{1e-3, 1, "a part of the joint limits"};
inline constexpr Bounds kWorkspace{-100, 100, "no arm is as large: millimetres as metres?"};
inline constexpr Bounds kHand{0, 5, "no tool is as long: millimetres as metres?"};
inline constexpr Bounds kGridSize{1e-3, 20,
                                  "an edge of the grid, in metres: millimetres as metres?"};
inline constexpr Bounds kGridDwell{0, 3600, "the tool would stay at each vertex for as long"};
// A joint that can't be stopped keeps its torque for as long.
inline constexpr double kLongestStop_s = 60;
// Between two corners of the grid, which are taught at different places.
inline constexpr double kLeastTaughtDistance_m = 1e-3;

}  // namespace plausible
}  // namespace armsig::controller
