// SPDX-License-Identifier: MIT
// The SocketCAN backend on the interfaces vcan0 and vcan1 of a real kernel. Run it by
// toolchain/uml_can --interfaces 2; it takes interfaces down and removes them, so never on a real
// machine's bus.
#include <linux/can.h>
#include <linux/can/error.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "hal/canopen/master.hpp"
#include "hal/linux/file_descriptor.hpp"
#include "hal/linux/socket_can.hpp"
#include "hal/linux/steady_clock.hpp"
#include "hal/simulated/drive.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_drives.hpp"
#include "host_tests/support/scripted_can_bus.hpp"

namespace armsig::linux_hal {
namespace {

using hal::CanState;
using hal::DriveCondition;
using std::chrono::milliseconds;
using test::frame;
using test::text;

void ip(const std::string& arguments) {
  EXPECT_EQ(std::system(("ip link " + arguments).c_str()), 0) << arguments;
}

bool eventually(const std::function<bool()>& condition, hal::Duration most = milliseconds(3000)) {
  for (const hal::Instant end = monotonic_now() + most; monotonic_now() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(milliseconds(1));
  }
  return condition();
}

std::optional<hal::ReceivedCanFrame> next(hal::CanBus& bus) {
  std::optional<hal::ReceivedCanFrame> received;
  eventually([&] { return (received = bus.receive()).has_value(); }, milliseconds(500));
  return received;
}

// Anything at all on vcan0, as cansend would do it.
void inject(canid_t id, std::uint8_t second_byte = 0) {
  const FileDescriptor socket(::socket(PF_CAN, SOCK_RAW, CAN_RAW));
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex("vcan0"));
  ASSERT_EQ(bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  can_frame raw{};
  raw.can_id = id;
  raw.len = CAN_ERR_DLC;
  raw.data[1] = second_byte;
  ASSERT_EQ(write(socket.get(), &raw, sizeof raw), static_cast<ssize_t>(sizeof raw));
}

TEST(SocketCan, carries_frames_both_ways_and_not_back_to_the_sender) {
  SocketCan a({.interface_name = "vcan0", .filters = {}});
  SocketCan b({.interface_name = "vcan0", .filters = {}});
  EXPECT_EQ(a.status().state, CanState::kActive);
  ASSERT_TRUE(a.send(frame("123#0102030405060708")));
  ASSERT_TRUE(b.send(frame("321#")));
  const auto at_b = next(b);
  const auto at_a = next(a);
  ASSERT_TRUE(at_a && at_b);
  EXPECT_EQ(text(at_b->frame), "123#0102030405060708");
  EXPECT_EQ(text(at_a->frame), "321#");
  EXPECT_FALSE(a.receive());
  EXPECT_EQ(a.status().sent, 1U);
  EXPECT_EQ(a.status().received, 1U);
}

TEST(SocketCan, stamps_frames_in_monotonic_time) {
  SocketCan a({.interface_name = "vcan0", .filters = {}});
  SocketCan b({.interface_name = "vcan0", .filters = {}});
  const hal::Instant before = monotonic_now();
  ASSERT_TRUE(a.send(frame("123#")));
  const hal::Instant after = monotonic_now();
  std::this_thread::sleep_for(milliseconds(30));
  const auto received = next(b);
  ASSERT_TRUE(received);
  // The two clocks are read one after the other: a preemption between them shifts the stamp.
  EXPECT_GE(received->at, before - milliseconds(10));
  EXPECT_LE(received->at, after + milliseconds(10));
}

TEST(SocketCan, lets_only_frames_through_that_its_filters_name) {
  SocketCan a({.interface_name = "vcan0", .filters = {}});
  SocketCan b({.interface_name = "vcan0", .filters = {{0x1A0, 0x7FF}, {0x700, 0x780}}});
  for (const char* sent : {"181#", "1A0#01", "080#", "77F#05"}) ASSERT_TRUE(a.send(frame(sent)));
  EXPECT_EQ(text(next(b)->frame), "1A0#01");
  EXPECT_EQ(text(next(b)->frame), "77F#05");
  EXPECT_FALSE(b.receive());
}

TEST(SocketCan, leaves_extended_and_remote_frames_to_the_kernel) {
  SocketCan a({.interface_name = "vcan0", .filters = {}});
  inject(0x181 | CAN_EFF_FLAG);
  inject(0x181 | CAN_RTR_FLAG);
  inject(0x182);
  EXPECT_EQ(text(next(a)->frame).substr(0, 3), "182");
  EXPECT_FALSE(a.receive());
}

TEST(SocketCan, is_down_without_its_interface_and_says_why) {
  SocketCan a({.interface_name = "vcan99", .filters = {}});
  EXPECT_EQ(a.status().state, CanState::kDown);
  EXPECT_EQ(test::failure_of(a.send(frame("123#"))), Error::kBusDown);
  EXPECT_EQ(a.last_errno(), ENODEV);
  SocketCan b({.interface_name = "a_name_that_is_too_long", .filters = {}});
  EXPECT_EQ(b.last_errno(), EINVAL);
}

TEST(SocketCan, goes_on_after_its_interface_was_down) {
  SocketCan a({.interface_name = "vcan0", .filters = {}});
  SocketCan b({.interface_name = "vcan0", .filters = {}});
  ip("set vcan0 down");
  EXPECT_EQ(a.status().state, CanState::kDown);
  EXPECT_EQ(test::failure_of(a.send(frame("123#"))), Error::kBusDown);
  EXPECT_FALSE(a.receive());
  ip("set vcan0 up");
  EXPECT_TRUE(eventually([&] { return a.status().state == CanState::kActive; }));
  (void)b.status();
  (void)b.receive();  // takes the socket's "network is down"
  ASSERT_TRUE(a.send(frame("124#")));
  EXPECT_EQ(text(next(b)->frame), "124#");
}

TEST(SocketCan, opens_its_interface_again_when_it_was_removed) {
  SocketCan a({.interface_name = "vcan1", .filters = {}});
  EXPECT_EQ(a.status().state, CanState::kActive);
  ip("delete vcan1");
  EXPECT_EQ(a.status().state, CanState::kDown);
  EXPECT_EQ(test::failure_of(a.send(frame("123#"))), Error::kBusDown);
  ip("add vcan1 type vcan");
  ip("set vcan1 up");
  EXPECT_TRUE(eventually([&] {
    (void)a.receive();
    return a.status().state == CanState::kActive;
  }));
  SocketCan b({.interface_name = "vcan1", .filters = {}});
  ASSERT_TRUE(a.send(frame("125#")));
  EXPECT_EQ(text(next(b)->frame), "125#");
}

TEST(SocketCan, follows_the_controllers_error_states) {
  SocketCan a({.interface_name = "vcan0", .filters = {}});
  inject(CAN_ERR_FLAG | CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING);
  EXPECT_FALSE(next(a));
  EXPECT_EQ(a.status().state, CanState::kWarning);
  inject(CAN_ERR_FLAG | CAN_ERR_CRTL, CAN_ERR_CRTL_RX_PASSIVE);
  EXPECT_FALSE(next(a));
  EXPECT_EQ(a.status().state, CanState::kPassive);
  inject(CAN_ERR_FLAG | CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE);
  EXPECT_FALSE(next(a));
  EXPECT_EQ(a.status().state, CanState::kActive);
  inject(CAN_ERR_FLAG | CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW);
  EXPECT_FALSE(next(a));
  EXPECT_EQ(a.status().lost, 1U);
  EXPECT_EQ(a.status().error_frames, 4U);
}

TEST(SocketCan, comes_back_from_bus_off_after_a_growing_pause) {
  SocketCan a({.interface_name = "vcan0", .filters = {}});
  hal::Duration shortest = milliseconds(100);
  for (int times = 1; times <= 3; ++times, shortest *= 2) {
    const hal::Instant begin = monotonic_now();
    inject(CAN_ERR_FLAG | CAN_ERR_BUSOFF);
    ASSERT_TRUE(eventually([&] {
      (void)a.receive();
      return a.status().state == CanState::kBusOff;
    }));
    EXPECT_EQ(test::failure_of(a.send(frame("123#"))), Error::kBusOff);
    ASSERT_TRUE(eventually([&] { return a.status().state == CanState::kActive; }));
    EXPECT_GE(monotonic_now() - begin, shortest);
    EXPECT_EQ(a.status().bus_offs, static_cast<unsigned>(times));
    EXPECT_EQ(a.status().restarts, static_cast<unsigned>(times));
  }
  EXPECT_TRUE(a.send(frame("123#")));
}

TEST(SocketCan, leaves_the_restart_to_the_thread_that_maintains_it) {
  SocketCan a({.interface_name = "vcan0", .filters = {}, .maintained = true});
  inject(CAN_ERR_FLAG | CAN_ERR_BUSOFF);
  const hal::Instant begin = monotonic_now();
  EXPECT_FALSE(eventually(
      [&] {
        (void)a.receive();
        return a.status().state == CanState::kActive && monotonic_now() - begin > milliseconds(500);
      },
      milliseconds(1000)));
  EXPECT_EQ(a.status().state, CanState::kBusOff);
  a.maintain();
  EXPECT_EQ(a.status().state, CanState::kActive);
  EXPECT_EQ(a.status().restarts, 1U);
}

// Six emulated drives in one thread, the master in another, both in real time on the same kernel.
class DrivesInAThread {
 public:
  explicit DrivesInAThread(std::uint8_t count) : bus_({.interface_name = "vcan0", .filters = {}}) {
    for (std::uint8_t node = 1; node <= count; ++node) {
      // The host's scheduling is no drive's: SYNC may be late.
      drives_.emplace_back(
          simulated::DriveConfiguration{.node = node, .motion = {}, .sync_loss_periods = 0}, bus_,
          monotonic_now());
    }
    thread_ = std::thread([this] { run(); });
  }
  ~DrivesInAThread() {
    stop_ = true;
    thread_.join();
  }
  DrivesInAThread(const DrivesInAThread&) = delete;
  DrivesInAThread& operator=(const DrivesInAThread&) = delete;

  // To be asked for by the drives' own thread at its next step.
  std::atomic<int> emergency_of{-1};

 private:
  void run() {
    while (!stop_) {
      const int joint = emergency_of.exchange(-1);
      if (joint >= 0) {
        drives_[static_cast<std::size_t>(joint)].inject(simulated::DriveFault::kEmergency, 0x2310);
      }
      (void)bus_.status();
      while (const auto received = bus_.receive()) {
        for (auto& drive : drives_) {
          drive.advance(received->at);
          drive.take(*received);
        }
      }
      const hal::Instant now = monotonic_now();
      for (auto& drive : drives_) drive.advance(now);
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  }

  SocketCan bus_;
  std::deque<simulated::Drive> drives_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

TEST(SocketCan, a_master_enables_moves_and_stops_six_drives_in_real_time) {
  canopen::Configuration configuration = test::puma_drives();
  // User-Mode Linux on a loaded host may stand still for a tenth of a second: what is shown here is
  // that everything works over a real kernel, not how fast.
  configuration.period = milliseconds(10);
  configuration.missed_feedback_limit = 100;
  configuration.heartbeat_timeout = milliseconds(2000);
  configuration.sdo_timeout = milliseconds(1000);
  configuration.boot_timeout = milliseconds(10000);
  configuration.transition_timeout = milliseconds(5000);
  for (auto& axis : configuration.axes) axis.largest_speed = 10;
  DrivesInAThread drives(6);
  SocketCan bus({.interface_name = "vcan0", .filters = {}});
  canopen::Master master(*canopen::check(configuration), bus);
  SteadyClock clock;
  hal::Instant tick = clock.now();
  JointVector targets(6);
  bool following = false;
  const auto run_tick = [&] {
    EXPECT_TRUE(master.read(clock.now()));
    if (!following) targets = master.positions();
    (void)master.write(targets, clock.now());
    // A tick that is missed is left out, not made up for.
    tick = std::max(tick + configuration.period, clock.now());
    clock.wait_until(tick);
  };
  const auto run_until = [&](DriveCondition condition) {
    const hal::Instant end = clock.now() + std::chrono::seconds(60);
    while (!master.all(condition) && clock.now() < end) run_tick();
    for (std::size_t joint = 0; joint < 6 && !master.all(condition); ++joint) {
      const hal::DriveStatus status = master.status(joint);
      ADD_FAILURE() << "joint " << joint << ": "
                    << (status.fault ? describe(*status.fault) : "no fault") << ", code "
                    << status.fault_code;
    }
    return master.all(condition);
  };
  ASSERT_TRUE(run_until(DriveCondition::kDisabled));
  ASSERT_TRUE(master.enable());
  ASSERT_TRUE(run_until(DriveCondition::kEnabled));
  following = true;
  for (int i = 0; i < 250; ++i) {
    for (double& target : targets) target = 0.25 * (1 - std::cos(0.02 * i));
    run_tick();
  }
  const auto reached = targets;
  for (int i = 0; i < 100; ++i) run_tick();
  for (std::size_t joint = 0; joint < 6; ++joint) {
    EXPECT_NEAR(master.positions()[joint], reached[joint], 1e-4);
    EXPECT_EQ(master.status(joint).condition, DriveCondition::kEnabled);
  }
  drives.emergency_of = 2;
  for (int i = 0; i < 50; ++i) run_tick();
  EXPECT_EQ(master.status(2).fault, Error::kDriveEmergency);
  EXPECT_EQ(master.status(2).fault_code, 0x2310U);
  EXPECT_EQ(master.status(0).condition, DriveCondition::kStopped);
  EXPECT_EQ(master.counters().unknown, 0U);
  EXPECT_EQ(master.counters().malformed, 0U);
}

}  // namespace
}  // namespace armsig::linux_hal
