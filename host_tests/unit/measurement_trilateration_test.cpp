// SPDX-License-Identifier: MIT
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/measurement/trilateration.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::measurement {
namespace {

constexpr double kSigma = 0.2e-3;  // metres

ReceiverArray array_of(const Points& p_S, const Vector3& facing_S = Vector3::Zero()) {
  return {.p_S = p_S, .range_sigma_m = kSigma, .facing_S = facing_S};
}

// Five receivers that fill space.
ReceiverArray five() {
  return array_of({{0, 0, 0}, {2, 0, 0.1}, {2, 1.5, 0}, {0, 1.5, 0.3}, {1, 0.7, 1.2}});
}

ReceiverArray eight() {
  return array_of({{-1, -1, 0},
                   {1, -1, 0},
                   {1, 1, 0},
                   {-1, 1, 0},
                   {-0.5, -0.5, 0.8},
                   {0.5, -0.5, 0.8},
                   {0.5, 0.5, 0.8},
                   {-0.5, 0.5, 0.8}});
}

ReceiverArray flat(const Vector3& facing_S = Vector3::Zero()) {
  return array_of({{0, 0, 0}, {2, 0, 0}, {2, 1.5, 0}, {0, 1.5, 0}}, facing_S);
}

Ranges exact_ranges(const ReceiverArray& array, const Vector3& p_S) {
  Ranges ranges;
  for (const Vector3& receiver : array.p_S)
    ranges.push_back({.metres = (p_S - receiver).norm(), .valid = true});
  return ranges;
}

Vector3 target_S() { return {0.9, 0.4, -1.3}; }

TEST(Trilateration, of_exact_ranges_is_exact) {
  const auto position = trilaterate(five(), exact_ranges(five(), target_S()));
  ASSERT_TRUE(position);
  EXPECT_LT((position->p_S - target_S()).norm(), 1e-14);
  EXPECT_LT(position->chi_square, 1e-15);
  EXPECT_EQ(position->degrees_of_freedom, 2U);
  EXPECT_TRUE(position->excluded.empty());
}

// Golden values: Gauss-Newton by numpy.linalg.lstsq on these ranges, numpy.linalg.inv(J^T W J).
TEST(Trilateration, of_noisy_ranges_of_unequal_sigma_is_the_weighted_least_squares_point) {
  const Ranges ranges = {{1.630951, true, 1},
                         {1.824859, true, 0.5},
                         {2.027259, true, 1},
                         {2.139974, true, 0.669829},
                         {2.519830, true, 1}};
  const auto position = trilaterate(five(), ranges);
  ASSERT_TRUE(position);
  const Vector3 golden(0.8999532405785657, 0.4001384586996817, -1.2999610680713856);
  EXPECT_LT((position->p_S - golden).norm(), 1e-12);
  EXPECT_NEAR(position->chi_square, 0.0589113170785, 1e-9);
  const Matrix3 golden_covariance{
      {2.1760704066749538e-08, 1.2987200084648223e-08, -5.2848583899540695e-09},
      {1.2987200084648224e-08, 4.3684359247140551e-08, -6.0512842656212334e-09},
      {-5.2848583899540712e-09, -6.0512842656212351e-09, 8.6208666427336762e-09}};
  EXPECT_LT((position->covariance_m2 - golden_covariance).cwiseAbs().maxCoeff(), 1e-16);
}

TEST(Trilateration, finds_a_target_among_the_receivers) {
  const Vector3 target(0.1, -0.2, 0.4);
  const auto position = trilaterate(eight(), exact_ranges(eight(), target));
  ASSERT_TRUE(position);
  EXPECT_LT((position->p_S - target).norm(), 1e-14);
}

TEST(Trilateration, loses_no_digits_to_a_sensor_frame_far_away) {
  const Vector3 offset(100, -200, 50);
  ReceiverArray array = five();
  for (Vector3& p : array.p_S) p += offset;
  const auto position = trilaterate(array, exact_ranges(array, target_S() + offset));
  ASSERT_TRUE(position);
  EXPECT_LT((position->p_S - target_S() - offset).norm(), 2e-13);
}

TEST(Trilateration, of_exact_ranges_takes_a_sigma_of_a_nanometre) {
  ReceiverArray array = eight();
  array.range_sigma_m = 1e-9;
  const auto position = trilaterate(array, exact_ranges(array, target_S()));
  ASSERT_TRUE(position);
  EXPECT_LT((position->p_S - target_S()).norm(), 1e-14);
}

TEST(Trilateration, skips_receivers_that_heard_nothing) {
  Ranges ranges = exact_ranges(eight(), target_S());
  ranges[0] = {.metres = std::numeric_limits<double>::quiet_NaN(), .valid = false};
  ranges[5] = {};
  const auto position = trilaterate(eight(), ranges);
  ASSERT_TRUE(position);
  EXPECT_LT((position->p_S - target_S()).norm(), 1e-14);
  EXPECT_EQ(position->degrees_of_freedom, 3U);
}

TEST(Trilateration, flat_array_finds_the_target_on_the_side_it_faces) {
  const ReceiverArray below = flat(-Vector3::UnitZ());
  const auto position = trilaterate(below, exact_ranges(below, target_S()));
  ASSERT_TRUE(position);
  EXPECT_LT((position->p_S - target_S()).norm(), 1e-14);

  const ReceiverArray above = flat(Vector3::UnitZ());
  const auto mirrored = trilaterate(above, exact_ranges(above, target_S()));
  ASSERT_TRUE(mirrored);
  EXPECT_LT((mirrored->p_S - Vector3(0.9, 0.4, 1.3)).norm(), 1e-14);
}

TEST(Trilateration, three_receivers_and_a_side_suffice) {
  const ReceiverArray array = array_of({{0, 0, 0}, {2, 0, 0.1}, {2, 1.5, 0}}, -Vector3::UnitZ());
  const auto position = trilaterate(array, exact_ranges(array, target_S()));
  ASSERT_TRUE(position);
  EXPECT_LT((position->p_S - target_S()).norm(), 1e-13);
  EXPECT_EQ(position->degrees_of_freedom, 0U);
}

TEST(Trilateration, refuses_to_guess_the_side) {
  EXPECT_EQ(test::failure_of(trilaterate(flat(), exact_ranges(flat(), target_S()))),
            Error::kMirrorAmbiguity);
}

TEST(Trilateration, refuses_to_guess_the_side_when_only_three_of_many_are_heard) {
  Ranges ranges = exact_ranges(five(), target_S());
  ranges[1].valid = false;
  ranges[4].valid = false;
  EXPECT_EQ(test::failure_of(trilaterate(five(), ranges)), Error::kMirrorAmbiguity);
}

TEST(Trilateration, nearly_flat_array_is_resolved_only_if_its_ranges_tell_the_sides_apart) {
  // A receiver 20 mm out of the plane makes ranges to target and mirror image differ by some 20 mm,
  // a hundred sigma; one at 0.2 mm by about a sigma.
  ReceiverArray array = flat();
  array.p_S[2].z() = 0.02;
  const auto position = trilaterate(array, exact_ranges(array, target_S()));
  ASSERT_TRUE(position);
  EXPECT_LT((position->p_S - target_S()).norm(), 1e-13);
  array.p_S[2].z() = 0.0002;
  EXPECT_EQ(test::failure_of(trilaterate(array, exact_ranges(array, target_S()))),
            Error::kMirrorAmbiguity);
}

TEST(Trilateration, refuses_fewer_than_three_ranges) {
  Ranges ranges = exact_ranges(five(), target_S());
  for (std::size_t j = 2; j < 5; ++j) ranges[j].valid = false;
  EXPECT_EQ(test::failure_of(trilaterate(five(), ranges)), Error::kTooFewReceivers);
}

TEST(Trilateration, refuses_when_those_that_heard_stand_on_a_line) {
  const ReceiverArray array = array_of({{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  Ranges ranges = exact_ranges(array, target_S());
  ranges[3].valid = false;
  ranges[4].valid = false;
  EXPECT_EQ(test::failure_of(trilaterate(array, ranges)), Error::kReceiversCollinear);
}

TEST(Trilateration, refuses_a_range_that_is_not_a_number) {
  Ranges ranges = exact_ranges(five(), target_S());
  ranges[3].metres = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(test::failure_of(trilaterate(five(), ranges)), Error::kNotFinite);
}

TEST(Trilateration, refuses_a_target_in_the_plane_of_a_flat_array) {
  const ReceiverArray array = flat(-Vector3::UnitZ());
  EXPECT_EQ(test::failure_of(trilaterate(array, exact_ranges(array, {0.9, 0.4, 0}))),
            Error::kSingular);
  EXPECT_EQ(test::failure_of(trilaterate(array, exact_ranges(array, {0.9, 0.4, -0.005}))),
            Error::kSingular);
}

TEST(Trilateration, refuses_a_small_array_far_away) {
  // Receivers 1 mm apart, target at 1.6 m: the direction is lost in the noise.
  const ReceiverArray array =
      array_of({{0, 0, 0}, {1e-3, 0, 0}, {0, 1e-3, 0}, {0, 0, 1e-3}}, -Vector3::UnitZ());
  EXPECT_EQ(test::failure_of(trilaterate(array, exact_ranges(array, target_S()))),
            Error::kSingular);
}

TEST(Trilateration, refuses_three_spheres_that_do_not_meet) {
  const ReceiverArray array = array_of({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, -Vector3::UnitZ());
  const Ranges ranges = {{0.5, true}, {0.6, true}, {0.7, true}};
  EXPECT_EQ(test::failure_of(trilaterate(array, ranges)), Error::kRangesInconsistent);
}

TEST(Trilateration, four_ranges_detect_a_detour_but_cannot_name_it) {
  ReceiverArray array = five();
  array.p_S.resize(4, Vector3::Zero());
  array.facing_S = -Vector3::UnitZ();
  Ranges ranges = exact_ranges(array, target_S());
  ranges[2].metres += 0.05;
  EXPECT_EQ(test::failure_of(trilaterate(array, ranges)), Error::kRangesInconsistent);
}

TEST(Trilateration, five_ranges_name_any_one_detour) {
  for (std::size_t j = 0; j < 5; ++j) {
    Ranges ranges = exact_ranges(five(), target_S());
    ranges[j].metres += 0.05;
    const auto position = trilaterate(five(), ranges);
    ASSERT_TRUE(position) << "receiver " << j;
    EXPECT_LT((position->p_S - target_S()).norm(), 1e-13);
    ASSERT_EQ(position->excluded.size(), 1U);
    EXPECT_EQ(position->excluded[0], j);
    EXPECT_EQ(position->degrees_of_freedom, 1U);
  }
}

TEST(Trilateration, names_receivers_by_their_place_in_the_array) {
  Ranges ranges = exact_ranges(eight(), target_S());
  ranges[0].valid = false;
  ranges[6].metres += 0.05;
  const auto position = trilaterate(eight(), ranges);
  ASSERT_TRUE(position);
  ASSERT_EQ(position->excluded.size(), 1U);
  EXPECT_EQ(position->excluded[0], 6U);
}

TEST(Trilateration, eight_ranges_name_three_detours) {
  Ranges ranges = exact_ranges(eight(), target_S());
  ranges[1].metres += 0.05;
  ranges[2].metres += 0.11;
  ranges[7].metres += 0.26;
  const auto position = trilaterate(eight(), ranges);
  ASSERT_TRUE(position);
  EXPECT_LT((position->p_S - target_S()).norm(), 1e-13);
  ASSERT_EQ(position->excluded.size(), 3U);
  EXPECT_EQ(position->excluded[0], 1U);
  EXPECT_EQ(position->excluded[1], 2U);
  EXPECT_EQ(position->excluded[2], 7U);
}

// Three ranges agree with each other whatever they are: of six or seven, no more may be left out
// than leave five.
TEST(Trilateration, names_no_more_detours_than_leave_five_ranges) {
  for (const std::size_t heard : {6U, 7U}) {
    Ranges ranges = exact_ranges(eight(), target_S());
    for (std::size_t j = heard; j < 8; ++j) ranges[j].valid = false;
    const double detours_m[] = {0.05, 0.11, 0.26};
    for (std::size_t bad = 0; bad < heard - 5; ++bad) {
      ranges[bad].metres += detours_m[bad];
      const auto position = trilaterate(eight(), ranges);
      ASSERT_TRUE(position) << heard << " ranges, " << bad;
      EXPECT_LT((position->p_S - target_S()).norm(), 1e-12);
      EXPECT_EQ(position->excluded.size(), bad + 1);
    }
    ranges[heard - 5].metres += detours_m[heard - 5];
    EXPECT_EQ(test::failure_of(trilaterate(eight(), ranges)), Error::kRangesInconsistent) << heard;
  }
}

// Chi-square at 0.9999 of five degrees of freedom is 25.74.
TEST(Trilateration, takes_noise_for_noise_up_to_one_in_ten_thousand_of_its_degrees_of_freedom) {
  const double noise_m[] = {1e-4, -2e-4, 3e-4, -1e-4, -3e-4, 2e-4, 1e-4, -2e-4};
  const auto noisy = [&](double scale) {
    Ranges ranges = exact_ranges(eight(), target_S());
    for (std::size_t j = 0; j < 8; ++j) ranges[j].metres += scale * noise_m[j];
    return ranges;
  };
  const double chi_square = trilaterate(eight(), noisy(1))->chi_square;
  const auto accepted = trilaterate(eight(), noisy(std::sqrt(25.5 / chi_square)));
  ASSERT_TRUE(accepted);
  EXPECT_NEAR(accepted->chi_square, 25.5, 0.1);
  EXPECT_TRUE(accepted->excluded.empty());
  const auto beyond = trilaterate(eight(), noisy(std::sqrt(26.0 / chi_square)));
  EXPECT_TRUE(!beyond || !beyond->excluded.empty());
}

TEST(Trilateration, refuses_ranges_that_agree_on_nothing) {
  Ranges ranges = exact_ranges(eight(), target_S());
  for (std::size_t j = 0; j < 8; ++j) ranges[j].metres += 0.03 * static_cast<double>(j * j % 5);
  EXPECT_EQ(test::failure_of(trilaterate(eight(), ranges)), Error::kRangesInconsistent);
}

TEST(Trilateration, excludes_a_range_too_short_if_nothing_else_explains_it) {
  Ranges ranges = exact_ranges(eight(), target_S());
  ranges[3].metres = 0;
  const auto position = trilaterate(eight(), ranges);
  ASSERT_TRUE(position);
  EXPECT_LT((position->p_S - target_S()).norm(), 1e-13);
  ASSERT_EQ(position->excluded.size(), 1U);
  EXPECT_EQ(position->excluded[0], 3U);
}

TEST(Trilateration, excludes_a_range_beyond_all_measure) {
  Ranges ranges = exact_ranges(eight(), target_S());
  ranges[3].metres = 1e200;
  const auto position = trilaterate(eight(), ranges);
  ASSERT_TRUE(position);
  EXPECT_LT((position->p_S - target_S()).norm(), 1e-13);
}

TEST(Trilateration, traps_when_ranges_and_receivers_do_not_match) {
  EXPECT_DEATH(EXPECT_FALSE(trilaterate(five(), {})), "");
}

TEST(Trilateration, is_over_once) {
  const ReceiverArray array = five();
  Trilateration search(array, exact_ranges(array, target_S()));
  while (search.step()) {
  }
  EXPECT_FALSE(search.step());
  ASSERT_TRUE(search.result());
  EXPECT_TRUE(search.result()->excluded.empty());
}

}  // namespace
}  // namespace armsig::measurement
