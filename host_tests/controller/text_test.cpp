// SPDX-License-Identifier: MIT
// The lines of the console: how numbers are written and read, and how requests are taken apart.
#include "firmware/controller/text.hpp"

#include <limits>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "host_tests/support/failure_of.hpp"

namespace armsig::controller {
namespace {

std::optional<double> needed(std::string_view text) {
  Line why;
  const auto number = needed_number("key", text, why);
  return number ? std::optional(*number) : std::nullopt;
}

std::string number(double value, unsigned decimals) {
  return std::string(Line().number(value, decimals).view());
}

TEST(Line, writes_numbers_rounded_with_as_many_decimals_as_asked) {
  EXPECT_EQ(number(0, 0), "0");
  EXPECT_EQ(number(0, 3), "0.000");
  EXPECT_EQ(number(1.25, 1), "1.3");
  EXPECT_EQ(number(-1.25, 1), "-1.3");
  EXPECT_EQ(number(12.3456, 2), "12.35");
  EXPECT_EQ(number(9.996, 2), "10.00");
  EXPECT_EQ(number(0.0501, 4), "0.0501");
  EXPECT_EQ(number(100, 2), "100.00");
  EXPECT_EQ(number(2.5, 0), "3");
  EXPECT_EQ(number(-0.4, 0), "0") << "no sign before nothing";
  EXPECT_EQ(number(1234.000000001, 9), "1234.000000001");
}

TEST(Line, writes_what_is_no_number_or_too_large_in_words) {
  EXPECT_EQ(number(std::numeric_limits<double>::quiet_NaN(), 2), "none");
  EXPECT_EQ(number(-std::numeric_limits<double>::infinity(), 2), "none");
  EXPECT_EQ(number(8.9e18, 0), "8900000000000000000");
  EXPECT_EQ(number(9.1e18, 0), "huge");
  EXPECT_EQ(number(-1e17, 2), "huge");
}

TEST(Line, writes_whole_and_hexadecimal_numbers) {
  EXPECT_EQ(Line().integer(0).view(), "0");
  EXPECT_EQ(Line().integer(18446744073709551615U).view(), "18446744073709551615");
  EXPECT_EQ(Line().hex(0x2310, 4).view(), "0x2310");
  EXPECT_EQ(Line().hex(0xA, 4).view(), "0x000A");
  EXPECT_EQ(Line().hex(0, 1).view(), "0x0");
  EXPECT_EQ(Line().hex(0x06040042, 4).view(), "0x6040042");
  EXPECT_EQ(Line().hex(0xFEDC9876, 4).view(), "0xFEDC9876");
}

TEST(Line, writes_what_an_emergency_has_beside_its_code) {
  const hal::DeviceDetails details{.error_register = 0x21, .own = {0, 0x1A, 0, 0, 0xFF}};
  EXPECT_EQ(Line().device_details(details, "fault_").view(),
            " fault_register=0x21 fault_own=001A0000FF");
  EXPECT_EQ(Line().device_details({.error_register = 1, .own = {}}).view(), " register=0x01");
  EXPECT_EQ(Line().device_details({}).view(), "");
}

TEST(Line, writes_what_a_device_says) {
  EXPECT_EQ(Line().device_says(0, "words").view(), "");
  EXPECT_EQ(Line().device_says(0x2310, "").view(), " code=0x2310");
  // As manuals of drives write an SDO abort code.
  EXPECT_EQ(Line().device_says(0x06090030, "").view(), " code=0x06090030");
  EXPECT_EQ(Line().device_says(0x2310, "too warm", "fault_").view(),
            " fault_code=0x2310 fault_says=\"too warm\"");
}

TEST(Line, writes_an_object_of_a_device_as_makers_do) {
  EXPECT_EQ(Line().device_object({}).view(), "");
  EXPECT_EQ(Line().device_object({.index = 0x605A, .subindex = 0, .found = 0, .wanted = 6}).view(),
            " object=605Ah:0 found=0x0 wanted=0x6");
  const hal::DeviceObject absent{.index = 0x1016, .subindex = 1, .found = {}, .wanted = 0x007F0096};
  EXPECT_EQ(Line().device_object(absent, "fault_").view(),
            " fault_object=1016h:1 fault_found=none fault_wanted=0x7F0096");
}

TEST(Line, writes_the_numbers_of_bits) {
  EXPECT_EQ(Line().numbers(0).view(), "");
  EXPECT_EQ(Line().numbers(0b10100).view(), "3,5");
  EXPECT_EQ(Line().numbers(0x80000001).view(), "1,32");
}

TEST(Line, ends_at_its_capacity) {
  Line line;
  for (int i = 0; i < 1023; ++i) line.text("a");
  line.text("bcd");
  EXPECT_EQ(line.view().size(), 1024U);
  EXPECT_EQ(line.view().back(), 'b');
  line.clear();
  EXPECT_EQ(line.view(), "");
}

TEST(NeededNumber, gives_the_nearest_double) {
  EXPECT_EQ(needed("0"), 0.0);
  EXPECT_EQ(needed("0.1"), 0.1);
  EXPECT_EQ(needed("-0.125"), -0.125);
  EXPECT_EQ(needed("+7.5"), 7.5);
  EXPECT_EQ(needed(".5"), 0.5);
  EXPECT_EQ(needed("5."), 5.0);
  EXPECT_EQ(needed("1e3"), 1000.0);
  EXPECT_EQ(needed("1.5E-2"), 0.015);
  EXPECT_EQ(needed("-2e+1"), -20.0);
  EXPECT_EQ(needed("123456789"), 123456789.0);
  EXPECT_EQ(needed("1e22"), 1e22);
  EXPECT_EQ(needed("1e-999"), 0.0);
  EXPECT_EQ(needed("100000000000000000000000000000"), 1e29) << "thirty digits";
}

TEST(NeededNumber, takes_nothing_else) {
  for (const char* text : {"",      "+",
                           "-",     ".",
                           "e5",    "1e",
                           "1e+",   "--1",
                           "+-1",   "1..2",
                           "1.2.3", "1 ",
                           " 1",    "0x10",
                           "nan",   "inf",
                           "1,5",   "1e5.0",
                           "1e999", "1e0001",
                           "1e5e5", "1000000000000000000000000000000",
                           "/",     ":",
                           "1/",    "1:"}) {
    EXPECT_FALSE(needed(text)) << text;
  }
}

TEST(ParseRequest, separates_words_by_any_blanks) {
  const auto request = parse_request(" \t move  q1_deg=1\tpace=0.5 ");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->verb, "move");
  ASSERT_EQ(request->arguments.size(), 2U);
  EXPECT_EQ(request->arguments[0].first, "q1_deg");
  EXPECT_EQ(request->arguments[0].second, "1");
  EXPECT_EQ(request->arguments[1].first, "pace");
  EXPECT_EQ(request->arguments[1].second, "0.5");
}

TEST(ParseRequest, keeps_what_stands_behind_the_first_equals_sign) {
  const auto request = parse_request("move a=b=c d=");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->arguments[0].second, "b=c");
  EXPECT_EQ(request->arguments[1].second, "");
}

TEST(ParseRequest, refuses_what_has_no_verb_no_key_a_key_twice_or_too_many) {
  for (const char* line : {"", "   ", "\t", "move q1_deg q2_deg", "move q1_deg=1 q2_deg", "move =1",
                           "move a=1 a=2", "move a=1 b=1 a=1"}) {
    EXPECT_EQ(test::failure_of(parse_request(line)), Error::kUnknownRequest) << line;
  }
  std::string many = "move";
  for (int i = 0; i < 16; ++i) many += " k" + std::to_string(i) + "=1";
  EXPECT_TRUE(parse_request(many));
  EXPECT_EQ(test::failure_of(parse_request(many + " one=1")), Error::kCapacityExceeded);
}

}  // namespace
}  // namespace armsig::controller
