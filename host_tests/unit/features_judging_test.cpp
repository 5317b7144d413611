// SPDX-License-Identifier: MIT
// Points that wait, judged on top of those accepted before.
#include <gtest/gtest.h>

#include "core/features/judging.hpp"
#include "host_tests/support/simulated_sweep.hpp"

namespace armsig::features {
namespace {

constexpr double kSigma = 1e-4;

// On a line along x, one metre a metre.
SweepPoint on_the_line(double reading) {
  return {reading, Vector3(reading, 0, 0), test::isotropic(kSigma)};
}

// Of three points alone any two agree with each other: what is accepted already says which is off.
TEST(Judging, believes_the_one_point_that_was_accepted_before) {
  MotionStatistics accepted(JointType::kPrismatic, on_the_line(0));
  accepted.add(on_the_line(0));
  for (std::size_t off = 0; off < 3; ++off) {
    WaitingPoints waiting{on_the_line(1), on_the_line(2), on_the_line(3)};
    waiting[off].p_S.y() += 0.1;
    Judging judging(accepted, true, waiting);
    while (judging.step()) {
    }
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(judging.result()[i], i != off) << off;
  }
}

}  // namespace
}  // namespace armsig::features
