// SPDX-License-Identifier: MIT
// Times: what is one, what it stands for, and that nothing of a cell is passed over.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "firmware/formats/timestamp.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::tool {
namespace {

struct TimeCase {
  const char* text;
  double seconds;
  TimeKind kind;
};

// Seconds since 1970 by `date -u -d ... +%s`.
const TimeCase kTimes[] = {
    {"12.5", 12.5, TimeKind::kSeconds},
    {" -3e2 ", -300, TimeKind::kSeconds},
    {"01:02:03.25", 3723.25, TimeKind::kOfDay},
    {"1:02:03,25", 3723.25, TimeKind::kOfDay},
    {"01:00:01 PM", 46801, TimeKind::kOfDay},
    {"01:00:01am", 3601, TimeKind::kOfDay},
    {"12:00:00 AM", 0, TimeKind::kOfDay},
    {"12:00:00 p.m.", 43200, TimeKind::kOfDay},
    {"00:30:00+02:00", -5400, TimeKind::kUtcOfDay},
    {"23:59:60", 86400, TimeKind::kOfDay},
    {"2026-03-29 15:00:01", 1774796401, TimeKind::kLocal},
    {"2026-03-29T13:00:01Z", 1774789201, TimeKind::kUtc},
    {"2026-03-29 15:00:01+02:00", 1774789201, TimeKind::kUtc},
    {"2026-03-29 15:00:01.5 +0200", 1774789201.5, TimeKind::kUtc},
    {"2026-03-29 07:30:01 -05:30", 1774789201, TimeKind::kUtc},
    {"2026/03/29 13:00:01 UTC", 1774789201, TimeKind::kUtc},
    {"29.03.2026 15:00:01", 1774796401, TimeKind::kLocal},
    {"29.3.26, 15:00:01", 1774796401, TimeKind::kLocal},
    {"29/03/2026 03:00:01 PM", 1774796401, TimeKind::kLocal},
    {"3/29/26 3:00:01 PM", 1774796401, TimeKind::kLocal},
    {"29-Mar-2026 15:00:01", 1774796401, TimeKind::kLocal},
    {"2016-12-31 23:59:60Z", 1483228800, TimeKind::kUtc},
    {"2024-02-29 00:00:00", 1709164800, TimeKind::kLocal},
    // The same by either order.
    {"04/04/2026 00:00:00", 1775260800, TimeKind::kLocal},
};

TEST(Timestamp, is_read_whole) {
  for (const TimeCase& one : kTimes) {
    const auto time = parse_time(one.text, DateOrder::kUnknown);
    ASSERT_TRUE(time) << one.text;
    EXPECT_DOUBLE_EQ(time->seconds, one.seconds) << one.text;
    EXPECT_EQ(time->kind, one.kind) << one.text;
  }
}

TEST(Timestamp, is_refused_where_a_part_is_none) {
  for (const char* wrong : {"",
                            "noon",
                            "10:00",
                            "10:00 AM",
                            "13:00:00 garbage",
                            "13:00:00 PM",
                            "0:00:00 AM",
                            "10:00:00 A",
                            "25:00:00",
                            "24:00:00",
                            "10:61:00",
                            "10:00:61",
                            "10:10:60",
                            "10:00:00.",
                            "10:00:00.5.5",
                            "10:00:00 CEST",
                            "10:00:00+15:00",
                            "10:00:00+02:",
                            "10:00:00+02:60",
                            "10:00:00Z+02:00",
                            "10:00:00 ZZ",
                            "10:00:00 AM PM",
                            "31.02.2026 10:00:00",
                            "2026-02-30 10:00:00",
                            "2025-02-29 10:00:00",
                            "29-Foo-2026 10:00:00",
                            "2026-03-29",
                            "2026-03-2910:00:00",
                            "2026-03/29 10:00:00",
                            "29.03/2026 10:00:00",
                            "13/13/2026 10:00:00",
                            "1/2/345 10:00:00",
                            "00/00/2026 10:00:00",
                            "2026-00-10 10:00:00",
                            "1e3s",
                            "nan",
                            "inf",
                            "12:00:00\xC2\xA0"}) {
    EXPECT_EQ(test::failure_of(parse_time(wrong, DateOrder::kUnknown)), TimeFault::kNotATime)
        << wrong;
  }
}

TEST(Timestamp, of_an_ambiguous_date_is_read_by_its_order_only) {
  for (const char* text : {"3/4/2026 10:00:00", "03-04-2026 10:00:00", "03/04/26 10:00:00"}) {
    EXPECT_EQ(test::failure_of(parse_time(text, DateOrder::kUnknown)), TimeFault::kAmbiguousDate)
        << text;
    EXPECT_EQ(parse_time(text, DateOrder::kDayFirst)->seconds, 1775210400);    // 3 April
    EXPECT_EQ(parse_time(text, DateOrder::kMonthFirst)->seconds, 1772618400);  // 4 March
  }
}

TEST(Timestamp, tells_the_order_of_its_date_where_a_number_is_no_month) {
  EXPECT_EQ(order_told_by("13/4/2026 10:00:00"), DateOrder::kDayFirst);
  EXPECT_EQ(order_told_by("4/13/2026 10:00:00"), DateOrder::kMonthFirst);
  EXPECT_EQ(order_told_by("4-13-26"), DateOrder::kMonthFirst);
  for (const char* none :
       {"4/12/2026 10:00:00", "2026-04-13 10:00:00", "13.04.2026", "10:30:59", "13.5", "", "-13"}) {
    EXPECT_EQ(order_told_by(none), DateOrder::kUnknown) << none;
  }
}

// A byte more at the end of a time is another time, or none: nothing is passed over.
TEST(Timestamp, is_none_with_a_letter_behind_it) {
  for (const char* text : {"01:02:03", "01:02:03.5 PM", "2026-03-29 13:00:01",
                           "2026-03-29T13:00:01Z", "29.03.2026 15:00:01 +02:00", "12.5"}) {
    ASSERT_TRUE(parse_time(text, DateOrder::kUnknown)) << text;
    for (const char c : std::string_view("abcdfghijklmnopqrstuvwxy!?:;/_#")) {
      EXPECT_FALSE(parse_time(std::string(text) + c, DateOrder::kUnknown)) << text << c;
      EXPECT_FALSE(parse_time(std::string(text) + " " + c, DateOrder::kUnknown)) << text << c;
    }
  }
}

}  // namespace
}  // namespace armsig::tool
