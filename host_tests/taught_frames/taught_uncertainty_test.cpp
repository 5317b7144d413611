// SPDX-License-Identifier: MIT
// What is stated of a taught frame, against what many teachings of it give.
#include <algorithm>

#include <gtest/gtest.h>

#include "firmware/host_tool/taught_frames/taught_frames.hpp"
#include "host_tests/taught_frames/taught_session.hpp"

namespace armsig::tool {
namespace {

using taught::session_of;
using taught::TaughtSession;
using taught::TrueFrames;

constexpr int kTrials = 2000;
constexpr double kSigma_m = 0.08e-3;

TaughtFrames taught_with_noise(std::mt19937& random, double stated_m) {
  TaughtSession session =
      session_of(TrueFrames{}, [&] { return taught::any_vector(random, kSigma_m); });
  auto result =
      taught_frames(session.task("torch"), {session.poses(), session.poses()}, nullptr, stated_m);
  EXPECT_TRUE(result) << render(result.error());
  return *std::move(result);
}

// Its origin, and its turn about its own axes.
Eigen::Vector<double, 6> error_of(const Pose& X, const Pose& truth) {
  Eigen::Vector<double, 6> error;
  error << X.p - truth.p, rotation_vector(truth.R.transpose() * X.R);
  return error;
}

// The mean of e^T C^-1 e / 6 over many teachings is 1, and each number's own ratio is.
TEST(TaughtUncertainty, is_what_many_teachings_show) {
  const TrueFrames of;
  std::mt19937 random(3);
  std::array<double, 2> normalized{};
  std::array<Eigen::Vector<double, 6>, 2> ratio{Eigen::Vector<double, 6>::Zero(),
                                                Eigen::Vector<double, 6>::Zero()};
  for (int trial = 0; trial < kTrials; ++trial) {
    const TaughtFrames result = taught_with_noise(random, kSigma_m);
    for (std::size_t f = 0; f < 2; ++f) {
      const FoundFrame& frame = result.frames[f];
      const Eigen::Vector<double, 6> e = error_of(frame.found.X, f == 0 ? of.X_ET : of.X_CW);
      normalized.at(f) += e.dot(frame.covariance.ldlt().solve(e)) / 6 / kTrials;
      ratio.at(f) += e.cwiseAbs2().cwiseQuotient(frame.covariance.diagonal()) / kTrials;
    }
  }
  for (std::size_t f = 0; f < 2; ++f) {
    EXPECT_NEAR(normalized.at(f), 1, 0.05) << "frame " << f;
    EXPECT_LT((ratio.at(f).array() - 1).abs().maxCoeff(), 0.12) << ratio.at(f).transpose();
  }
}

TEST(TaughtUncertainty, finds_how_well_points_were_taught_from_those_beyond_the_minimum) {
  std::mt19937 random(4);
  double squares = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const TaughtFrames result = taught_with_noise(random, 0);
    EXPECT_EQ(result.teach.source, TeachSource::kResiduals);
    EXPECT_EQ(result.teach.freedom, 7U);
    squares += result.teach.sigma_m * result.teach.sigma_m / kTrials;
  }
  EXPECT_NEAR(std::sqrt(squares) / kSigma_m, 1, 0.03);
}

TEST(TaughtUncertainty, is_assumed_where_too_few_points_are_beyond_the_minimum) {
  TaughtSession session = session_of(TrueFrames{}, taught::without_noise);
  session.rows().erase(session.rows().begin(), session.rows().begin() + 6);
  session.poses().erase(session.poses().begin(), session.poses().begin() + 6);
  const auto result = taught_frames(session.task("", TrueFrames{}.X_ET.p),
                                    {session.poses(), session.poses()}, nullptr, 0);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->teach.source, TeachSource::kAssumed);
  EXPECT_EQ(result->teach.sigma_m, kAssumedTeach_m);
  EXPECT_FALSE(result->signature_counts);
  // The origin is a touch, and a touch is as uncertain as that.
  EXPECT_NEAR(result->frames[0].origin_sigma_m().x(), kAssumedTeach_m, 1e-7);
}

TEST(TaughtUncertainty, doubts_a_stated_sigma_that_the_points_contradict) {
  std::mt19937 random(5);
  EXPECT_TRUE(taught_with_noise(random, kSigma_m).warnings.empty());
  const TaughtFrames result = taught_with_noise(random, kSigma_m / 20);
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_NE(result.warnings[0].find("--teach-sigma-mm says 0.004"), std::string::npos)
      << result.warnings[0];
}

TEST(TaughtUncertainty, names_the_touch_that_the_others_contradict) {
  std::mt19937 random(6);
  TaughtSession session =
      session_of(TrueFrames{}, [&] { return taught::any_vector(random, 0.02e-3); });
  session.add("torch", "tip",
              taught::flange_at(taught::by_abc(80, 165, 30), TrueFrames{}.X_ET.p,
                                TrueFrames{}.tip_C + Vector3(0, 0.002, 0.001)));
  const auto result =
      taught_frames(session.task("torch"), {session.poses(), session.poses()}, nullptr, 0);
  ASSERT_TRUE(result);
  ASSERT_EQ(result->warnings.size(), 1U);
  EXPECT_TRUE(result->warnings[0].starts_with("line 12: 2.2")) << result->warnings[0];
}

TEST(TaughtUncertainty, names_no_touch_of_a_session_without_mistakes) {
  std::mt19937 random(7);
  std::size_t named = 0;
  for (int trial = 0; trial < 300; ++trial) {
    TaughtSession session =
        session_of(TrueFrames{}, [&] { return taught::any_vector(random, 0.5e-3); });
    const auto result =
        taught_frames(session.task("torch"), {session.poses(), session.poses()}, nullptr, 0);
    ASSERT_TRUE(result);
    named += result->warnings.size();
  }
  EXPECT_LE(named, 12U);
}

}  // namespace
}  // namespace armsig::tool
