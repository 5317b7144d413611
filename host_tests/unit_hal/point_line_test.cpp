// SPDX-License-Identifier: MIT
// The line in which an instrument tells a point: what is taken, and what is refused by which words.
#include "hal/linux/point_line.hpp"

#include <string>

#include <gtest/gtest.h>

namespace armsig::linux_hal {
namespace {

std::string refusal(std::string_view line) {
  const auto point = PointLine::parse(line);
  if (point) return "taken";
  return std::string(point.error().key) + " " + std::string(point.error().what);
}

TEST(PointLine, tells_a_place_in_millimetres) {
  const auto point = PointLine::parse("point x_mm=812.5 y_mm=-31 z_mm=4.55e2");
  ASSERT_TRUE(point);
  EXPECT_DOUBLE_EQ(point->p_S.x(), 0.8125);
  EXPECT_DOUBLE_EQ(point->p_S.y(), -0.031);
  EXPECT_DOUBLE_EQ(point->p_S.z(), 0.455);
  EXPECT_FALSE(point->covariance_m2);
  EXPECT_FALSE(point->sequence);
}

TEST(PointLine, tells_its_sigma_and_its_number_in_any_order) {
  const auto point = PointLine::parse("point seq=4294967295 sigma_mm=0.02  z_mm=3 y_mm=2 x_mm=1 ");
  ASSERT_TRUE(point);
  ASSERT_TRUE(point->covariance_m2);
  EXPECT_NEAR((*point->covariance_m2)(1, 1), 4e-10, 1e-22);
  EXPECT_EQ((*point->covariance_m2)(0, 1), 0);
  EXPECT_EQ(point->sequence, 4294967295U);
}

TEST(PointLine, tells_a_whole_covariance) {
  const auto point = PointLine::parse(
      "point x_mm=1 y_mm=2 z_mm=3 cxx_mm2=0.04 cxy_mm2=0.01 cxz_mm2=0 cyy_mm2=0.09 cyz_mm2=-0.02 "
      "czz_mm2=0.16");
  ASSERT_TRUE(point);
  ASSERT_TRUE(point->covariance_m2);
  EXPECT_NEAR((*point->covariance_m2)(0, 1), 1e-8, 1e-20);
  EXPECT_NEAR((*point->covariance_m2)(2, 1), -2e-8, 1e-20);
  EXPECT_NEAR((*point->covariance_m2)(2, 2), 16e-8, 1e-20);
}

TEST(PointLine, that_is_none_is_refused_by_what_is_wrong) {
  EXPECT_EQ(refusal(""), "the line does not begin with point");
  EXPECT_EQ(refusal("GET / HTTP/1.1"), "the line does not begin with point");
  EXPECT_EQ(refusal("points x_mm=1 y_mm=2 z_mm=3"), "the line does not begin with point");
  EXPECT_EQ(refusal("point x_mm=1\ty_mm=2 z_mm=3"), "the line is not text");
  EXPECT_EQ(refusal("point x_mm=1 y_mm=2 z_mm=3 \xC3\xA4"), "the line is not text");
  EXPECT_EQ(refusal("point x_mm=1 y_mm=2"), "z_mm is missing");
  EXPECT_EQ(refusal("point x_m=1 y_mm=2 z_mm=3"), "a key is unknown");
  EXPECT_EQ(refusal("point 1 2 3"), "a key is unknown");
  EXPECT_EQ(refusal("point x_mm=1 x_mm=1 y_mm=2 z_mm=3"), "x_mm is there twice");
}

TEST(PointLine, whose_numbers_are_none_is_refused) {
  for (const char* number :
       {"nan", "inf", "-inf", "1e999", "", "1,5", "0x10", "+1", "1 2", "1mm"}) {
    const std::string line = "point x_mm=1 y_mm=" + std::string(number) + " z_mm=3";
    const std::string told = refusal(line);
    EXPECT_TRUE(told == "y_mm is not a number" || told == "a key is unknown") << line << told;
  }
}

TEST(PointLine, whose_numbers_cannot_be_is_refused) {
  EXPECT_EQ(refusal("point x_mm=100001 y_mm=2 z_mm=3"), "x_mm is farther away than 100 m");
  const std::string place = "point x_mm=1 y_mm=2 z_mm=3 ";
  for (const char* sigma : {"0", "-1", "0.0009", "51"}) {
    EXPECT_EQ(refusal(place + "sigma_mm=" + sigma), "sigma_mm is not between 0.001 and 50");
  }
  for (const char* number : {"-1", "0.5", "4294967296"}) {
    EXPECT_EQ(refusal(place + "seq=" + number), "seq is not a whole number of 32 bits");
  }
}

TEST(PointLine, whose_covariance_is_none_is_refused) {
  const std::string place = "point x_mm=1 y_mm=2 z_mm=3 ";
  EXPECT_EQ(refusal(place + "cxx_mm2=1 cyy_mm2=1 czz_mm2=1"), "the covariance is not whole");
  EXPECT_EQ(refusal(place + "sigma_mm=1 cxx_mm2=1"), "sigma_mm stands beside a covariance");
  // One of its axes would be known without an error, or better than that.
  for (const char* across : {"1", "2", "-1"}) {
    EXPECT_EQ(
        refusal(place + "cxx_mm2=1 cxz_mm2=0 cyy_mm2=1 cyz_mm2=0 czz_mm2=1 cxy_mm2=" + across),
        "the covariance has a sigma that is not between 0.001 and 50 mm");
  }
}

}  // namespace
}  // namespace armsig::linux_hal
