// SPDX-License-Identifier: MIT
// What a self-calibration keeps across restarts.
#include "firmware/self_calibration/point_journal.hpp"

#include <gtest/gtest.h>

#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

constexpr hal::MemoryLayout kSmall{.page_bytes = 256, .pages_per_sector = 4, .sectors = 4};

Machine machine_of_serial(std::uint32_t serial) {
  Machine machine{.drives = {}, .drawing_crc = 7};
  machine.drives.push_back({.device = {1, 2, 3, serial}, .gear_ratio = 100});
  return machine;
}

// Point `number` of a run; every fourth pose gives none.
KeptPoint point_number(int number) {
  KeptPoint kept{.sweep = number < 5 ? 2U : 0U,
                 .wanted = JointVector(6, 0.1 * number),
                 .readings = JointVector(6, 0.1 * number + 1e-5)};
  if (number % 4 == 3) return kept;
  kept.point = MeasuredPoint{.p_S = Vector3(number, 0.5, -0.25), .pings = 5};
  kept.point->covariance_m2 << 3, 1, 0.5, 1, 4, 0.25, 0.5, 0.25, 5;
  return kept;
}

struct KeptRun {
  explicit KeptRun(test::RamMemory& memory) : journal(memory) {}

  [[nodiscard]] Result<std::size_t> begin(std::uint32_t serial = 1, bool anew = false) {
    return journal.begin(configuration, machine_of_serial(serial), anew);
  }
  void keep(int first, int last) {
    for (int n = first; n < last; ++n) ASSERT_TRUE(journal.keep(point_number(n))) << n;
  }
  // How many points it has of those from `first` on.
  int recalled(int first = 0) {
    for (int n = first;; ++n) {
      const KeptPoint expected = point_number(n);
      const auto kept = journal.next(expected.sweep, expected.wanted);
      if (!kept) return n - first;
      EXPECT_EQ(kept->readings[5], expected.readings[5]);
      EXPECT_EQ(kept->point.has_value(), expected.point.has_value());
      if (!kept->point || !expected.point) continue;
      EXPECT_EQ(kept->point->p_S, expected.point->p_S);
      EXPECT_EQ(kept->point->covariance_m2, expected.point->covariance_m2);
      EXPECT_EQ(kept->point->pings, 5U);
    }
  }

  Configuration configuration = test::puma_controller();
  PointJournal journal;
};

class PointJournalTest : public testing::Test {
 protected:
  // A run that was interrupted after `points`.
  void interrupted_after(int points) {
    KeptRun run(memory);
    ASSERT_EQ(run.begin().value_or(99), 0U);
    ASSERT_EQ(run.recalled(), 0);
    run.keep(0, points);
  }

  test::RamMemory memory{kSmall};
};

TEST_F(PointJournalTest, gives_back_to_the_bit_what_was_kept_and_goes_on) {
  interrupted_after(7);
  {
    KeptRun run(memory);
    ASSERT_EQ(run.begin().value_or(99), 7U);
    ASSERT_EQ(run.recalled(), 7);
    run.keep(7, 10);
  }
  KeptRun run(memory);
  ASSERT_EQ(run.begin().value_or(99), 10U);
  EXPECT_EQ(run.recalled(), 10);
}

TEST_F(PointJournalTest, forgets_what_has_come_to_its_end_and_what_is_not_wanted) {
  interrupted_after(7);
  KeptRun run(memory);
  EXPECT_EQ(run.begin(1, true).value_or(99), 0U);
  EXPECT_EQ(run.recalled(), 0);
  run.keep(0, 6);
  ASSERT_TRUE(run.journal.forget());
  EXPECT_EQ(run.begin().value_or(99), 0U);
  EXPECT_EQ(run.recalled(), 0);
}

TEST_F(PointJournalTest, takes_nothing_of_a_longer_run_before) {
  interrupted_after(14);
  {
    KeptRun run(memory);
    ASSERT_EQ(run.begin(1, true).value_or(99), 0U);
    run.keep(0, 3);  // the first sector is full: the next page would be the old run's
  }
  KeptRun run(memory);
  EXPECT_EQ(run.begin().value_or(99), 3U);
  EXPECT_EQ(run.recalled(), 3);
  run.keep(3, 5);
}

TEST_F(PointJournalTest, refuses_by_name_what_is_of_another_machine_or_configuration) {
  interrupted_after(3);
  KeptRun other(memory);
  EXPECT_EQ(test::failure_of(other.begin(2)), Error::kRecordOtherMachine);
  EXPECT_EQ(other.recalled(), 0);
  other.keep(0, 2);
  KeptRun changed(memory);
  changed.configuration.drawing.limits[3].upper -= 0.1;
  EXPECT_EQ(test::failure_of(changed.begin(2)), Error::kRecordUnsuitable);
  EXPECT_EQ(changed.recalled(), 0);
  KeptRun again(memory);
  again.configuration = changed.configuration;
  EXPECT_EQ(again.begin(2).value_or(99), 0U) << "it began anew";
}

// Another offset or register: what was measured before is another point.
TEST_F(PointJournalTest, refuses_by_name_what_an_instrument_with_other_settings_told) {
  interrupted_after(3);
  KeptRun changed(memory);
  changed.configuration.sensor.settings_crc = 1;
  EXPECT_EQ(test::failure_of(changed.begin()), Error::kRecordUnsuitable);
  EXPECT_EQ(changed.recalled(), 0);
}

TEST_F(PointJournalTest, refuses_a_foreign_header_by_name_and_begins_anew) {
  interrupted_after(3);
  memory.bytes[9] ^= 1;
  {
    KeptRun run(memory);
    EXPECT_EQ(test::failure_of(run.begin()), Error::kRecordCorrupt);
    EXPECT_EQ(run.recalled(), 0);
    run.keep(0, 2);
  }
  KeptRun run(memory);
  EXPECT_EQ(run.begin().value_or(99), 2U);
  EXPECT_EQ(run.recalled(), 2);
}

TEST_F(PointJournalTest, goes_on_behind_a_page_at_every_byte_of_which_the_power_went) {
  for (std::size_t bytes = 0; bytes <= 256; ++bytes) {
    memory = test::RamMemory(kSmall);
    interrupted_after(4);
    {
      KeptRun run(memory);
      ASSERT_EQ(run.begin().value_or(99), 4U);
      ASSERT_EQ(run.recalled(), 4);
      memory.bytes_left = bytes;
      EXPECT_EQ(run.journal.keep(point_number(4)).has_value(), bytes == 256);
      EXPECT_TRUE(bytes == 256 || run.journal.keep(point_number(5))) << "it has given up";
      memory.bytes_left.reset();
    }
    // What is left is 0xFF as erased in the last bytes of a page.
    const int kept = bytes < 212 ? 4 : 5;
    {
      KeptRun run(memory);
      ASSERT_EQ(run.begin().value_or(99), static_cast<std::size_t>(kept)) << bytes;
      ASSERT_EQ(run.recalled(), kept);
      run.keep(kept, 8);
    }
    KeptRun run(memory);
    ASSERT_EQ(run.begin().value_or(99), 8U) << bytes;
    ASSERT_EQ(run.recalled(), 8);
  }
}

TEST_F(PointJournalTest, takes_what_is_common_with_a_run_that_goes_another_way) {
  interrupted_after(9);
  {
    KeptRun run(memory);
    ASSERT_EQ(run.begin().value_or(99), 9U);
    for (int n = 0; n < 3; ++n) {
      ASSERT_TRUE(run.journal.next(point_number(n).sweep, point_number(n).wanted));
    }
    EXPECT_FALSE(run.journal.next(2, JointVector(6, 0.3 + 1e-6))) << "not the same pose";
    run.keep(20, 24);
  }
  KeptRun run(memory);
  ASSERT_TRUE(run.begin());
  for (const int n : {0, 1, 2, 20, 21, 22, 23}) {
    EXPECT_TRUE(run.journal.next(point_number(n).sweep, point_number(n).wanted)) << n;
  }
}

TEST_F(PointJournalTest, says_once_that_it_is_full) {
  KeptRun run(memory);
  ASSERT_EQ(run.begin().value_or(99), 0U);
  run.keep(0, 15);
  EXPECT_EQ(test::failure_of(run.journal.keep(point_number(15))), Error::kStorageFull);
  EXPECT_TRUE(run.journal.keep(point_number(16)));
  KeptRun later(memory);
  EXPECT_EQ(later.begin().value_or(99), 15U);
  EXPECT_EQ(later.recalled(), 15);
}

}  // namespace
}  // namespace armsig::controller
