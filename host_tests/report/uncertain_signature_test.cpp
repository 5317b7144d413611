// SPDX-License-Identifier: MIT
// The 1 sigma of the parameters against their scatter over repeated measurements.
#include "firmware/host_tool/report/uncertain_signature.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "host_tests/support/demo_features.hpp"

namespace armsig::tool {
namespace {

SignatureRecord record_with(const Signature& signature) {
  SignatureRecord record;
  record.signature = signature;
  record.method = "encoder";
  record.nominal = puma560();
  return record;
}

TEST(ParameterSigma, is_the_scatter_of_the_parameters_over_repeated_measurements) {
  constexpr int kRepeats = 40;
  DhRows sigmas;
  std::array<double, 6> squares_m2{};
  std::array<double, 6> squares_rad2{};
  for (std::uint64_t seed = 1; seed <= kRepeats; ++seed) {
    const DemoRobot robot = measured_demo_robot(1, seed);
    const auto identified = test::found_by_features(robot);
    ASSERT_TRUE(identified);
    const Signature& found = *identified;
    if (sigmas.empty()) {
      const SignatureRecord record = record_with(found);
      const auto estimate = estimate_behind(record);
      ASSERT_TRUE(estimate);
      sigmas = parameter_sigmas(*estimate, record.nominal);
    }
    for (std::size_t i = 0; i < 6; ++i) {
      squares_m2[i] += std::pow(found.pseudo_dh[i].a_m - robot.truth.pseudo_dh[i].a_m, 2);
      squares_rad2[i] +=
          std::pow(found.pseudo_dh[i].alpha_rad - robot.truth.pseudo_dh[i].alpha_rad, 2);
    }
  }
  // a and alpha of all but the last row do not depend on how the outer frames are chosen. The
  // standard deviation of 40 squares is known to 11 %; bounds at 4 sigma of that.
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(std::sqrt(squares_m2[i] / kRepeats) / sigmas[i].a_m, 1.0, 0.5) << "a, row " << i;
    EXPECT_NEAR(std::sqrt(squares_rad2[i] / kRepeats) / sigmas[i].alpha_rad, 1.0, 0.5)
        << "alpha, row " << i;
  }
}

TEST(ParameterSigma, is_unknown_without_covariance_and_sweeps) {
  EXPECT_FALSE(estimate_behind(record_with(measured_demo_robot(0, 1).truth)));
}

}  // namespace
}  // namespace armsig::tool
