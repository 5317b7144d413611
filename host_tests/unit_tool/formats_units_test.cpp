// SPDX-License-Identifier: MIT
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "firmware/formats/text.hpp"
#include "firmware/formats/units.hpp"

namespace armsig::tool {
namespace {

TEST(TextIn, gives_back_what_a_person_wrote) {
  for (const char* text : {"0.1", "-120", "109.56", "0.05", "-0.0001", "1e-07", "359.999"}) {
    const double value = *parse_number(text);
    EXPECT_EQ(text_in(kDegree, kDegree.to_si(value)), text);
    EXPECT_EQ(text_in(kMillimetre, kMillimetre.to_si(value)), text);
  }
}

TEST(TextIn, reads_back_as_the_same_bits_wherever_a_number_of_the_unit_has_them) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-400, 400);
  for (int k = 0; k < 20'000; ++k) {
    for (const Unit& unit : {kDegree, kMillimetre}) {
      const double value_si = unit.to_si(any(random));
      const std::string text = text_in(unit, value_si);
      EXPECT_EQ(unit.to_si(*parse_number(text)), value_si) << text;
    }
  }
}

TEST(TextIn, is_within_a_rounding_where_no_number_of_the_unit_has_the_bits) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> any(-7, 7);
  for (int k = 0; k < 20'000; ++k) {
    const double angle_rad = any(random);
    const double read = kDegree.to_si(*parse_number(text_in(kDegree, angle_rad)));
    EXPECT_LE(std::fabs(read - angle_rad), 2.3e-16 * std::fabs(angle_rad));
  }
}

TEST(TextIn, says_what_is_not_finite) {
  EXPECT_EQ(text_in(kDegree, std::numeric_limits<double>::quiet_NaN()), "nan");
  EXPECT_EQ(text_in(kMillimetre, std::numeric_limits<double>::infinity()), "inf");
}

}  // namespace
}  // namespace armsig::tool
