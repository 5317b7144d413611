// SPDX-License-Identifier: MIT
// What can go wrong about a moving arm beyond its drives' own faults: the bus, the path, the
// operators, the store. Each ends in a safe state under its name, with nothing stored changed.
#include <random>

#include <gtest/gtest.h>

#include "core/base/error_name.hpp"
#include "host_tests/support/moving_puma.hpp"
#include "host_tests/support/target_differences.hpp"

namespace armsig::controller {
namespace {

using cia402::State;
using test::LineConsole;
using test::MovingPuma;
using test::PumaCabinet;

constexpr double kTick_s = 0.002;

bool any_enabled(PumaCabinet& puma) {
  for (std::size_t i = 0; i < 6; ++i) {
    if (puma.cabinet->drive(i).state() == State::kOperationEnabled) return true;
  }
  return false;
}

bool told(const LineConsole& console, const std::string& words) {
  return std::ranges::any_of(console.told,
                             [&](const std::string& line) { return line.starts_with(words); });
}

// Ticks from the fault until no drive is under power.
int ticks_until_safe(PumaCabinet& puma) {
  int ticks = 0;
  for (; ticks < 1000 && any_enabled(puma); ++ticks) puma.cabinet->step();
  return ticks;
}

void expect_recovery(PumaCabinet& puma) {
  EXPECT_EQ(puma.memory.stored, 0U);
  EXPECT_EQ(puma.ask("reset"), "ok");
  EXPECT_TRUE(puma.enable());
}

TEST(BusFaults, sync_that_a_drive_does_not_hear_stops_all_of_them) {
  MovingPuma puma;
  puma.cabinet->drive(2).inject(simulated::DriveFault::kSyncLost);
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 0.1));
  EXPECT_EQ(puma.now().fault->error, Error::kFeedbackLost);
  EXPECT_EQ(puma.now().fault->joint, 2U);
  EXPECT_LE(ticks_until_safe(puma), 3);
  EXPECT_TRUE(told(puma.console, "# mode faulted error=FEEDBACK_LOST reason=\""));
  puma.cabinet->drive(2).inject(simulated::DriveFault::kNone);
  expect_recovery(puma);
}

// Nothing can be told to the drives then: they stop by themselves for want of SYNC.
TEST(BusFaults, an_interface_taken_down_and_up_is_told_and_can_be_reset) {
  MovingPuma puma;
  puma.cabinet->master_port().set_up(false);
  puma.run(kTick_s);
  EXPECT_EQ(puma.mode(), Mode::kFaulted);
  EXPECT_EQ(puma.now().fault->error, Error::kBusDown);
  EXPECT_TRUE(told(puma.console, "# mode faulted error=BUS_DOWN"));
  EXPECT_LE(ticks_until_safe(puma), 6);  // sync_loss_periods of the emulated drive, and one
  puma.cabinet->master_port().set_up(true);
  puma.run(0.1);
  EXPECT_EQ(puma.mode(), Mode::kFaulted) << "only a reset ends it";
  expect_recovery(puma);
}

TEST(BusFaults, a_reset_while_the_interface_is_down_waits_for_it) {
  MovingPuma puma;
  puma.cabinet->master_port().set_up(false);
  puma.run(0.1);
  EXPECT_EQ(puma.ask("reset"), "ok");
  puma.run(0.5);
  EXPECT_EQ(puma.mode(), Mode::kStarting);
  EXPECT_EQ(puma.now().fault->error, Error::kBusDown);
  puma.cabinet->master_port().set_up(true);
  EXPECT_TRUE(puma.enable());
}

TEST(BusFaults, bus_off_is_told_and_can_be_reset) {
  MovingPuma puma;
  puma.cabinet->master_port().go_bus_off();
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 0.01));
  EXPECT_EQ(puma.now().fault->error, Error::kBusOff);
  EXPECT_LE(ticks_until_safe(puma), 6);
  puma.run(0.3);
  EXPECT_EQ(puma.mode(), Mode::kFaulted);
  expect_recovery(puma);
}

TEST(BusFaults, in_the_middle_of_an_identification_end_it) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  puma.run(5);
  puma.cabinet->master_port().go_bus_off();
  puma.run(0.3);
  EXPECT_EQ(puma.mode(), Mode::kFaulted);
  EXPECT_FALSE(puma.cabinet->state().identification().is_running());
  EXPECT_TRUE(told(puma.console, "# identify ended error=BUS_OFF"));
  expect_recovery(puma);
  EXPECT_TRUE(puma.ask("candidate").starts_with("error NO_CANDIDATE "));
}

// From q with the forearm bent, where lines of the tool are free.
struct Elbow : PumaCabinet {
  Elbow() {
    EXPECT_TRUE(bend_wrist());
    run(0.3);
  }
  void expect_refused(const std::string& request, Error error) {
    const JointVector before = now().commanded;
    const std::string reply = ask(request);
    EXPECT_TRUE(reply.starts_with("error " + std::string(name(error)) + " ")) << reply;
    run(0.1);
    EXPECT_EQ(mode(), Mode::kHolding);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(now().commanded[i], before[i]);
    EXPECT_EQ(memory.stored, 0U);
  }
};

TEST(PathFaults, a_line_that_meets_a_joint_limit_in_its_middle_is_refused_before_it_begins) {
  Elbow puma;
  ASSERT_EQ(puma.ask("move q4_deg=0 q5_deg=95"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kServoing, 0.1));
  ASSERT_TRUE(puma.run_until(Mode::kHolding));
  puma.run(0.3);
  puma.expect_refused("move dz_mm=-250", Error::kJointLimit);
}

TEST(PathFaults, a_line_through_a_singularity_and_one_out_of_reach_are_refused) {
  PumaCabinet straight;  // axes 4 and 6 are one line
  ASSERT_TRUE(straight.enable());
  EXPECT_TRUE(straight.ask("move dx_mm=-150 dy_mm=150").starts_with("error SINGULAR_PATH "));
  Elbow puma;
  puma.expect_refused("move x_mm=3000 y_mm=0 z_mm=0", Error::kOutOfReach);
}

TEST(Halt, brings_a_joint_move_to_rest_on_its_path_within_the_limits) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  const JointVector from = puma.now().commanded;
  test::TargetDifferences targets(from, kTick_s);
  const auto step = [&] {
    puma.cabinet->step();
    const JointVector& q = puma.now().commanded;
    // Joints 1 and 2 go 90 and 60 degrees on one straight line of joint space.
    EXPECT_NEAR((q[0] - from[0]) / radians(90), (q[1] - from[1]) / radians(60), 1e-5);
    targets.add(q);
  };
  puma.console.requests.emplace_back("move q1_deg=90 q2_deg=-30");
  for (int i = 0; i < 250; ++i) step();
  EXPECT_EQ(puma.mode(), Mode::kServoing);
  puma.console.requests.emplace_back("halt");
  for (int i = 0; i < 2000 && puma.mode() == Mode::kServoing; ++i) step();
  EXPECT_EQ(puma.mode(), Mode::kHolding);
  for (int i = 0; i < 3; ++i) step();
  targets.expect_within(test::puma_controller().limits, test::kTargetRounding);
  EXPECT_LT(puma.now().commanded[0], radians(89));
  EXPECT_TRUE(any_enabled(puma));
  puma.run(0.3);
  EXPECT_EQ(puma.ask("move q1_deg=0"), "ok");
}

TEST(Halt, ends_a_sequence_and_is_refused_without_torque) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  EXPECT_TRUE(puma.ask("halt").starts_with("error WRONG_MODE "));
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  puma.run(3);
  EXPECT_EQ(puma.ask("halt"), "ok");
  EXPECT_TRUE(puma.run_until(Mode::kHolding));
  EXPECT_FALSE(puma.cabinet->state().identification().is_running());
  EXPECT_TRUE(told(puma.console, "# identify ended error=SEQUENCE_STOPPED"));
}

TEST(Consoles, two_operators_are_answered_each_and_told_the_same) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.console.requests.emplace_back("enable");
  puma.other.requests.emplace_back("enable");
  puma.run(1);
  ASSERT_EQ(puma.console.replies.size(), 1U);
  ASSERT_EQ(puma.other.replies.size(), 1U);
  // One of them was first.
  EXPECT_NE(puma.console.replies[0] == "ok", puma.other.replies[0] == "ok");
  EXPECT_EQ(puma.console.told, puma.other.told);
  EXPECT_EQ(puma.mode(), Mode::kHolding);
  ASSERT_EQ(puma.ask(puma.console, "move q1_deg=80"), "ok");
  puma.run(0.1);
  EXPECT_TRUE(puma.ask(puma.other, "move q1_deg=-80").starts_with("error WRONG_MODE "));
  EXPECT_EQ(puma.ask(puma.other, "stop"), "ok");
  EXPECT_EQ(puma.mode(), Mode::kFaulted);
}

TEST(Consoles, one_that_floods_keeps_neither_the_arm_nor_the_other_waiting) {
  MovingPuma puma;
  for (int i = 0; i < 20'000; ++i) puma.console.requests.emplace_back("status");
  puma.run(0.02);
  EXPECT_EQ(puma.mode(), Mode::kServoing);
  puma.other.requests.emplace_back("stop");
  int ticks = 0;
  for (; ticks < 100 && puma.mode() != Mode::kFaulted; ++ticks) puma.cabinet->step();
  EXPECT_LE(ticks, 4);
  EXPECT_LE(ticks_until_safe(puma), 3);
  EXPECT_FALSE(puma.console.requests.empty());
}

TEST(Consoles, bytes_at_random_are_refused_and_move_nothing) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  const JointVector before = puma.now().commanded;
  std::mt19937 random(7);
  for (int i = 0; i < 3000; ++i) {
    std::string line(random() % 200, ' ');
    for (char& c : line) c = static_cast<char>(random());
    if (i % 3 == 0) line = "move " + line;
    puma.other.requests.push_back(line);
  }
  puma.run(7);
  EXPECT_EQ(puma.other.replies.size(), 3000U);
  for (const std::string& reply : puma.other.replies) {
    EXPECT_TRUE(reply.starts_with("error ")) << reply;
  }
  EXPECT_EQ(puma.mode(), Mode::kHolding);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(puma.now().commanded[i], before[i]);
}

// A cabinet with a candidate that beats the drawing.
struct Identified : PumaCabinet {
  Identified() : PumaCabinet(1, quick()) {
    EXPECT_TRUE(enable());
    EXPECT_EQ(ask("identify"), "ok");
    EXPECT_TRUE(run_until(Mode::kSweeping, 1));
    EXPECT_TRUE(run_until(Mode::kHolding, 3600));
  }
  static Configuration quick() {
    Configuration configuration = test::puma_controller();
    configuration.sweeps.points = configuration.sweeps.most_points = 8;
    configuration.sweeps.validation_poses = 3;
    return configuration;
  }
};

TEST(StoreFaults, a_full_disk_is_told_and_the_active_model_stays) {
  Identified puma;
  puma.memory.refusal = Error::kStorageFull;
  EXPECT_TRUE(puma.ask("accept").starts_with("error STORAGE_FULL "));
  EXPECT_EQ(puma.memory.stored, 0U);
  EXPECT_EQ(puma.ask("signature"), "ok model=nominal");
  EXPECT_EQ(puma.mode(), Mode::kHolding);
  puma.memory.refusal.reset();
  EXPECT_EQ(puma.ask("accept"), "ok") << "the candidate is still there";
  EXPECT_TRUE(puma.ask("signature").starts_with("ok model=signature signature=1 "));
}

TEST(StoreFaults, a_record_that_cannot_be_read_again_is_told_and_the_drawing_is_servoed_with) {
  Identified puma;
  ASSERT_EQ(puma.ask("accept"), "ok");
  const std::size_t model_before = puma.now().model;
  const std::size_t page_bytes = puma.memory.layout().page_bytes;
  std::string said;
  // Until one beats the first, of the same arm, on held-out poses.
  for (int attempt = 0; attempt < 6 && !said.starts_with("error STORAGE_FAULT "); ++attempt) {
    puma.memory.reads_left.reset();
    ASSERT_EQ(puma.ask("identify"), "ok");
    ASSERT_TRUE(puma.run_until(Mode::kSweeping, 1));
    ASSERT_TRUE(puma.run_until(Mode::kHolding, 3600));
    // Which verify what was written.
    puma.memory.reads_left = (kRecordBytes + page_bytes - 1) / page_bytes;
    said = puma.ask("accept");
  }
  EXPECT_TRUE(said.starts_with("error STORAGE_FAULT ")) << said;
  EXPECT_EQ(puma.ask("signature"), "ok model=nominal");
  EXPECT_NE(puma.now().model, model_before) << "the servo has taken over the nominal model";
  EXPECT_NE(puma.ask("status").find(" store=STORAGE_FAULT"), std::string::npos);
  // As it does after a restart, once the memory can be read.
  puma.memory.reads_left.reset();
  puma.start(Identified::quick(), 1);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  EXPECT_TRUE(puma.ask("signature").starts_with("ok model=signature signature=2 "));
}

TEST(StoreFaults, a_corrupted_record_is_told_and_the_drawing_or_the_former_one_is_used) {
  Identified puma;
  ASSERT_EQ(puma.ask("accept"), "ok");
  const auto once = puma.memory.bytes;
  puma.memory.bytes[test::RamMemory::kFirstRecord + 500] ^= 1;
  puma.start(Identified::quick(), 1);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  EXPECT_NE(puma.ask("status").find(" store=RECORD_CORRUPT"), std::string::npos);
  EXPECT_EQ(puma.ask("signature"), "ok model=nominal");

  // Twice accepted, the later one spoilt. Of two good signatures either may predict better.
  puma.memory.bytes = once;
  std::uint64_t seed = 2;
  for (bool accepted = false; !accepted; ++seed) {
    ASSERT_LT(seed, 20U);
    puma.start(Identified::quick(), seed);
    ASSERT_TRUE(puma.enable());
    ASSERT_EQ(puma.ask("identify"), "ok");
    ASSERT_TRUE(puma.run_until(Mode::kSweeping, 1));
    ASSERT_TRUE(puma.run_until(Mode::kHolding, 3600));
    accepted = puma.ask("accept") == "ok";
  }
  puma.memory.bytes[test::RamMemory::kSecondRecord + 500] ^= 1;
  puma.start(Identified::quick(), 2);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  EXPECT_TRUE(puma.ask("signature").starts_with("ok model=signature signature=1 "));
}

}  // namespace
}  // namespace armsig::controller
