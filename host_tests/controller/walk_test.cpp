// SPDX-License-Identifier: MIT
// A random walk: operators type what comes into their heads, drives and sensor fail, power goes.
// After every tick an oracle that knows no rule of the controller's judges what the drives were
// told and did. 100,000 ticks; ARMSIG_WALK_TICKS and ARMSIG_WALK_SEED make it longer and another
// one (docs/trust.md).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "host_tests/support/table_3_run.hpp"

namespace armsig::controller {
namespace {

using simulated::DriveFault;
using test::PumaCabinet;

constexpr double kTick_s = 0.002;
constexpr unsigned kTicksOfStop = 2;

unsigned long number_of(const char* name, unsigned long otherwise) {
  const char* told = std::getenv(name);
  return told == nullptr ? otherwise : std::strtoul(told, nullptr, 10);
}

// Of the switch of joint 6, in counts; where the drive counts as before once it has homed.
constexpr std::int32_t kSwitch = 5000;
constexpr std::array<simulated::ObjectEdit, 3> kHomingObjects{{
    {{0x607C, 0, 4, simulated::Access::kReadWrite, kSwitch}},
    {{0x6098, 0, 1, simulated::Access::kReadWrite, 17}},
    {{0x6099, 1, 4, simulated::Access::kReadWrite, 40'000}},
}};

simulated::DriveConfiguration homing_drive() {
  simulated::DriveConfiguration drive = test::honest_puma_drive();
  drive.home_switch = kSwitch;
  drive.edits = kHomingObjects;
  return drive;
}

Configuration with_homed_joint_6() {
  Configuration configuration = test::quick_puma_with_grid();
  configuration.references = FixedVector<Reference, kMaxJoints>(6, Reference::kAbsolute);
  configuration.references[5] = Reference::kHomed;
  return configuration;
}

bool moves(Mode mode) {
  return mode == Mode::kHolding || mode == Mode::kServoing || mode == Mode::kSweeping;
}

class Walk {
 public:
  explicit Walk(unsigned long seed) : random_(seed) {}

  // Until `ticks` have been judged, or something is not as it must be.
  void take(unsigned long ticks) {
    while (ticks_ < ticks && !testing::Test::HasFailure()) {
      const unsigned what = draw(100);
      if (what < 70) {
        request(words());
      } else if (what < 76) {
        disturb();
      } else if (what < 78) {
        restart();
      } else {
        recover();
      }
      run(draw(what % 7 == 0 ? 4000 : 150));
    }
  }

  [[nodiscard]] unsigned long ticks() const { return ticks_; }
  [[nodiscard]] unsigned typed() const { return typed_; }
  [[nodiscard]] unsigned stops() const { return stops_; }
  [[nodiscard]] unsigned restarts() const { return restarts_; }
  [[nodiscard]] const auto& seen() const { return seen_; }

 private:
  struct Motion {
    JointVector commanded;
    std::array<double, 6> speed{};
    bool has_speed = false;
  };

  unsigned draw(unsigned count) { return static_cast<unsigned>(random_() % count); }
  double between(double lower, double upper) {
    return lower + (upper - lower) * static_cast<double>(random_() % 100'001) / 100'000;
  }

  std::string words() {
    static constexpr std::array kWords{"status",
                                       "enable",
                                       "disable",
                                       "reset",
                                       "halt",
                                       "stop",
                                       "identify",
                                       "check",
                                       "pause",
                                       "resume",
                                       "compare",
                                       "candidate",
                                       "accept",
                                       "rollback",
                                       "signature",
                                       "acknowledge",
                                       "confirm q1_deg=10",
                                       "touch-grid",
                                       "log",
                                       "log row=1",
                                       "help",
                                       "help move",
                                       "fetch what=signature part=1",
                                       "fetch what=nominal part=2",
                                       "send part=1 bytes=3956 hex=00",
                                       "move",
                                       "move q9_deg=1",
                                       "move q1_deg=nan",
                                       "move x_mm=1e300",
                                       "enable enable",
                                       "",
                                       "\t",
                                       "# mode idle"};
    const unsigned kind = draw(12);
    if (kind < 3) {
      return "move q" + std::to_string(1 + draw(6)) + "_deg=" + std::to_string(between(-260, 260));
    }
    if (kind == 3) {
      static constexpr std::array kAlong{"dx", "dy", "dz"};
      return std::string("move ") + kAlong[draw(3)] + "_mm=" + std::to_string(between(-200, 200)) +
             (draw(2) == 0 ? " pace=0.3" : "");
    }
    if (kind == 4) return "enable";
    if (kind == 5) return draw(2) == 0 ? "reset" : "halt";
    if (kind == 6 && draw(2) == 0) return "stop";
    if (kind == 8 && draw(2) == 0) return "home joint=6";
    if (kind == 7) return draw(2) == 0 ? "identify" : "touch-grid";
    return kWords[draw(kWords.size())];
  }

  // Its reply must come within a second, and the effect of `stop` within two ticks.
  void request(const std::string& request) {
    test::LineConsole& from = draw(3) == 0 ? puma_.other : puma_.console;
    from.replies.clear();
    from.told.clear();
    from.requests.push_back(request);
    ++typed_;
    if (request == "enable") idle_ticks_ = 0;
    const bool stop = request == "stop";
    const bool had_torque = kWithTorque.contains(mode());
    for (unsigned i = 0; i < 500 && from.replies.empty(); ++i) {
      tick();
      if (stop && had_torque && i + 1 >= kTicksOfStop) {
        EXPECT_EQ(mode(), Mode::kFaulted) << "\"stop\" at tick " << ticks_;
      }
    }
    stops_ += stop && had_torque ? 1 : 0;
    ASSERT_EQ(from.replies.size(), 1U) << '"' << request << "\" at tick " << ticks_;
    const std::string& reply = from.replies[0];
    EXPECT_TRUE(reply == "ok" || reply.starts_with("ok ") || reply.starts_with("error "))
        << request << ": " << reply;
  }

  void disturb() {
    constexpr std::array kFaults{
        DriveFault::kEmergency,      DriveFault::kSilent,     DriveFault::kHeartbeatLost,
        DriveFault::kFeedbackLost,   DriveFault::kBlocked,    DriveFault::kPowerRemoved,
        DriveFault::kReboot,         DriveFault::kDeaf,       DriveFault::kPositionJump,
        DriveFault::kPreOperational, DriveFault::kSdoSilent,  DriveFault::kSyncLost,
        DriveFault::kIgnoresTargets, DriveFault::kInformation};
    disturbed_ = true;
    const unsigned which = draw(kFaults.size() + 3);
    if (which < kFaults.size()) {
      puma_.cabinet->drive(draw(6)).inject(kFaults[which], 0x2310);
    } else if (which == kFaults.size()) {
      puma_.cabinet->sensor().set_error(Error::kSensorBadCrc);
    } else if (which == kFaults.size() + 1) {
      puma_.memory.refusal = Error::kStorageFull;
    } else {
      puma_.cabinet->master_port().go_bus_off();
    }
  }

  void recover() {
    for (std::size_t joint = 0; joint < 6; ++joint) {
      puma_.cabinet->drive(joint).inject(DriveFault::kNone);
    }
    puma_.cabinet->sensor().set_error({});
    puma_.memory.refusal.reset();
    if (disturbed_) set_up_anew();
    if (draw(4) == 0) return;
    puma_.confirm();
    request("enable");
    run(200);
  }

  void set_up_anew() {
    // Judged again once the drives were set up anew without a disturbance.
    for (const char* request : {"reset", "disable"}) (void)puma_.ask(request);
    disturbed_ = !puma_.run_until(Mode::kIdle, 10);
    former_.reset();
  }

  void restart() {
    ++restarts_;
    recover();
    puma_.start(configuration_, random_());
    former_.reset();
    (void)puma_.run_until(Mode::kIdle, 10);
    disturbed_ = mode() != Mode::kIdle;
  }

  void run(unsigned ticks) {
    for (unsigned i = 0; i < ticks && !testing::Test::HasFailure(); ++i) tick();
  }

  [[nodiscard]] Mode mode() const { return puma_.now().mode; }

  void tick() {
    puma_.cabinet->step();
    ++ticks_;
    const Snapshot& now = puma_.now();
    ++seen_[static_cast<std::size_t>(now.mode)];
    judge_torque(now);
    judge_motion(now);
  }

  // Without a disturbance no drive has torque in idle, but while it is being enabled.
  void judge_torque(const Snapshot& now) {
    idle_ticks_ = now.mode == Mode::kIdle ? idle_ticks_ + 1 : 0;
    if (disturbed_ || idle_ticks_ < 1000) return;
    for (std::size_t joint = 0; joint < 6; ++joint) {
      EXPECT_FALSE(puma_.cabinet->drive(joint).has_torque())
          << "joint " << joint + 1 << " at tick " << ticks_;
    }
  }

  // What is commanded stays within the limits of readings, speed and acceleration, to the
  // rounding of doubles. A joint that has fallen beyond a limit before it got torque may be
  // there, and goes no further.
  void judge_motion(const Snapshot& now) {
    if (!moves(now.mode) || now.commanded.size() != 6) {
      former_.reset();
      return;
    }
    Motion motion{now.commanded, {}, former_.has_value()};
    if (!former_) taken_at_ = now.commanded;
    for (std::size_t i = 0; i < 6; ++i) judge_joint(i, motion);
    former_ = motion;
  }

  void judge_joint(std::size_t i, Motion& motion) const {
    constexpr double kRounding = 1e-9;
    const JointLimits& limits = configuration_.drawing.limits[i];
    const double at = motion.commanded[i];
    EXPECT_GE(at, std::min(limits.lower, taken_at_[i]) - kRounding) << where(i);
    EXPECT_LE(at, std::max(limits.upper, taken_at_[i]) + kRounding) << where(i);
    if (!former_) return;
    motion.speed[i] = (at - former_->commanded[i]) / kTick_s;
    EXPECT_LE(std::abs(motion.speed[i]), configuration_.limits.speed[i] * (1 + kRounding))
        << where(i);
    if (!former_->has_speed) return;
    const double acceleration = std::abs(motion.speed[i] - former_->speed[i]) / kTick_s;
    EXPECT_LE(acceleration, configuration_.limits.acceleration[i] * (1 + 1e-6)) << where(i);
  }

  [[nodiscard]] std::string where(std::size_t joint) const {
    return "joint " + std::to_string(joint + 1) + " at tick " + std::to_string(ticks_);
  }

  Configuration configuration_ = with_homed_joint_6();
  PumaCabinet puma_{1, configuration_, homing_drive()};
  std::mt19937_64 random_;
  std::optional<Motion> former_;
  JointVector taken_at_;  // commanded at the first tick with torque
  bool disturbed_ = false;
  unsigned idle_ticks_ = 0;
  unsigned long ticks_ = 0;
  unsigned typed_ = 0;
  unsigned stops_ = 0;
  unsigned restarts_ = 0;
  std::array<unsigned, kAllModes.size()> seen_{};
};

TEST(Walk, of_requests_faults_and_restarts_never_leaves_torque_limits_or_a_request_unanswered) {
  const unsigned long seed = number_of("ARMSIG_WALK_SEED", 1);
  const unsigned long ticks = number_of("ARMSIG_WALK_TICKS", 100'000);
  SCOPED_TRACE("ARMSIG_WALK_SEED=" + std::to_string(seed));
  Walk walk(seed);
  walk.take(ticks);
  std::printf(
      "seed %lu: %lu ticks, %u requests, %u stops of a moving or holding arm, %u restarts\n", seed,
      walk.ticks(), walk.typed(), walk.stops(), walk.restarts());
  EXPECT_GT(walk.stops(), 0U);
  EXPECT_GT(walk.restarts(), 0U);
  for (const unsigned ticks_of_mode : walk.seen()) EXPECT_GT(ticks_of_mode, 0U);
}

}  // namespace
}  // namespace armsig::controller
