// SPDX-License-Identifier: MIT
// The two-slot store: what it keeps whenever the power goes.
#include <gtest/gtest.h>

#include "core/identification.hpp"
#include "firmware/controller/signature_store.hpp"
#include "firmware/host_tool/paper_arms.hpp"
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

Result<bool> write(SignatureStore& store, const SignatureRecord& record) {
  store.begin_write(record);
  Result<bool> done = false;
  while (done && !*done) done = store.step_write();
  return done;
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
  EXPECT_EQ(store.load(tool::puma560(), record).error(), Error::kNoSignature);
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
  ASSERT_TRUE(store.revoke());
  EXPECT_EQ(active_in(memory), 1);
}

TEST(SignatureStore, refuses_a_record_of_another_arm) {
  RamMemory memory;
  SignatureStore store(memory);
  SignatureRecord record;
  (void)store.load(tool::puma560(), record);
  ASSERT_TRUE(write(store, record_of(1)));
  Arm other = tool::puma560();
  other.joints[2].type = JointType::kPrismatic;
  EXPECT_EQ(store.load(other, record).error(), Error::kRecordUnsuitable);
}

TEST(SignatureStore, never_takes_a_record_with_one_wrong_byte) {
  RamMemory memory;
  SignatureStore store(memory);
  SignatureRecord record;
  (void)store.load(tool::puma560(), record);
  ASSERT_TRUE(write(store, record_of(1)));
  for (std::size_t i = 0; i < kRecordBytes; ++i) {
    memory.bytes[i] ^= 0x10;
    EXPECT_EQ(active_in(memory), 0) << i;
    memory.bytes[i] ^= 0x10;
  }
  EXPECT_EQ(active_in(memory), 1);
}

TEST(SignatureStore, has_the_former_or_the_new_record_wherever_the_power_goes) {
  std::size_t samples = 0;
  for (std::size_t cut = 0; cut < 5400; cut += 13, ++samples) {
    RamMemory memory;
    SignatureStore store(memory);
    SignatureRecord record;
    (void)store.load(tool::puma560(), record);
    ASSERT_TRUE(write(store, record_of(1)));
    memory.bytes_left = cut;
    const auto written = write(store, record_of(2));
    memory.bytes_left.reset();
    const int active = active_in(memory);
    ASSERT_TRUE(active == 1 || active == 2) << cut;
    if (written && *written) {
      EXPECT_EQ(active, 2) << cut;
    }
  }
  EXPECT_GE(samples, 200U);
}

TEST(SignatureStore, has_one_of_both_wherever_the_power_goes_in_a_rollback) {
  for (std::size_t cut = 0; cut < 256; ++cut) {
    RamMemory memory;
    SignatureStore store(memory);
    SignatureRecord record;
    (void)store.load(tool::puma560(), record);
    ASSERT_TRUE(write(store, record_of(1)));
    ASSERT_TRUE(write(store, record_of(2)));
    memory.bytes_left = cut;
    (void)store.revoke();
    memory.bytes_left.reset();
    EXPECT_EQ(active_in(memory), cut < 8 ? 2 : 1) << cut;
  }
}

}  // namespace
}  // namespace armsig::controller
