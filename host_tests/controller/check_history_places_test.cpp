// SPDX-License-Identifier: MIT
// Checks that tell nothing: of places that the reference does not know, on one line, or without a
// noise to compare with.
#include <gtest/gtest.h>

#include "firmware/controller/check_history.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::controller {
namespace {

constexpr double kNoise_m = 0.1e-3;
constexpr double kAccepted_m = 0.2e-3;

// Eight poses from place `first` on, all off by `residual_m` to and fro; in a line or not.
MeasuredCheck checked_at(std::uint8_t first, double residual_m, bool in_line = false) {
  MeasuredCheck check{.poses = {}, .places = {}, .sigma_m = kNoise_m};
  for (std::uint8_t i = 0; i < 8; ++i) {
    const double bent = in_line ? 0 : 0.05 * i * i;
    const double sign = i % 2 == 0 ? 1 : -1;
    check.poses.push_back({.p_R = Vector3(0.1 * i, bent, in_line ? 0 : 0.2 * (i % 3)),
                           .residual_m = Vector3(0, 0, sign * residual_m)});
    check.places.push_back(static_cast<std::uint8_t>(first + i));
  }
  return check;
}

Result<CheckReport> taken(CheckHistory& history, MeasuredCheck checked) {
  return history.take(checked, kAccepted_m);
}

void learn(CheckHistory& history, int checks, bool in_line = false) {
  for (int i = 0; i < checks; ++i) {
    const auto report = taken(history, checked_at(0, 1e-6, in_line));
    ASSERT_TRUE(report);
    ASSERT_EQ(report->verdict, CheckVerdict::kAsAccepted) << i;
    ASSERT_EQ(report->learnt, i + 1);
  }
}

TEST(CheckHistoryPlaces, that_the_reference_does_not_know_count_for_nothing) {
  CheckHistory history;
  history.begin(1, 100);
  ASSERT_NO_FATAL_FAILURE(learn(history, 1));
  EXPECT_TRUE(taken(history, checked_at(2, 1e-6))) << "six are known";
  CheckHistory other;
  other.begin(1, 100);
  ASSERT_NO_FATAL_FAILURE(learn(other, 1));
  EXPECT_EQ(test::failure_of(taken(other, checked_at(3, 1e-6))), Error::kTooFewPoints)
      << "five are";
}

TEST(CheckHistoryPlaces, on_one_line_do_not_tell_what_moved) {
  CheckHistory first;
  first.begin(1, 100);
  EXPECT_EQ(test::failure_of(taken(first, checked_at(0, 5e-3, true))), Error::kSingular);
  for (const int learnt : {5, kCheckBaseline}) {
    CheckHistory history;
    history.begin(1, 100);
    ASSERT_NO_FATAL_FAILURE(learn(history, learnt, true));
    EXPECT_EQ(test::failure_of(taken(history, checked_at(0, 5e-3, true))), Error::kSingular)
        << learnt;
  }
}

TEST(CheckHistory, without_noise_is_refused) {
  CheckHistory history;
  history.begin(1, 100);
  for (const double sigma_m : {0.0, -1e-4}) {
    MeasuredCheck checked = checked_at(0, 1e-6);
    checked.sigma_m = sigma_m;
    EXPECT_EQ(test::failure_of(taken(history, checked)), Error::kNotPositive);
  }
}

TEST(CheckVerdict, is_told_in_words) {
  EXPECT_EQ(describe(CheckVerdict::kAsAccepted), "as accepted");
  EXPECT_EQ(describe(CheckVerdict::kDrifting), "drifting");
  EXPECT_EQ(describe(CheckVerdict::kStepped), "stepped");
  EXPECT_EQ(describe(CheckVerdict::kReferenceMoved), "the reference moved");
  EXPECT_EQ(describe(CheckVerdict::kNotMeasured), "could not measure");
}

}  // namespace
}  // namespace armsig::controller
