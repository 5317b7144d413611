// SPDX-License-Identifier: MIT
// Frames are written by hand from the wire map: node 32, TPDO1 1A0h, flight times in 2A0h to 4A0h.
#include <gtest/gtest.h>

#include "hal/canopen/range_sensor.hpp"
#include "hal/simulated/range_node.hpp"
#include "hal/simulated/virtual_can_bus.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/range_readings.hpp"
#include "host_tests/support/scripted_can_bus.hpp"

namespace armsig::canopen {
namespace {

using test::at_ms;

struct Fixture {
  RangeSensor sensor{{.receivers = 4}};
  void take(const char* text, int ms = 0) { sensor.take({test::frame(text), at_ms(ms)}); }
  // Receivers 0, 1, 3 valid, 23.0 degrees C, 1500000 to 1500003 ns.
  void take_reading(const char* opening = "1A0#0B07E600", int ms = 0) {
    take(opening, ms);
    take("2A0#60E3160061E31600", ms);
    take("3A0#62E3160063E31600", ms);
  }
};

TEST(CanRangeSensor, decodes_a_reading) {
  Fixture f;
  f.take_reading("1A0#0B07E600", 5);
  const auto reading = f.sensor.poll(at_ms(6));
  ASSERT_TRUE(reading && *reading);
  EXPECT_EQ((*reading)->sequence, 7U);
  EXPECT_DOUBLE_EQ((*reading)->air_celsius, 23.0);
  EXPECT_EQ((*reading)->at, at_ms(5));
  ASSERT_EQ((*reading)->receivers.size(), 4U);
  EXPECT_TRUE((*reading)->receivers[0].valid);
  EXPECT_FALSE((*reading)->receivers[2].valid);
  EXPECT_TRUE((*reading)->receivers[3].valid);
  EXPECT_DOUBLE_EQ((*reading)->receivers[3].flight_s, 1500003e-9);
}

TEST(CanRangeSensor, takes_one_flight_time_a_frame_as_well) {
  RangeSensor sensor({.receivers = 3});
  for (const char* text : {"1A0#0701E600", "2A0#60E31600", "3A0#61E31600", "4A0#62E31600"}) {
    sensor.take({test::frame(text), at_ms(0)});
  }
  const auto reading = sensor.poll(at_ms(0));
  ASSERT_TRUE(reading && *reading);
  EXPECT_DOUBLE_EQ((*reading)->receivers[2].flight_s, 1500002e-9);
}

TEST(CanRangeSensor, reads_temperatures_below_zero) {
  Fixture f;
  f.take_reading("1A0#0F079CFF");
  EXPECT_DOUBLE_EQ((*f.sensor.poll(at_ms(0)))->air_celsius, -10.0);
}

TEST(CanRangeSensor, halves_echoes) {
  RangeSensor sensor({.receivers = 1, .echo = true});
  sensor.take({test::frame("1A0#0101E600"), at_ms(0)});
  sensor.take({test::frame("2A0#60E31600"), at_ms(0)});
  EXPECT_DOUBLE_EQ((*sensor.poll(at_ms(0)))->receivers[0].flight_s, 750000e-9);
}

TEST(CanRangeSensor, hands_a_reading_out_once) {
  Fixture f;
  f.take_reading();
  EXPECT_TRUE(f.sensor.poll(at_ms(0))->has_value());
  EXPECT_FALSE(f.sensor.poll(at_ms(0))->has_value());
}

TEST(CanRangeSensor, does_not_hand_out_a_repeated_sequence_and_calls_it_stale_in_time) {
  Fixture f;
  f.take_reading("1A0#0B07E600", 0);
  EXPECT_TRUE(f.sensor.poll(at_ms(0))->has_value());
  for (int ms = 50; ms <= 500; ms += 50) {
    f.take_reading("1A0#0B07E600", ms);
    EXPECT_FALSE(f.sensor.poll(at_ms(ms))->has_value());
  }
  f.take_reading("1A0#0B07E600", 501);
  EXPECT_EQ(test::failure_of(f.sensor.poll(at_ms(501))), Error::kSensorStale);
  f.take_reading("1A0#0B08E600", 550);
  EXPECT_TRUE(f.sensor.poll(at_ms(550))->has_value());
}

TEST(CanRangeSensor, is_silent_after_the_time_allowed_and_says_so_again_later) {
  RangeSensor sensor({});
  EXPECT_FALSE(sensor.poll(at_ms(1000))->has_value());
  EXPECT_FALSE(sensor.poll(at_ms(1500))->has_value());
  EXPECT_EQ(test::failure_of(sensor.poll(at_ms(1501))), Error::kSensorSilent);
  EXPECT_FALSE(sensor.poll(at_ms(1502))->has_value());
  EXPECT_EQ(test::failure_of(sensor.poll(at_ms(2002))), Error::kSensorSilent);
}

TEST(CanRangeSensor, calls_frames_out_of_order_or_of_a_wrong_length_malformed) {
  for (const auto& frames : {std::vector<const char*>{"2A0#60E3160061E31600"},
                             {"1A0#0B07E6"},
                             {"1A0#0B07E600", "3A0#62E3160063E31600"},
                             {"1A0#0B07E600", "2A0#60E316"},
                             {"1A0#0B07E600", "2A0#"},
                             {"1A0#0B07E600", "1A0#0B08E600"}}) {
    Fixture f;
    for (const char* text : frames) f.take(text);
    EXPECT_EQ(test::failure_of(f.sensor.poll(at_ms(0))), Error::kSensorMalformed) << frames.back();
  }
}

// What is left of two readings, when the last frame of one and the first of the next are lost.
TEST(CanRangeSensor, never_takes_frames_of_two_readings_for_one) {
  simulated::VirtualCanBus bus;
  simulated::VirtualCanPort listener;
  simulated::VirtualCanPort port;
  simulated::RangeNode node(32, port);
  bus.connect(listener);
  bus.connect(port, &node);
  bus.advance(at_ms(2));
  ASSERT_TRUE(listener.send(nmt_frame(NmtCommand::kStart, 32)));
  bus.advance(at_ms(3));
  while (listener.receive()) {
  }
  std::vector<hal::CanFrame> frames;  // four a reading
  for (std::uint32_t i = 0; i < 2; ++i) {
    node.publish(test::reading(i, {1e-3 + i * 1e-4, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3 + i * 1e-4}));
    bus.advance(at_ms(10 + static_cast<int>(i)));
    while (const auto received = listener.receive()) frames.push_back(received->frame);
  }
  ASSERT_EQ(frames.size(), 8U);
  for (unsigned lost = 0; lost < 256; ++lost) {
    RangeSensor sensor({.receivers = 6});
    for (unsigned k = 0; k < 8; ++k) {
      if ((lost >> k & 1U) == 0) sensor.take({frames[k], at_ms(0)});
      const auto reading = sensor.poll(at_ms(0));
      if (!reading || !*reading) continue;
      const double first = 1e-3 + (*reading)->sequence * 1e-4;
      const double last = 6e-3 + (*reading)->sequence * 1e-4;
      EXPECT_NEAR((*reading)->receivers[0].flight_s, first, 1e-9) << lost;
      EXPECT_NEAR((*reading)->receivers[5].flight_s, last, 1e-9) << lost;
    }
  }
}

TEST(CanRangeSensor, takes_a_reading_without_crc_only_if_it_came_at_once) {
  Fixture at_once;
  at_once.take("1A0#0B07E600", 0);
  at_once.take("2A0#60E3160061E31600", 2);
  at_once.take("3A0#62E3160063E31600", 5);
  EXPECT_TRUE(at_once.sensor.poll(at_ms(5))->has_value());
  Fixture late;
  late.take("1A0#0B07E600", 0);
  late.take("2A0#60E3160061E31600", 2);
  late.take("3A0#62E3160063E31600", 6);
  EXPECT_EQ(test::failure_of(late.sensor.poll(at_ms(6))), Error::kSensorMalformed);
}

TEST(CanRangeSensor, ignores_other_nodes_and_remote_frames) {
  Fixture f;
  f.take("1A1#0B07E600");
  f.take("2A1#60E3160061E31600");
  f.sensor.take({{.id = 0x1A0, .remote = true, .length = 4}, at_ms(0)});
  EXPECT_TRUE(f.sensor.poll(at_ms(0)));
}

TEST(CanRangeSensor, reads_on_past_an_extended_or_a_remote_frame) {
  for (const bool remote : {false, true}) {
    Fixture f;
    f.take("1A0#0B07E600");
    for (const char* text : {"1A0#0B08E600", "2A0#60E3160061E31600", "4A0#"}) {
      hal::CanFrame frame = test::frame(text);
      frame.extended = !remote;
      frame.remote = remote;
      f.sensor.take({frame, at_ms(0)});
    }
    f.take("2A0#60E3160061E31600");
    f.take("3A0#62E3160063E31600");
    const auto reading = f.sensor.poll(at_ms(0));
    ASSERT_TRUE(reading && *reading);
    EXPECT_EQ((*reading)->sequence, 7U);
  }
}

TEST(CanRangeSensor, takes_nothing_after_a_wrong_frame_up_to_the_next_opening) {
  for (const char* wrong : {"4A0#62E3160063E31600", "2A0#60E316", "1A0#0B07E6"}) {
    Fixture f;
    f.take("1A0#0B07E600");
    f.take(wrong);
    EXPECT_EQ(test::failure_of(f.sensor.poll(at_ms(0))), Error::kSensorMalformed) << wrong;
    f.take("2A0#60E3160061E31600");
    f.take("3A0#62E3160063E31600");
    EXPECT_EQ(test::failure_of(f.sensor.poll(at_ms(0))), Error::kSensorMalformed) << wrong;
    f.take_reading("1A0#0B08E600");
    EXPECT_TRUE(f.sensor.poll(at_ms(0))->has_value()) << wrong;
  }
}

TEST(CanRangeSensor, refuses_a_node_or_a_number_of_receivers_that_cannot_be) {
  EXPECT_EQ(test::failure_of(check(RangeNodeConfiguration{.node = 0})), Error::kNodeOutOfRange);
  EXPECT_EQ(test::failure_of(check(RangeNodeConfiguration{.node = 128})), Error::kNodeOutOfRange);
  EXPECT_EQ(test::failure_of(check(RangeNodeConfiguration{.receivers = 0})),
            Error::kProfileInvalid);
  EXPECT_EQ(test::failure_of(check(RangeNodeConfiguration{.receivers = 7})),
            Error::kProfileInvalid);
  EXPECT_TRUE(check(RangeNodeConfiguration{.receivers = 6}));
}

TEST(CanRangeSensor, tells_its_traffic_for_the_bus_load) {
  const auto frames = traffic({.receivers = 5}, std::chrono::milliseconds(20));
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_EQ(frames[0].data_bytes, 8);
  EXPECT_EQ(frames[1].data_bytes, 8);
  EXPECT_EQ(frames[3].data_bytes, 4);
}

TEST(RangeNode, sends_what_the_sensor_reads_once_it_is_started) {
  simulated::VirtualCanBus bus;
  simulated::VirtualCanPort master;
  simulated::VirtualCanPort port;
  simulated::RangeNode node(32, port);
  bus.connect(master);
  bus.connect(port, &node);
  RangeSensor sensor({.receivers = 4});
  const hal::RangeReading sent = test::reading(9, {1.5e-3, 0, 2.5e-3, 4e-3}, -5.5);
  node.publish(sent);  // not operational: not sent
  bus.advance(at_ms(1));
  bus.advance(at_ms(2));
  const auto boot_up = master.receive();
  ASSERT_TRUE(boot_up);
  EXPECT_EQ(test::text(boot_up->frame), "720#00");
  EXPECT_FALSE(master.receive());
  ASSERT_TRUE(master.send(nmt_frame(NmtCommand::kStart, 32)));
  bus.advance(at_ms(3));
  node.publish(sent);
  bus.advance(at_ms(4));
  while (const auto received = master.receive()) sensor.take(*received);
  const auto reading = sensor.poll(at_ms(4));
  ASSERT_TRUE(reading && *reading);
  EXPECT_EQ((*reading)->sequence, 9U);
  EXPECT_DOUBLE_EQ((*reading)->air_celsius, -5.5);
  EXPECT_FALSE((*reading)->receivers[1].valid);
  EXPECT_DOUBLE_EQ((*reading)->receivers[3].flight_s, 4e-3);
}

TEST(CanRangeSensor, refuses_more_flights_than_it_has_receivers) {
  RangeSensor sensor({.receivers = 1});
  sensor.take({test::frame("1A0#0101E600"), at_ms(0)});
  sensor.take({test::frame("2A0#60E3160061E31600"), at_ms(0)});
  const auto reading = sensor.poll(at_ms(0));
  ASSERT_FALSE(reading);
  EXPECT_EQ(test::failure_of(reading), Error::kSensorMalformed);
}

}  // namespace
}  // namespace armsig::canopen
