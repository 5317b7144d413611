// SPDX-License-Identifier: MIT
// A Puma of its own dimensions, identified from poses that a sensor of 0.2 mm measured.
#pragma once

#include <cstdint>
#include <memory>

#include <gtest/gtest.h>

#include "host_tests/support/calibration_case.hpp"

namespace armsig::test {

struct IdentifiedPuma {
  static constexpr double kSigma_m = 0.2e-3;

  Random random;
  Cell cell;
  std::unique_ptr<calibration::Refined> refined = std::make_unique<calibration::Refined>();

  explicit IdentifiedPuma(std::uint64_t seed, int count = 60)
      : random(seed), cell(puma_cell(random)) {
    EXPECT_TRUE(calibrate(puma(), poses(count), *refined));
  }

  // Further ones, measured by the same sensor.
  Log poses(int count) {
    Log log;
    add_poses(cell, count, kSigma_m, random, log);
    return log;
  }
};

}  // namespace armsig::test
