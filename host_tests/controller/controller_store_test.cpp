// SPDX-License-Identifier: MIT
// The store of signatures: records of the arm, whatever is done to them. How it survives a loss of
// power is in store_power_test.cpp.
#include <gtest/gtest.h>

#include "core/identification.hpp"
#include "firmware/controller/signature_store.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/ram_memory.hpp"

namespace armsig::controller {
namespace {

using test::RamMemory;

SignatureRecord record_of(int robot) {
  const KnownTarget target{1, 6, Vector3(0.1, 0.2, 0.3)};
  SignatureRecord record;
  record.signature = signature_of(tool::table2_robot(robot), JointVector{0, -1, 1, 0.5, 0.2, 0},
                                  Pose{rotation_x(0.3), Vector3(1, 2, 3)}, {&target, 1});
  record.air_celsius = 21.5;
  return record;
}

Result<bool> finish(SignatureStore& store) {
  Result<bool> done = false;
  while (done && !*done) done = store.step();
  return done;
}

Result<bool> write(SignatureStore& store, const SignatureRecord& record) {
  store.begin_write(record);
  return finish(store);
}

Result<bool> roll_back(SignatureStore& store) {
  if (auto begun = store.begin_rollback(); !begun) return std::unexpected(begun.error());
  return finish(store);
}

// The robot whose signature is active; 0: none.
int active_in(RamMemory& memory) {
  SignatureStore store(memory);
  SignatureRecord found;
  if (!store.load(tool::puma560(), found)) return 0;
  for (const int robot : {1, 2}) {
    SignatureRecord expected = record_of(robot);
    expected.sequence = found.sequence;
    if (encode(expected) == encode(found)) return robot;
  }
  return -1;
}

TEST(SignatureStore, is_empty_at_first) {
  RamMemory memory;
  SignatureStore store(memory);
  SignatureRecord record;
  const auto loaded = store.load(tool::puma560(), record);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(test::failure_of(loaded), Error::kNoSignature);
  EXPECT_EQ(memory.changed, 0U) << "nothing is written before there is something to store";
}

TEST(SignatureStore, keeps_the_last_written_and_the_one_before) {
  RamMemory memory;
  SignatureStore store(memory);
  SignatureRecord record;
  (void)store.load(tool::puma560(), record);
  ASSERT_TRUE(write(store, record_of(1)));
  EXPECT_EQ(active_in(memory), 1);
  ASSERT_TRUE(write(store, record_of(2)));
  EXPECT_EQ(active_in(memory), 2);
  ASSERT_TRUE(roll_back(store));
  EXPECT_EQ(active_in(memory), 1);
  ASSERT_TRUE(roll_back(store));
  EXPECT_EQ(active_in(memory), 0) << "before the first there was the drawing";
  const auto again = store.begin_rollback();
  ASSERT_FALSE(again);
  EXPECT_EQ(test::failure_of(again), Error::kNoSignature);
}

TEST(SignatureStore, refuses_a_record_of_another_arm) {
  RamMemory memory;
  SignatureStore store(memory);
  SignatureRecord record;
  (void)store.load(tool::puma560(), record);
  ASSERT_TRUE(write(store, record_of(1)));
  Arm other = tool::puma560();
  other.joints[2].type = JointType::kPrismatic;
  const auto loaded = store.load(other, record);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(test::failure_of(loaded), Error::kRecordUnsuitable);
}

TEST(SignatureStore, never_takes_a_record_with_one_wrong_byte) {
  RamMemory memory;
  SignatureStore store(memory);
  SignatureRecord record;
  (void)store.load(tool::puma560(), record);
  ASSERT_TRUE(write(store, record_of(1)));
  for (std::size_t i = 0; i < kRecordBytes; ++i) {
    memory.bytes[RamMemory::kFirstRecord + i] ^= 0x10;
    EXPECT_EQ(active_in(memory), 0) << i;
    memory.bytes[RamMemory::kFirstRecord + i] ^= 0x10;
  }
  EXPECT_EQ(active_in(memory), 1);
}

// On a card each bank has an erase block of its own (firmware/linux/daemon.hpp).
TEST(SignatureStore, has_banks_of_two_sectors_and_leaves_one_for_the_positions) {
  RamMemory memory;
  EXPECT_EQ(RecordStore(memory).sectors(), 6U);
  EXPECT_TRUE(RecordStore(memory).fits());
}

TEST(SignatureStore, keeps_all_of_a_record) {
  RamMemory memory;
  SignatureStore store(memory);
  SignatureRecord record = record_of(1);
  record.held_out_rms_m = 1.5e-4;
  record.identified_at_s = 1'763'800'000;
  record.predicted_sigma_m = 7e-5;
  record.machine.drawing_crc = 0x1234'5678;
  for (std::uint32_t i = 0; i < 6; ++i) {
    record.machine.drives.push_back({.device = {1, 2, 3, 1000 + i},
                                     .counts_per_revolution = 4000,
                                     .gear_ratio = 100.5,
                                     .lead_m = 0.01,
                                     .zero_counts = -77,
                                     .reversed = i % 2 == 1});
  }
  SignatureRecord found;
  (void)store.load(tool::puma560(), found);
  ASSERT_TRUE(write(store, record));
  ASSERT_TRUE(store.load(tool::puma560(), found));
  EXPECT_EQ(found.sequence, 1U);
  EXPECT_EQ(found.air_celsius, 21.5);
  EXPECT_EQ(found.held_out_rms_m, 1.5e-4);
  EXPECT_EQ(found.identified_at_s, 1'763'800'000);
  EXPECT_EQ(found.predicted_sigma_m, 7e-5);
  EXPECT_FALSE(difference(record.machine, found.machine));
  EXPECT_EQ(found.machine.drives[5], record.machine.drives[5]);
}

}  // namespace
}  // namespace armsig::controller
