// SPDX-License-Identifier: MIT
// The store of signatures: records of the arm, whatever is done to them. How it survives a loss of
// power is in store_power_test.cpp.
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "core/base/crc32.hpp"
#include "core/identification.hpp"
#include "firmware/controller/signature_store.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "host_tests/support/bent_puma.hpp"
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
  EXPECT_EQ(active_in(memory), 0) << "before the first there was the nominal model";
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
TEST(SignatureStore, has_banks_of_three_sectors_and_leaves_one_for_the_positions) {
  RamMemory memory;
  EXPECT_EQ(RecordStore(memory).sectors(), 9U);
  EXPECT_TRUE(RecordStore(memory).fits());
}

TEST(SignatureStore, keeps_all_of_a_record) {
  RamMemory memory;
  SignatureStore store(memory);
  SignatureRecord record = record_of(1);
  record.accuracy.validated = {1.5e-4, 20};
  record.method = Method::kRefined;
  record.identified_at_s = 1'763'800'000;
  record.accuracy.predicted = {7e-5, PredictedRegion::kJointLimits};
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
  EXPECT_EQ(found.accuracy, record.accuracy);
  EXPECT_EQ(found.method, Method::kRefined);
  EXPECT_EQ(found.identified_at_s, 1'763'800'000);
  EXPECT_FALSE(difference(record.machine, found.machine));
  EXPECT_EQ(found.machine.drives[5], record.machine.drives[5]);
}

SignatureRecord record_of_persons(std::string_view sender, std::string_view confirmer) {
  SignatureRecord record = record_of(1);
  for (const char letter : sender) record.persons.sender.push_back(letter);
  for (const char letter : confirmer) record.persons.confirmer.push_back(letter);
  return record;
}

TEST(SignatureStore, keeps_who_answers_for_each_record) {
  RamMemory memory;
  SignatureStore store(memory);
  SignatureRecord found;
  (void)store.load(tool::puma560(), found);
  const std::string longest(PersonName::capacity(), 'x');
  ASSERT_TRUE(write(store, record_of_persons("anna", longest)));
  ASSERT_TRUE(store.load(tool::puma560(), found));
  EXPECT_EQ(view(found.persons.sender), "anna");
  EXPECT_EQ(view(found.persons.confirmer), longest);
  ASSERT_TRUE(write(store, record_of(2)));
  ASSERT_TRUE(store.load(tool::puma560(), found));
  EXPECT_EQ(view(found.persons.sender), "");
  EXPECT_FALSE(found.persons.unreadable);
  ASSERT_TRUE(roll_back(store));
  ASSERT_TRUE(store.load(tool::puma560(), found));
  EXPECT_EQ(view(found.persons.sender), "anna");
}

TEST(SignatureStore, uses_a_record_whose_persons_have_one_wrong_byte_and_says_so) {
  RamMemory memory;
  SignatureStore store(memory);
  SignatureRecord found;
  (void)store.load(tool::puma560(), found);
  ASSERT_TRUE(write(store, record_of_persons("anna", "ben")));
  for (std::size_t i = 0; i < kPersonsBytes; ++i) {
    std::uint8_t& byte = memory.bytes[RamMemory::kFirstRecord + kRecordBytes + i];
    byte ^= 0x10;
    ASSERT_TRUE(store.load(tool::puma560(), found)) << i;
    EXPECT_TRUE(found.persons.unreadable) << i;
    EXPECT_TRUE(found.persons.sender.empty()) << i;
    byte ^= 0x10;
  }
}

TEST(Persons, answer_for_the_record_that_they_were_stored_with_and_for_no_other) {
  const Persons persons = record_of_persons("anna", "ben").persons;
  EXPECT_EQ(view(decode_persons(encode(persons, 1), 1).confirmer), "ben");
  EXPECT_TRUE(decode_persons(encode(persons, 1), 2).unreadable);
}

// A store of before had nothing behind its records.
TEST(Persons, of_a_record_without_them_are_nobody) {
  const PersonsImage erased = encode(Persons(), 1);
  EXPECT_TRUE(std::ranges::all_of(erased, [](std::uint8_t byte) { return byte == 0xFF; }));
  EXPECT_TRUE(decode_persons(erased, 2).sender.empty());
  EXPECT_FALSE(decode_persons(erased, 2).unreadable);
}

// Maps of 0.02 degrees and gravity at two joints.
SignatureRecord bent_record() {
  SignatureRecord record = record_of(1);
  record.deflections = test::bent_puma();
  return record;
}

std::uint32_t crc_over(const RecordImage& image, std::size_t length) {
  return crc32(std::as_bytes(std::span(image).first(length)));
}

void put(RecordImage& image, std::size_t at, std::uint64_t value, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) {
    image[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

// Whether a record is refused whose bytes were changed before its CRC was made.
bool refused(RecordImage image) {
  put(image, kRecordBytes - 4, crc_over(image, kRecordBytes - 4), 4);
  SignatureRecord found;
  const auto decoded = decode(image, tool::puma560(), found);
  return !decoded && decoded.error() == Error::kRecordCorrupt;
}

TEST(SignatureStore, keeps_maps_and_gravity_to_the_last_bit) {
  RamMemory memory;
  SignatureStore store(memory);
  const SignatureRecord record = bent_record();
  SignatureRecord found;
  (void)store.load(tool::puma560(), found);
  ASSERT_TRUE(write(store, record));
  ASSERT_TRUE(store.load(tool::puma560(), found));
  const auto& expected = record.deflections;
  ASSERT_EQ(found.deflections.maps.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(found.deflections.maps[i].steps, expected.maps[i].steps);
    EXPECT_EQ(found.deflections.maps[i].step, expected.maps[i].step);
    EXPECT_EQ(found.deflections.maps[i].domain.origin, expected.maps[i].domain.origin);
    EXPECT_EQ(found.deflections.maps[i].domain.per_length, expected.maps[i].domain.per_length);
    EXPECT_EQ(found.deflections.drawn_zero[i], expected.drawn_zero[i]);
  }
  ASSERT_EQ(found.deflections.gravity.size(), expected.gravity.size());
  for (std::size_t k = 0; k < expected.gravity.size(); ++k) {
    EXPECT_EQ(found.deflections.gravity[k].joint, expected.gravity[k].joint);
    EXPECT_EQ(found.deflections.gravity[k].origin, expected.gravity[k].origin);
    EXPECT_EQ(found.deflections.gravity[k].coefficient, expected.gravity[k].coefficient);
  }
  ASSERT_TRUE(write(store, record_of(2)));
  ASSERT_TRUE(store.load(tool::puma560(), found));
  EXPECT_TRUE(found.deflections.empty()) << "none are left over from the record before";
  EXPECT_TRUE(found.deflections.gravity.empty());
}

// With a CRC that is right: what is refused is what the servo would make of it.
TEST(SignatureStore, refuses_a_map_or_gravity_by_which_a_reading_could_jump) {
  constexpr std::size_t kThere = 1408;
  constexpr std::size_t kTerms = 1412;
  constexpr std::size_t kFirstMap = 1416;
  constexpr std::size_t kStep = kFirstMap + 16;
  constexpr std::size_t kSteps = kFirstMap + 32;
  constexpr std::size_t kGravity = 3592;
  const RecordImage sound = encode(bent_record());
  ASSERT_FALSE(refused(sound));
  const auto changed = [&](std::size_t at, std::uint64_t value, std::size_t bytes) {
    RecordImage image = sound;
    put(image, at, value, bytes);
    return refused(image);
  };
  EXPECT_TRUE(changed(kThere, 2, 4));
  EXPECT_TRUE(changed(kTerms, 29, 4)) << "more terms than there is room for";
  EXPECT_TRUE(changed(kThere, 0, 4)) << "gravity without maps";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(changed(kFirstMap, std::bit_cast<std::uint64_t>(nan), 8));
  EXPECT_TRUE(changed(kFirstMap + 8, std::bit_cast<std::uint64_t>(1e6), 8)) << "knots too dense";
  EXPECT_TRUE(changed(kStep, std::bit_cast<std::uint64_t>(1e-4), 8)) << "a map of radians";
  EXPECT_TRUE(changed(kStep, std::bit_cast<std::uint64_t>(-1e-9), 8));
  RecordImage spike = sound;
  put(spike, kStep, std::bit_cast<std::uint64_t>(1e-6), 8);
  for (std::size_t k = 0; k < 120; ++k) put(spike, kSteps + 2 * k, k == 60 ? 32000 : 0, 2);
  EXPECT_TRUE(refused(spike)) << "small, and too steep";
  EXPECT_TRUE(changed(kGravity, 6, 1)) << "of a joint that is not there";
  EXPECT_TRUE(changed(kGravity + 1, 0, 1)) << "a weight before its joint";
  EXPECT_TRUE(changed(kGravity + 4, std::bit_cast<std::uint64_t>(0.12), 8)) << "too heavy";
}

TEST(SignatureStore, tells_a_record_in_parts_as_it_is_stored) {
  const SignatureRecord record = bent_record();
  const RecordImage whole = encode(record);
  for (std::size_t begin = 0; begin < kRecordBytes; begin += 192) {
    std::array<std::uint8_t, 192> room{};
    const auto part = std::span(room).first(std::min<std::size_t>(192, kRecordBytes - begin));
    encode_part(record, begin, part);
    EXPECT_TRUE(std::ranges::equal(part, std::span(whole).subspan(begin, part.size()))) << begin;
  }
}

}  // namespace
}  // namespace armsig::controller
