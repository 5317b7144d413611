// SPDX-License-Identifier: MIT
// Points from lengths: where they meet, how well that is known, and what is said of lengths that
// tell no point.
#include "firmware/controller/length_points.hpp"

#include <cmath>
#include <deque>
#include <optional>

#include <gtest/gtest.h>

#include "host_tests/support/failure_of.hpp"

namespace armsig::controller {
namespace {

using hal::LengthReading;
using Polled = Result<std::optional<hal::PointReading>>;

constexpr hal::Instant kNow{std::chrono::seconds(10)};

// Three anchors on the axes at 1, 2 and 2 m, and one at the origin.
measurement::ReceiverArray four_anchors() {
  return {.p_S = {Vector3(1, 0, 0), Vector3(0, 2, 0), Vector3(0, 0, 2), Vector3(0, 0, 0)},
          .range_sigma_m = 1e-4};
}

LengthOffsets none_of(const measurement::ReceiverArray& anchors) {
  LengthOffsets offsets_m;
  for (std::size_t i = 0; i < anchors.p_S.size(); ++i) offsets_m.push_back(0);
  return offsets_m;
}

// To the point (1, 1, 1): by hand.
LengthReading to_one_one_one() {
  const double r2 = std::sqrt(2.0);
  const double r3 = std::sqrt(3.0);
  return {.lengths_m = {r2, r3, r3, r3}, .at = kNow, .sequence = 5};
}

class Told final : public hal::LengthInstrument {
 public:
  std::deque<Result<std::optional<LengthReading>>> next;

 private:
  Result<std::optional<LengthReading>> do_poll(hal::Instant) override {
    if (next.empty()) return std::nullopt;
    auto told = next.front();
    next.pop_front();
    return told;
  }
  [[nodiscard]] std::string_view do_words(Error) const override { return "of the lengths"; }
  [[nodiscard]] std::uint32_t do_malformed() const override { return 7; }
};

struct Located {
  explicit Located(const measurement::ReceiverArray& anchors = four_anchors())
      : Located(anchors, none_of(anchors)) {}
  Located(const measurement::ReceiverArray& anchors, const LengthOffsets& offsets_m)
      : points(anchors, offsets_m, told) {}
  // What comes of a reading, within the ticks that eight lengths need at most.
  Polled take(const Result<std::optional<LengthReading>>& reading) {
    told.next.push_back(reading);
    for (int tick = 0; tick < 13; ++tick) {
      Polled polled = points.poll(kNow);
      if (!polled || *polled) return polled;
    }
    return std::nullopt;
  }
  std::string_view words_of(const LengthReading& reading) {
    const Polled polled = take(reading);
    EXPECT_EQ(test::failure_of(polled), Error::kSensorMalformed);
    return points.words(Error::kSensorMalformed);
  }

  Told told;
  LengthPoints points;
};

TEST(LengthPoints, are_where_the_lengths_meet_with_what_is_known_of_it) {
  Located located;
  const Polled polled = located.take(to_one_one_one());
  ASSERT_TRUE(polled && *polled);
  EXPECT_LT(((*polled)->p_S - Vector3(1, 1, 1)).norm(), 1e-12);
  EXPECT_EQ((*polled)->at, kNow);
  EXPECT_EQ((*polled)->sequence, 5U);
  // The inverse of the sum of u u' / sigma^2 over the directions u of the four wires.
  ASSERT_TRUE((*polled)->covariance_m2);
  Matrix3 information = Matrix3::Zero();
  for (const Vector3& p_S : four_anchors().p_S) {
    const Vector3 u = (Vector3(1, 1, 1) - p_S).normalized();
    information += u * u.transpose() / 1e-8;
  }
  EXPECT_LT((*(*polled)->covariance_m2 * information - Matrix3::Identity()).norm(), 1e-6);
}

TEST(LengthPoints, add_the_offset_of_each_length) {
  const LengthOffsets offsets_m{0.1, -0.2, 0.3, 0.0};
  Located located(four_anchors(), offsets_m);
  LengthReading reading = to_one_one_one();
  for (std::size_t i = 0; i < 4; ++i) *reading.lengths_m[i] -= offsets_m[i];
  const Polled polled = located.take(reading);
  ASSERT_TRUE(polled && *polled);
  EXPECT_LT(((*polled)->p_S - Vector3(1, 1, 1)).norm(), 1e-12);
}

TEST(LengthPoints, need_three_of_the_lengths) {
  measurement::ReceiverArray anchors = four_anchors();
  anchors.facing_S = Vector3(1, 1, 1);
  Located located(anchors);
  LengthReading reading = to_one_one_one();
  reading.lengths_m[1].reset();
  const Polled polled = located.take(reading);
  ASSERT_TRUE(polled && *polled) << located.points.words(Error::kSensorMalformed);
  EXPECT_LT(((*polled)->p_S - Vector3(1, 1, 1)).norm(), 1e-9);
  reading.lengths_m[2].reset();
  EXPECT_EQ(located.words_of(reading), "fewer than three lengths");
  // Of those that are not there at all, likewise.
  reading = to_one_one_one();
  reading.lengths_m.resize(2);
  EXPECT_EQ(located.words_of(reading), "fewer than three lengths");
}

TEST(LengthPoints, that_are_none_are_counted_and_named) {
  Located located;
  LengthReading reading = to_one_one_one();
  reading.lengths_m[0] = *reading.lengths_m[0] + 0.01;
  EXPECT_EQ(located.words_of(reading), "the lengths do not meet in a point");
  reading = to_one_one_one();
  reading.lengths_m.push_back(1.0);
  EXPECT_EQ(located.words_of(reading), "more lengths than anchors");
  EXPECT_EQ(located.points.malformed(), 7 + 2U);
  const Polled polled = located.take(to_one_one_one());
  EXPECT_TRUE(polled && *polled) << "nothing ended";
}

TEST(LengthPoints, beside_the_plane_of_their_anchors_are_none) {
  measurement::ReceiverArray anchors = four_anchors();
  anchors.p_S = {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(-1, 0, 0)};
  anchors.facing_S = Vector3(0, 0, 1);
  Located located(anchors);
  const double r2 = std::sqrt(2.0);
  const LengthReading in_plane{.lengths_m = {r2, 2.0, r2}, .at = kNow, .sequence = 1};
  EXPECT_EQ(located.words_of(in_plane),
            "the lengths do not fix a point: it is too near the plane of the anchors");
}

TEST(LengthPoints, give_up_one_of_five_lengths_that_contradicts_the_others) {
  measurement::ReceiverArray anchors = four_anchors();
  anchors.p_S.push_back(Vector3(2, 2, 2));
  Located located(anchors);
  LengthReading reading = to_one_one_one();
  reading.lengths_m.push_back(std::sqrt(3.0));
  reading.lengths_m[2] = 2.0;
  const Polled polled = located.take(reading);
  ASSERT_TRUE(polled && *polled) << located.points.words(Error::kSensorMalformed);
  EXPECT_LT(((*polled)->p_S - Vector3(1, 1, 1)).norm(), 1e-9);
}

TEST(LengthPoints, pass_on_the_errors_of_the_lengths_with_their_words) {
  Located located;
  LengthReading reading = to_one_one_one();
  reading.lengths_m[0] = 9.0;
  (void)located.words_of(reading);
  for (const Error error :
       {Error::kSensorSilent, Error::kSensorPortGone, Error::kSensorMalformed}) {
    EXPECT_EQ(test::failure_of(located.take(std::unexpected(error))), error);
    EXPECT_EQ(located.points.words(error), "of the lengths");
  }
}

}  // namespace
}  // namespace armsig::controller
