// SPDX-License-Identifier: MIT
// What a sequence has measured, in the log's own room and in what was lent to it.
#include "firmware/controller/measurement_log.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace armsig::controller {
namespace {

LogEntry logged(std::size_t number) {
  return {1 + number % 6, number % 8, JointVector{0.25, -0.5},
          Vector3(0.001 * static_cast<double>(number), 0, 0), 1e-4};
}

TEST(MeasurementLog, goes_on_in_the_room_that_it_was_lent) {
  const auto log = std::make_unique<MeasurementLog>();
  std::vector<LogEntry> further(3);
  EXPECT_EQ(log->capacity(), kMostLogged);
  log->extend(further);
  ASSERT_EQ(log->capacity(), kMostLogged + 3);
  for (std::size_t k = 0; k < kMostLogged + 3; ++k) {
    EXPECT_FALSE(log->full());
    log->push_back(logged(k));
  }
  EXPECT_TRUE(log->full());
  for (const std::size_t k : {std::size_t{0}, kMostLogged - 1, kMostLogged, kMostLogged + 2}) {
    EXPECT_EQ((*log)[k].sweep(), 1 + k % 6) << k;
    EXPECT_EQ((*log)[k].pings(), k % 8) << k;
    EXPECT_NEAR((*log)[k].p_S().x(), 0.001 * static_cast<double>(k), LogEntry::kPlaceStep_m) << k;
    EXPECT_EQ((*log)[k].readings()[1], -0.5) << k;
  }
  log->clear();
  EXPECT_EQ(log->size(), 0U);
}

}  // namespace
}  // namespace armsig::controller
