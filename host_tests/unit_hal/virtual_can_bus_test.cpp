// SPDX-License-Identifier: MIT
#include "hal/simulated/virtual_can_bus.hpp"

#include <chrono>
#include <random>

#include <gtest/gtest.h>

#include "hal/canopen/bus_load.hpp"
#include "hal/simulated/can_bits.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/scripted_can_bus.hpp"

namespace armsig::simulated {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using test::frame;
using test::text;

hal::Instant at(microseconds time) { return hal::Instant(time); }

// Worked out by a Python program of its own that writes the frame as a string of bits, appends its
// CRC, inserts stuff bits and counts.
TEST(WireBits, agree_with_an_independent_count) {
  EXPECT_EQ(wire_bits(frame("080#")), 51U);
  EXPECT_EQ(wire_bits(frame("201#0F0000000000")), 106U);
  EXPECT_EQ(wire_bits(frame("000#0000000000000000")), 127U);
  EXPECT_EQ(wire_bits(frame("7FF#FFFFFFFFFFFFFFFF")), 126U);
  EXPECT_EQ(wire_bits(frame("555#5555555555555555")), 112U);
  EXPECT_EQ(wire_bits(frame("078#3C3C3C3C3C3C3C3C")), 131U);
}

TEST(WireBits, of_extended_frames_agree_with_an_independent_count) {
  EXPECT_EQ(wire_bits({.id = 0x0AAAAAAA, .extended = true}), 68U);
  EXPECT_EQ(wire_bits({.id = 0x12345678, .extended = true, .length = 3, .data = {1, 2, 3}}), 95U);
  hal::CanFrame ones{.id = 0x1FFFFFFF, .extended = true, .length = 8};
  ones.data.fill(0xFF);
  EXPECT_EQ(wire_bits(ones), 149U);
}

TEST(Precedence, is_by_the_first_eleven_bits_then_the_base_format_then_the_rest) {
  const hal::CanFrame base{.id = 0x201};
  const hal::CanFrame same{.id = 0x201U << 18U, .extended = true};
  const hal::CanFrame behind{.id = (0x201U << 18U) + 1, .extended = true};
  const hal::CanFrame before{.id = (0x201U << 18U) - 1, .extended = true};
  EXPECT_LT(precedence(before), precedence(base));
  EXPECT_LT(precedence(base), precedence(same));
  EXPECT_LT(precedence(same), precedence(behind));
  EXPECT_LT(precedence(behind), precedence({.id = 0x202}));
}

TEST(WireBits, never_exceed_the_worst_case) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 20000; ++trial) {
    hal::CanFrame f{.id = static_cast<std::uint32_t>(random() & 0x7FF),
                    .length = static_cast<std::uint8_t>(random() % 9)};
    for (auto& byte : f.data) byte = static_cast<std::uint8_t>(random() % 2 == 0 ? 0x3C : random());
    EXPECT_LE(wire_bits(f), canopen::worst_case_bits(f.length));
  }
}

TEST(VirtualCanBus, delivers_a_frame_when_its_last_bit_has_passed) {
  VirtualCanBus bus;
  VirtualCanPort a;
  VirtualCanPort b;
  bus.connect(a);
  bus.connect(b);
  ASSERT_TRUE(a.send(frame("080#")));
  bus.advance(at(microseconds(50)));
  EXPECT_FALSE(b.receive());
  bus.advance(at(microseconds(51)));
  const auto received = b.receive();
  ASSERT_TRUE(received);
  EXPECT_EQ(received->at, at(microseconds(51)));
  EXPECT_EQ(bus.busy(), microseconds(51));
}

TEST(VirtualCanBus, does_not_return_a_frame_to_its_sender) {
  VirtualCanBus bus;
  VirtualCanPort a;
  VirtualCanPort b;
  bus.connect(a);
  bus.connect(b);
  ASSERT_TRUE(a.send(frame("080#")));
  bus.advance(at(milliseconds(1)));
  EXPECT_FALSE(a.receive());
}

TEST(VirtualCanBus, the_lowest_identifier_wins_and_each_sender_keeps_its_order) {
  VirtualCanBus bus;
  VirtualCanPort a;
  VirtualCanPort b;
  VirtualCanPort listener;
  bus.connect(a);
  bus.connect(b);
  bus.connect(listener);
  ASSERT_TRUE(a.send(frame("300#01")));
  ASSERT_TRUE(a.send(frame("100#02")));
  ASSERT_TRUE(b.send(frame("200#03")));
  bus.advance(at(milliseconds(1)));
  EXPECT_EQ(text(listener.receive()->frame), "200#03");
  EXPECT_EQ(text(listener.receive()->frame), "300#01");
  EXPECT_EQ(text(listener.receive()->frame), "100#02");
}

TEST(VirtualCanBus, takes_as_long_at_125_kbit_as_eight_times_a_megabit) {
  VirtualCanBus bus(125'000);
  VirtualCanPort a;
  VirtualCanPort b;
  bus.connect(a);
  bus.connect(b);
  ASSERT_TRUE(a.send(frame("080#")));
  bus.advance(at(milliseconds(1)));
  EXPECT_EQ(b.receive()->at, at(microseconds(8 * 51)));
}

TEST(VirtualCanPort, is_busy_when_its_queue_is_full) {
  VirtualCanBus bus;
  VirtualCanPort a;
  bus.connect(a);
  for (std::size_t i = 0; i < VirtualCanPort::kSendQueue; ++i) ASSERT_TRUE(a.send(frame("080#")));
  EXPECT_EQ(test::failure_of(a.send(frame("080#"))), Error::kBusBusy);
}

TEST(VirtualCanPort, counts_what_its_queue_has_no_room_for) {
  VirtualCanBus bus;
  VirtualCanPort a;
  VirtualCanPort b;
  bus.connect(a);
  bus.connect(b);
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(a.send(frame("080#")));
    bus.advance(at(microseconds(60 * (i + 1))));
  }
  EXPECT_EQ(b.status().lost, 300 - VirtualCanPort::kReceiveQueue);
}

TEST(VirtualCanPort, neither_sends_nor_hears_when_down_and_recovers) {
  VirtualCanBus bus;
  VirtualCanPort a;
  VirtualCanPort b;
  bus.connect(a);
  bus.connect(b);
  b.set_up(false);
  EXPECT_EQ(test::failure_of(b.send(frame("080#"))), Error::kBusDown);
  EXPECT_EQ(b.status().state, hal::CanState::kDown);
  ASSERT_TRUE(a.send(frame("080#")));
  bus.advance(at(milliseconds(1)));
  EXPECT_FALSE(b.receive());
  b.set_up(true);
  EXPECT_TRUE(b.send(frame("080#")));
}

TEST(VirtualCanPort, comes_back_from_bus_off_after_a_pause) {
  VirtualCanBus bus;
  VirtualCanPort a;
  bus.connect(a);
  a.go_bus_off();
  EXPECT_EQ(test::failure_of(a.send(frame("080#"))), Error::kBusOff);
  EXPECT_EQ(a.status().state, hal::CanState::kBusOff);
  bus.advance(at(microseconds(99'999)));
  EXPECT_EQ(a.status().state, hal::CanState::kBusOff);
  bus.advance(at(microseconds(100'000)));
  EXPECT_EQ(a.status().state, hal::CanState::kActive);
  EXPECT_EQ(a.status().restarts, 1U);
  EXPECT_TRUE(a.send(frame("080#")));
}

TEST(VirtualClock, passes_only_when_it_is_waited_for) {
  VirtualClock clock;
  EXPECT_EQ(clock.now(), hal::Instant());
  EXPECT_EQ(clock.wait_until(at(milliseconds(2))), hal::Duration::zero());
  EXPECT_EQ(clock.now(), at(milliseconds(2)));
  EXPECT_EQ(clock.wait_until(at(milliseconds(1))), milliseconds(1));
  EXPECT_EQ(clock.now(), at(milliseconds(2)));
}

// A computer that wakes everybody 3 ms late, and was switched on an hour ago.
struct LateClock final : hal::Clock {
  hal::Instant do_now() override { return time; }
  hal::Duration do_wait_until(hal::Instant tick) override {
    time = std::max(time, tick + milliseconds(3));
    return time - tick;
  }
  hal::Instant time = at(std::chrono::hours(1));
};

struct Driven final : TimeDriven {
  void do_advance(hal::Instant until) override { reached = until; }
  hal::Instant reached;
};

TEST(VirtualClock, is_as_late_as_the_real_clock_that_it_goes_by_and_so_is_its_world) {
  LateClock real;
  VirtualClock clock(real);
  Driven world;
  clock.add(world);
  EXPECT_EQ(clock.now(), hal::Instant());
  EXPECT_EQ(clock.wait_until(at(milliseconds(2))), milliseconds(3));
  EXPECT_EQ(clock.now(), at(milliseconds(5)));
  EXPECT_EQ(world.reached, at(milliseconds(5)));
  EXPECT_EQ(clock.wait_until(at(milliseconds(4))), milliseconds(3));
  EXPECT_EQ(world.reached, at(milliseconds(7)));
}

}  // namespace
}  // namespace armsig::simulated
