// SPDX-License-Identifier: MIT
// What an entry of the store's ledger must be, once its CRC-32 is right, and what a bank's ledger
// says of those it holds.
#include "firmware/controller/store_ledger.hpp"

#include <gtest/gtest.h>

#include "core/base/crc32.hpp"
#include "host_tests/support/ram_memory.hpp"

namespace armsig::controller {
namespace {

LedgerEntry entry(std::uint32_t number, LedgerKind kind = LedgerKind::kEntered) {
  return {.kind = kind,
          .number = number,
          .newest = 7,
          .active = StoredRecord{1, 0x1234'5678},
          .former = StoredRecord{2, 0x9ABC'DEF0}};
}

// Whether an entry is taken of which a byte was changed before its CRC-32 was made.
bool is_taken_with(std::size_t at, std::uint8_t value) {
  LedgerImage image = encode(entry(5));
  image[at] = value;
  const std::size_t end = image.size() - 4;
  const std::uint32_t crc = crc32(std::as_bytes(std::span(image).first(end)));
  for (std::size_t i = 0; i < 4; ++i) image[end + i] = static_cast<std::uint8_t>(crc >> 8 * i);
  return decode(image).has_value();
}

TEST(LedgerEntry, is_what_was_encoded) {
  EXPECT_EQ(decode(encode(entry(5))), entry(5));
  LedgerEntry nothing;
  nothing.number = 1;
  EXPECT_EQ(decode(encode(nothing)), nothing);
  for (std::size_t at = 20; at < 28; ++at) EXPECT_EQ(encode(nothing)[at], 0) << "no record's CRC";
}

TEST(LedgerEntry, with_a_byte_changed_is_none) {
  for (std::size_t i = 0; i < kLedgerEntryBytes; ++i) {
    LedgerImage image = encode(entry(5));
    image[i] ^= 8;
    EXPECT_FALSE(decode(image)) << i;
  }
}

TEST(LedgerEntry, has_its_magic_version_and_kind_and_banks_that_there_are) {
  EXPECT_TRUE(is_taken_with(0, 'A'));
  EXPECT_FALSE(is_taken_with(3, 'd'));
  EXPECT_FALSE(is_taken_with(4, 1)) << "version";
  EXPECT_FALSE(is_taken_with(5, 1));
  EXPECT_TRUE(is_taken_with(6, 2)) << "settled";
  EXPECT_FALSE(is_taken_with(6, 3)) << "kind";
  for (const std::size_t bank : {16U, 17U}) {
    EXPECT_TRUE(is_taken_with(bank, 2));
    EXPECT_FALSE(is_taken_with(bank, 3));
    EXPECT_TRUE(is_taken_with(bank, 0xFF)) << "no record";
    EXPECT_FALSE(is_taken_with(bank, 0xFE));
  }
}

TEST(BankLedger, says_what_the_largest_number_says_and_whether_that_is_settled) {
  test::RamMemory memory;
  const auto put = [&memory](std::size_t page, const LedgerEntry& what) {
    ASSERT_TRUE(write_entry(memory, 0, page, what));
  };
  put(0, {});
  BankLedger ledger = read_ledger(memory, 0);
  EXPECT_TRUE(ledger.intact);
  EXPECT_FALSE(ledger.entry) << "void";
  EXPECT_EQ(ledger.next_page, 1U);
  put(2, entry(5));
  put(3, entry(5, LedgerKind::kSettled));
  ledger = read_ledger(memory, 0);
  EXPECT_EQ(ledger.entry, entry(5, LedgerKind::kSettled));
  EXPECT_TRUE(ledger.settled);
  EXPECT_EQ(ledger.next_page, 4U);
  put(4, entry(4));
  EXPECT_EQ(read_ledger(memory, 0).entry, entry(5, LedgerKind::kSettled));
  EXPECT_TRUE(read_ledger(memory, 0).settled);
  put(5, entry(5));
  EXPECT_TRUE(read_ledger(memory, 0).settled) << "it was already";
  put(6, entry(6));
  ledger = read_ledger(memory, 0);
  EXPECT_EQ(ledger.entry, entry(6));
  EXPECT_FALSE(ledger.settled);
}

TEST(BankLedger, counts_what_is_strange_and_says_what_cannot_be_read) {
  test::RamMemory memory;
  memory.bytes[0] = 0;
  memory.bytes[2 * test::RamMemory::kLayout.page_bytes] = 0;
  BankLedger ledger = read_ledger(memory, 0);
  EXPECT_EQ(ledger.strange, 2U);
  EXPECT_FALSE(ledger.intact);
  EXPECT_FALSE(ledger.unreadable);
  EXPECT_EQ(ledger.next_page, 3U);
  memory.reads_left = 5;
  ledger = read_ledger(memory, 0);
  EXPECT_TRUE(ledger.unreadable);
  EXPECT_EQ(ledger.strange, 2U);
  EXPECT_EQ(ledger.next_page, test::RamMemory::kLayout.pages_per_sector);
}

TEST(WriteEntry, that_the_memory_refuses_or_cannot_read_back_is_none) {
  test::RamMemory memory;
  memory.refusal = Error::kStorageFault;
  EXPECT_FALSE(write_entry(memory, 0, 0, entry(5)));
  memory.refusal.reset();
  memory.reads_left = 0;
  EXPECT_FALSE(write_entry(memory, 0, 1, entry(5)));
}

}  // namespace
}  // namespace armsig::controller
