// SPDX-License-Identifier: MIT
// The arm that calibrates itself, ended or paused on its way: it goes on where it was.
#include <algorithm>

#include <gtest/gtest.h>

#include "host_tests/support/ram_memory.hpp"
#include "host_tests/support/self_calibrating_puma.hpp"

namespace armsig::controller {
namespace {

TEST(SelfCalibration, ends_by_halt_and_begins_anew) {
  BentPuma puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify accuracy_mm=0.15 minutes=60"), "ok");
  refine_for(puma, 30);
  EXPECT_TRUE(puma.ask("status").contains(" sequence=identifying refining=yes "));
  const std::size_t measured = puma.cabinet->state().identification().log().size();
  EXPECT_EQ(puma.ask("halt"), "ok");
  EXPECT_TRUE(puma.run_until(Mode::kHolding));
  EXPECT_NE(puma.heard("# identify ended error=SEQUENCE_STOPPED"), "");
  EXPECT_TRUE(puma.ask("candidate").starts_with("error NO_CANDIDATE"));
  EXPECT_EQ(puma.cabinet->state().identification().log().size(), measured);
  EXPECT_EQ(puma.ask("identify accuracy_mm=0.15"), "ok");
  refine_for(puma, 5);
}

// What was measured is kept in a memory that outlives the controller.
class InterruptedSelfCalibration : public testing::Test {
 protected:
  // A controller that is started anew after 10 s of its poses.
  void interrupt() {
    PointJournal journal(kept);
    BentPuma puma(kBends, &journal);
    ASSERT_TRUE(puma.enable());
    ASSERT_EQ(puma.ask("identify accuracy_mm=0.15 minutes=60"), "ok");
    refine_for(puma, 10);
    measured = puma.cabinet->state().identification().points_done();
  }

  // Asked for again, with a memory that holds what the one before has measured.
  static void go_on(BentPuma& puma, std::size_t points) {
    ASSERT_TRUE(puma.enable());
    ASSERT_EQ(puma.ask("identify accuracy_mm=0.15 minutes=60"), "ok");
    expect_recalled(puma, points);
  }

  // The arm has not moved until all that had been measured is there again.
  static void expect_recalled(BentPuma& puma, std::size_t points) {
    const JointVector before = puma.now().commanded;
    const auto& sequence = puma.cabinet->state().identification();
    for (int i = 0; i < 20'000 && sequence.points_done() < points; ++i) puma.cabinet->step();
    EXPECT_EQ(sequence.points_done(), points);
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_EQ(puma.now().commanded[i], before[i]) << i;
    }
  }

  test::RamMemory kept{PointJournal::kLayout};
  std::size_t measured = 0;
};

TEST_F(InterruptedSelfCalibration, goes_on_after_a_restart_where_it_was) {
  ASSERT_NO_FATAL_FAILURE(interrupt());
  PointJournal journal(kept);
  BentPuma puma(kBends, &journal);
  ASSERT_NO_FATAL_FAILURE(go_on(puma, measured));
  EXPECT_EQ(value_after(puma.heard("# identify continues "), "kept_points"),
            static_cast<double>(measured));
  const auto& sequence = puma.cabinet->state().identification();
  ASSERT_EQ(sequence.stage(), IdentificationSequence::Stage::kRefining) << "without a sweep";
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 3600));
  const std::string told = puma.heard("# identify accuracy=");
  EXPECT_TRUE(told.starts_with("# identify accuracy=reached model=maps ")) << told;
  ASSERT_TRUE(sequence.has_verdict());
  EXPECT_LE(puma.miss_m(*sequence.candidate(), 40), 0.15e-3);
  // That one has come to its end: the next begins with a sweep.
  ASSERT_EQ(puma.ask("identify accuracy_mm=0.15 minutes=60"), "ok");
  puma.run(1);
  EXPECT_EQ(sequence.stage(), IdentificationSequence::Stage::kSweeping);
}

// What a point takes is learnt from those that were measured, not from those that were kept.
TEST_F(InterruptedSelfCalibration, tells_the_time_that_is_left_by_the_points_of_its_own) {
  ASSERT_NO_FATAL_FAILURE(interrupt());
  PointJournal journal(kept);
  BentPuma puma(kBends, &journal);
  ASSERT_NO_FATAL_FAILURE(go_on(puma, measured));
  const auto& sequence = puma.cabinet->state().identification();
  const auto point_takes_s = [&](std::size_t points_before) {
    const hal::Instant began = puma.now().now;
    for (int i = 0; i < 100'000 && sequence.points_done() < points_before + 6; ++i) {
      puma.cabinet->step();
    }
    EXPECT_EQ(sequence.points_done(), points_before + 6);
    return hal::seconds(puma.now().now - began) / 6;
  };
  const auto points_left = [&] {
    return static_cast<double>(sequence.points_planned() - sequence.points_done());
  };
  const double further_s = point_takes_s(measured);
  EXPECT_GT(sequence.left_s().value_or(0), 0.5 * further_s * points_left());
  EXPECT_LT(sequence.left_s().value_or(1e9), 2 * further_s * points_left());
  // The next run has kept none.
  ASSERT_EQ(puma.ask("halt"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kHolding));
  ASSERT_EQ(puma.ask("identify accuracy_mm=0.15 anew=yes"), "ok");
  const double first_s = point_takes_s(0);
  EXPECT_GT(sequence.left_s().value_or(0), 0.5 * first_s * points_left());
  EXPECT_LT(sequence.left_s().value_or(1e9), 2 * first_s * points_left());
}

TEST_F(InterruptedSelfCalibration, begins_anew_where_that_is_asked_for) {
  ASSERT_NO_FATAL_FAILURE(interrupt());
  PointJournal journal(kept);
  BentPuma puma(kBends, &journal);
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(puma.ask("identify accuracy_mm=0.15 anew=perhaps").starts_with("error OUT_OF_RANGE"));
  ASSERT_EQ(puma.ask("identify accuracy_mm=0.15 anew=yes"), "ok");
  puma.run(1);
  EXPECT_EQ(puma.heard("# identify continues "), "");
  EXPECT_EQ(puma.cabinet->state().identification().points_done(), 0U);
}

TEST_F(InterruptedSelfCalibration, is_not_continued_on_another_machine) {
  ASSERT_NO_FATAL_FAILURE(interrupt());
  PointJournal journal(kept);
  BentPuma puma(kBends, &journal);
  puma.world.first_serial = 2001;
  puma.power_up();
  ASSERT_TRUE(puma.enable());
  puma.confirm();
  ASSERT_EQ(puma.ask("identify accuracy_mm=0.15"), "ok");
  puma.run(1);
  EXPECT_TRUE(puma.heard("# identify begins anew ").contains("error=RECORD_OTHER_MACHINE"));
  EXPECT_EQ(puma.cabinet->state().identification().points_done(), 0U);
}

TEST_F(InterruptedSelfCalibration, goes_on_after_halt_and_says_where_it_cannot_be_kept) {
  PointJournal journal(kept);
  BentPuma puma(kBends, &journal);
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify accuracy_mm=0.15"), "ok");
  refine_for(puma, 10);
  ASSERT_EQ(puma.ask("halt"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kHolding));
  const std::size_t points = puma.cabinet->state().identification().log().size();
  ASSERT_EQ(puma.ask("identify accuracy_mm=0.15"), "ok");
  expect_recalled(puma, points);
  kept.refusal = Error::kStorageFull;
  puma.run(20);
  const auto said = [](const std::string& line) {
    return line.contains("can't be continued after a restart error=STORAGE_FULL");
  };
  EXPECT_EQ(std::ranges::count_if(puma.console.told, said), 1);
  EXPECT_GT(puma.cabinet->state().identification().points_done(), points + 2);
}

TEST(SelfCalibration, waits_for_its_sensor_and_goes_on_where_it_was) {
  BentPuma puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify accuracy_mm=0.15 minutes=60"), "ok");
  refine_for(puma, 10);
  puma.cabinet->sensor().set_error(Error::kSensorSilent);
  puma.run(10);
  EXPECT_NE(puma.heard("# identify paused error=SENSOR_SILENT"), "");
  const std::size_t before = puma.cabinet->state().identification().log().size();
  puma.cabinet->sensor().set_error({});
  puma.run(1);
  EXPECT_EQ(puma.ask("resume"), "ok");
  puma.run(10);
  EXPECT_GT(puma.cabinet->state().identification().log().size(), before + 2);
}

}  // namespace
}  // namespace armsig::controller
