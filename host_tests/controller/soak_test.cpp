// SPDX-License-Identifier: MIT
// Identify, accept, roll back, touch the grid, restart, with faults drawn at random, over drives as
// they are: at the end memory, descriptors and time a tick are as at the start, and in use is what
// was committed last. Ten virtual minutes; ARMSIG_SOAK_HOURS=24 makes it a day (docs/bench.md).
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "host_tests/support/table_3_run.hpp"

namespace armsig::controller {
namespace {

using simulated::DriveFault;
using test::PumaCabinet;

double hours() {
  const char* told = std::getenv("ARMSIG_SOAK_HOURS");
  return told == nullptr ? 1.0 / 6 : std::strtod(told, nullptr);
}

struct Load {
  double resident_MB = 0;
  std::ptrdiff_t descriptors = 0;
  double cpu_us_a_tick = 0;  // at rest, under torque
};

class Soak {
 public:
  Soak() { EXPECT_TRUE(check(configuration_)); }

  // Brings the arm to holding, whatever has happened; false if it does not come.
  bool recover() {
    for (std::size_t joint = 0; joint < 6; ++joint) {
      puma_.cabinet->drive(joint).inject(DriveFault::kNone);
    }
    puma_.cabinet->sensor().set_error({});
    puma_.memory.refusal.reset();
    for (int attempt = 0; attempt < 8; ++attempt) {
      if (puma_.mode() == Mode::kSweeping) (void)puma_.ask("halt");
      if (puma_.run_until(Mode::kHolding, 1)) {
        puma_.confirm();
        return true;
      }
      if (puma_.mode() != Mode::kIdle) (void)puma_.ask("reset");
      if (!puma_.run_until(Mode::kIdle, 10)) continue;
      (void)puma_.ask("enable");
      (void)puma_.run_until(Mode::kHolding, 3);
    }
    return puma_.mode() == Mode::kHolding;
  }

  // One thing that an operator or the world does.
  void step() {
    puma_.console.told.clear();
    puma_.console.replies.clear();
    puma_.other.told.clear();
    puma_.other.replies.clear();
    switch (draw(6)) {
      case 0:
        sequence("identify", 400);
        break;
      case 1:
        sequence("touch-grid", 120);
        break;
      case 2:
        accept();
        break;
      case 3:
        roll_back();
        break;
      case 4:
        restart();
        break;
      default:
        (void)puma_.ask("move q1_deg=" + std::to_string(static_cast<int>(draw(120)) - 60));
        disturb(2);
        break;
    }
    EXPECT_TRUE(recover()) << "after " << virtual_s() << " s";
    expect_committed();
  }

  [[nodiscard]] double virtual_s() const {
    return before_s_ + hal::seconds(puma_.now().now.time_since_epoch());
  }
  [[nodiscard]] Load load() {
    Load load;
    constexpr int kTicks = 20'000;
    const std::clock_t began = std::clock();
    for (int i = 0; i < kTicks; ++i) puma_.cabinet->step();
    load.cpu_us_a_tick = 1e6 * static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC / kTicks;
    std::ifstream statm("/proc/self/statm");
    double pages = 0;
    statm >> pages >> pages;
    load.resident_MB = pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
    const std::filesystem::directory_iterator open("/proc/self/fd");
    load.descriptors = std::distance(begin(open), end(open));
    return load;
  }

  struct Counts {
    unsigned identified = 0;
    unsigned accepted = 0;
    unsigned rolled_back = 0;
    unsigned faults = 0;
    unsigned restarts = 0;
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  using Image = std::optional<std::vector<std::uint8_t>>;

  unsigned draw(unsigned count) { return static_cast<unsigned>(random_() % count); }

  [[nodiscard]] Image active() const {
    const auto& record = puma_.cabinet->state().active();
    if (!record) return std::nullopt;
    const auto image = encode(*record);
    return std::vector<std::uint8_t>(image.begin(), image.end());
  }
  void expect_committed() const {
    EXPECT_TRUE(active() == committed_) << "after " << virtual_s() << " s";
  }

  // Up to `most_s` seconds, in which a third of the time something goes wrong.
  void sequence(const char* verb, double most_s) {
    if (puma_.ask(verb) != "ok") return;
    puma_.run_until(Mode::kSweeping, 1);
    if (draw(3) == 0) {
      puma_.run(0.1 * draw(600));
      disturb(5);
    }
    const bool through = puma_.run_until(Mode::kHolding, most_s);
    counts_.identified += through && verb == std::string("identify") ? 1 : 0;
  }
  void disturb(double seconds) {
    constexpr std::array kFaults{
        DriveFault::kEmergency,    DriveFault::kSilent,        DriveFault::kHeartbeatLost,
        DriveFault::kFeedbackLost, DriveFault::kBlocked,       DriveFault::kPowerRemoved,
        DriveFault::kReboot,       DriveFault::kDeaf,          DriveFault::kPreOperational,
        DriveFault::kSyncLost,     DriveFault::kIgnoresTargets};
    ++counts_.faults;
    const unsigned which = draw(kFaults.size() + 3);
    if (which < kFaults.size()) {
      puma_.cabinet->drive(draw(6)).inject(kFaults[which], 0x2310);
    } else if (which == kFaults.size()) {
      puma_.cabinet->sensor().set_error(Error::kSensorBadCrc);
    } else if (which == kFaults.size() + 1) {
      (void)puma_.ask(puma_.other, "stop");
    } else {
      puma_.cabinet->master_port().go_bus_off();
    }
    puma_.run(seconds * (1 + draw(4)) / 4);
    (void)recover();
  }
  void accept() {
    if (draw(4) == 0) puma_.memory.refusal = Error::kStorageFull;
    if (puma_.ask("accept") != "ok") return;
    ++counts_.accepted;
    former_ = committed_;
    committed_ = active();
    EXPECT_TRUE(committed_);
  }
  void roll_back() {
    if (puma_.ask("rollback") != "ok") return;
    ++counts_.rolled_back;
    committed_ = former_;
    former_.reset();
  }
  // Power off and on.
  void restart() {
    ++counts_.restarts;
    before_s_ = virtual_s();
    puma_.start(configuration_, random_());
  }

  Configuration configuration_ = test::quick_puma_with_grid();
  PumaCabinet puma_{1, configuration_, test::honest_puma_drive()};
  std::mt19937 random_{17};
  double before_s_ = 0;
  Image committed_;
  Image former_;
  Counts counts_;
};

TEST(Soak, ends_as_it_began) {
  Soak soak;
  ASSERT_TRUE(soak.recover());
  for (int i = 0; i < 5; ++i) soak.step();
  const Load first = soak.load();
  while (soak.virtual_s() < 3600 * hours() && !testing::Test::HasFailure()) soak.step();
  const Load last = soak.load();
  const Soak::Counts& counts = soak.counts();
  std::printf(
      "%.2f virtual hours: %u identified, %u accepted, %u rolled back, %u faults, %u "
      "restarts\n",
      soak.virtual_s() / 3600, counts.identified, counts.accepted, counts.rolled_back,
      counts.faults, counts.restarts);
  for (const Load& load : {first, last}) {
    std::printf("%.2f MB, %td descriptors, %.2f us a tick\n", load.resident_MB, load.descriptors,
                load.cpu_us_a_tick);
  }
  EXPECT_GT(counts.identified, 0U);
  EXPECT_EQ(last.descriptors, first.descriptors);
  EXPECT_LT(last.resident_MB, first.resident_MB + 2);
  EXPECT_LT(last.cpu_us_a_tick, 3 * first.cpu_us_a_tick);
}

}  // namespace
}  // namespace armsig::controller
