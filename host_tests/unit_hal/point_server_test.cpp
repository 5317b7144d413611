// SPDX-License-Identifier: MIT
// Points over a real TCP connection, in a time that the test makes: which are handed out, how old
// they can be, and what becomes of connections and lines that are none.
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/linux/line_server.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/point_client.hpp"

namespace armsig::linux_hal {
namespace {

using std::chrono::milliseconds;
using test::PointClient;
using Polled = Result<std::optional<hal::PointReading>>;

constexpr std::string_view kPoint = "point x_mm=1 y_mm=2 z_mm=3\n";

struct Served {
  Served() { (void)poll(0); }
  // After so many milliseconds more.
  Polled poll(int later_ms = 10) {
    now += milliseconds(later_ms);
    return server.poll(now);
  }
  bool has_point(int later_ms = 10) {
    const auto polled = poll(later_ms);
    return polled && polled->has_value();
  }
  std::optional<Error> failure(int later_ms = 10) {
    const auto polled = poll(later_ms);
    return polled ? std::nullopt : std::optional(polled.error());
  }

  PointServer server{{}};
  hal::Instant now{milliseconds(1000)};
};

TEST(PointServer, hands_out_each_point_once_with_the_earliest_time_it_can_be_of) {
  Served served;
  const PointClient client(served.server.port());
  ASSERT_TRUE(client.connected());
  ASSERT_FALSE(served.has_point());
  ASSERT_TRUE(client.say("point x_mm=812.5 y_mm=-31 z_mm=455 sigma_mm=0.1\r\n"));
  const hal::Instant looked_at = served.now;
  const auto polled = served.poll();
  ASSERT_TRUE(polled && *polled);
  EXPECT_DOUBLE_EQ((*polled)->p_S.x(), 0.8125);
  EXPECT_NEAR((*(*polled)->covariance_m2)(0, 0), 1e-8, 1e-20);
  // It may have come right after the call before, and be as old then as is configured.
  EXPECT_EQ((*polled)->at, looked_at - milliseconds(100));
  EXPECT_FALSE(served.has_point());
}

TEST(PointServer, hands_out_the_newest_of_several_and_numbers_those_that_have_none) {
  Served served;
  const PointClient client(served.server.port());
  ASSERT_TRUE(client.say(std::string(kPoint) + "point x_mm=5 y_mm=2 z_mm=3\n"));
  const auto first = served.poll();
  ASSERT_TRUE(first && *first);
  EXPECT_DOUBLE_EQ((*first)->p_S.x(), 0.005);
  ASSERT_TRUE(client.say(kPoint));
  const auto second = served.poll();
  ASSERT_TRUE(second && *second);
  EXPECT_NE((*second)->sequence, (*first)->sequence);
}

TEST(PointServer, takes_a_number_that_is_repeated_for_no_new_point) {
  Served served;
  const PointClient client(served.server.port());
  ASSERT_TRUE(client.say("point x_mm=1 y_mm=2 z_mm=3 seq=7\n"));
  ASSERT_TRUE(served.has_point());
  for (int i = 0; i < 6; ++i) {
    ASSERT_TRUE(client.say("point x_mm=1 y_mm=2 z_mm=3 seq=7\n"));
    EXPECT_FALSE(served.failure(80));
  }
  ASSERT_TRUE(client.say("point x_mm=1 y_mm=2 z_mm=3 seq=7\n"));
  EXPECT_EQ(served.failure(80), Error::kSensorStale);
  ASSERT_TRUE(client.say("point x_mm=1 y_mm=2 z_mm=3 seq=8\n"));
  EXPECT_TRUE(served.has_point());
}

TEST(PointServer, takes_a_line_that_comes_in_halves_and_not_one_that_is_cut_off) {
  Served served;
  PointClient client(served.server.port());
  ASSERT_TRUE(client.say("point x_mm=1 y_mm"));
  EXPECT_FALSE(served.has_point());
  ASSERT_TRUE(client.say("=2 z_mm=3\npoint x_mm=1 y_mm=2 z_mm=3"));
  EXPECT_TRUE(served.has_point());
  client.close();
  EXPECT_FALSE(served.has_point());
  EXPECT_EQ(served.server.malformed(), 0U);
}

TEST(PointServer, passes_over_empty_lines_and_remarks) {
  Served served;
  const PointClient client(served.server.port());
  ASSERT_TRUE(client.say("\n# tracker warmed up\r\n\r\n"));
  EXPECT_FALSE(served.failure());
  EXPECT_EQ(served.server.malformed(), 0U);
}

TEST(PointServer, counts_lines_that_are_none_and_tells_what_is_wrong_with_them) {
  Served served;
  const PointClient client(served.server.port());
  ASSERT_TRUE(client.say("\x16\x03\x01garbage before\n"));
  EXPECT_EQ(served.failure(), Error::kSensorMalformed);
  EXPECT_EQ(served.server.words(Error::kSensorMalformed), "line 1: the line is not text");
  ASSERT_TRUE(client.say("point x_mm=1 y_mm=nan z_mm=3\n"));
  EXPECT_EQ(served.failure(), Error::kSensorMalformed);
  EXPECT_EQ(served.server.words(Error::kSensorMalformed), "line 2: y_mm is not a number");
  EXPECT_EQ(served.server.malformed(), 2U);
  EXPECT_EQ(client.heard(),
            "error why=\"line 1: the line is not text\"\n"
            "error why=\"line 2: y_mm is not a number\"\n");
  ASSERT_TRUE(client.say(kPoint));
  EXPECT_TRUE(served.has_point());
}

TEST(PointServer, refuses_a_line_without_an_end_once_and_reads_on_behind_it) {
  Served served;
  const PointClient client(served.server.port());
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(client.say(std::string(2000, '7')));
    (void)served.poll();
  }
  EXPECT_EQ(served.server.malformed(), 1U);
  EXPECT_EQ(served.server.words(Error::kSensorMalformed), "line 1: the line is too long");
  ASSERT_TRUE(client.say("\n" + std::string(kPoint)));
  EXPECT_TRUE(served.has_point());
}

TEST(PointServer, counts_as_old_what_it_cannot_keep_up_with) {
  Served served;
  const PointClient client(served.server.port());
  EXPECT_FALSE(served.has_point());
  const hal::Instant all_taken_at = served.now;
  std::string flood;
  while (flood.size() < 40'000) flood += kPoint;
  ASSERT_TRUE(client.say(flood));
  for (int i = 0; i < 2; ++i) {
    const auto polled = served.poll();
    ASSERT_TRUE(polled && *polled);
    EXPECT_EQ((*polled)->at, all_taken_at - milliseconds(100));
  }
}

TEST(PointServer, refuses_a_second_client_while_the_first_tells_points) {
  Served served;
  const PointClient first(served.server.port());
  ASSERT_TRUE(first.say(kPoint));
  ASSERT_TRUE(served.has_point());
  const PointClient second(served.server.port());
  ASSERT_TRUE(second.connected());
  EXPECT_FALSE(served.has_point());
  EXPECT_EQ(second.heard(), "error why=\"another instrument is connected\"\n");
  ASSERT_TRUE(first.say(kPoint));
  EXPECT_TRUE(served.has_point());
}

TEST(PointServer, gives_the_place_of_a_client_that_says_nothing_to_the_next) {
  Served served;
  const PointClient silent(served.server.port());
  (void)served.poll();
  const PointClient next(served.server.port());
  ASSERT_TRUE(next.say(kPoint));
  EXPECT_TRUE(served.has_point(600));
  EXPECT_EQ(silent.heard(), "error why=\"another instrument has connected\"\n");
}

TEST(PointServer, tells_silence_from_nobody_being_there) {
  Served served;
  EXPECT_EQ(served.failure(600), Error::kSensorPortGone);
  EXPECT_EQ(served.server.words(Error::kSensorPortGone), "nobody is connected to 127.0.0.1 port 0");
  PointClient client(served.server.port());
  EXPECT_EQ(served.failure(600), Error::kSensorSilent);
  client.close();
  EXPECT_FALSE(served.failure());
  EXPECT_EQ(served.failure(600), Error::kSensorPortGone);
}

TEST(PointServer, hears_only_the_client_that_the_configuration_names) {
  LineServerConfiguration configuration;
  configuration.client = "192.0.2.7";
  PointServer server(configuration);
  hal::Instant now{milliseconds(1000)};
  (void)server.poll(now);
  const PointClient client(server.port());
  ASSERT_TRUE(client.connected());
  EXPECT_TRUE(server.poll(now += milliseconds(10)));
  EXPECT_EQ(client.heard(), "error why=\"the configuration names another client\"\n");
}

TEST(PointServer, that_cannot_listen_says_why_and_tries_again) {
  auto first = std::make_unique<PointServer>(LineServerConfiguration{});
  hal::Instant now{milliseconds(1000)};
  (void)first->poll(now);
  const std::uint16_t port = first->port();
  ASSERT_NE(port, 0);
  LineServerConfiguration same;
  same.port = port;
  PointServer second(same);
  (void)second.poll(now);
  const auto polled = second.poll(now += milliseconds(600));
  ASSERT_FALSE(polled);
  EXPECT_EQ(test::failure_of(polled), Error::kSensorPortGone);
  EXPECT_EQ(second.words(Error::kSensorPortGone), "Address already in use");
  first.reset();
  (void)second.poll(now += milliseconds(6400));
  EXPECT_EQ(second.port(), port);
}

TEST(PointServer, compares_addresses_by_what_they_are) {
  EXPECT_EQ(canonical_address("0:0:0:0:0:0:0:1"), "::1");
  EXPECT_EQ(canonical_address("192.168.5.10"), "192.168.5.10");
  EXPECT_EQ(canonical_address("localhost"), "");
  EXPECT_EQ(canonical_address("192.168.5"), "");
  EXPECT_TRUE(is_loopback("127.0.0.1"));
  EXPECT_FALSE(is_loopback("0.0.0.0"));
}

TEST(LengthServer, hands_out_lengths_and_says_what_is_wrong_with_a_line) {
  LengthServer server{{}};
  hal::Instant now{milliseconds(1000)};
  (void)server.poll(now);
  const PointClient client(server.port());
  now += milliseconds(10);
  (void)server.poll(now);
  ASSERT_TRUE(client.say("lengths l1_mm=812.5 l3_mm=955 seq=3\npoint x_mm=1 y_mm=2 z_mm=3\n"));
  const hal::Instant looked_at = now;
  now += milliseconds(10);
  const auto polled = server.poll(now);
  ASSERT_TRUE(polled && *polled);
  ASSERT_EQ((*polled)->lengths_m.size(), 3U);
  EXPECT_EQ((*polled)->lengths_m[0], 0.8125);
  EXPECT_FALSE((*polled)->lengths_m[1]);
  EXPECT_EQ((*polled)->sequence, 3U);
  EXPECT_EQ((*polled)->at, looked_at - milliseconds(100));
  EXPECT_EQ(server.malformed(), 1U);
  EXPECT_EQ(client.heard(), "error why=\"line 2: the line does not begin with lengths\"\n");
}

}  // namespace
}  // namespace armsig::linux_hal
