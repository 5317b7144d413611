// SPDX-License-Identifier: MIT
// Which errors of a point are the place's, and which the sensor's.
#include "firmware/controller/pose_visit.hpp"

#include <gtest/gtest.h>

namespace armsig::controller {
namespace {

TEST(PoseVisit, blames_the_place_where_the_ranges_do_not_say_where_the_target_is) {
  for (const Error error :
       {Error::kTooFewReceivers, Error::kReceiversCollinear, Error::kMirrorAmbiguity,
        Error::kRangesInconsistent, Error::kSingular}) {
    EXPECT_TRUE(is_of_the_place(error)) << describe(error);
  }
  for (const Error error : {Error::kSensorSilent, Error::kSensorStale, Error::kPointTimeout,
                            Error::kAirChanged, Error::kTemperatureImplausible}) {
    EXPECT_FALSE(is_of_the_place(error)) << describe(error);
  }
}

}  // namespace
}  // namespace armsig::controller
