// SPDX-License-Identifier: MIT
// The store of signatures on memories that hardly suit or do not, that do not keep what is written,
// or whose ledgers say too little.
#include <gtest/gtest.h>

#include "core/identification.hpp"
#include "firmware/controller/record_store.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/ram_memory.hpp"

namespace armsig::controller {
namespace {

using test::RamMemory;

// The fewest pages a sector that a store can do with.
constexpr hal::MemoryLayout kFewPages{.page_bytes = 512, .pages_per_sector = 4, .sectors = 10};

void begin(RecordStore& store, double air_celsius) {
  SignatureRecord record;
  record.signature = signature_of(tool::table2_robot(1), JointVector(6, 0.1), Pose{}, {});
  record.air_celsius = air_celsius;
  encode(record, store.next_sequence(), store.begin_write());
}

Result<bool> write(RecordStore& store, double air_celsius) {
  begin(store, air_celsius);
  Result<bool> done = false;
  while (done && !*done) done = store.step();
  return done;
}

// Page `page` of the ledger that says what is active holds nothing of worth.
void spoil(RamMemory& memory, std::size_t sector, std::size_t page) {
  const hal::MemoryLayout layout = memory.layout();
  const std::size_t at = sector * layout.sector_bytes() + page * layout.page_bytes;
  std::fill_n(memory.bytes.begin() + static_cast<std::ptrdiff_t>(at), 40, std::uint8_t{0});
}

TEST(StoreFits, pages_of_a_ledgers_entry_to_the_largest_four_of_them_a_sector_and_three_banks) {
  const auto fits = [](hal::MemoryLayout layout) {
    RamMemory memory(layout);
    const bool fitting = RecordStore(memory).fits();
    if (!fitting) {
      EXPECT_EQ(test::failure_of(RecordStore(memory).open()), Error::kAddressOutOfRange);
    }
    return fitting;
  };
  EXPECT_TRUE(fits({.page_bytes = 32, .pages_per_sector = 8, .sectors = 60}));
  EXPECT_FALSE(fits({.page_bytes = 31, .pages_per_sector = 8, .sectors = 90}));
  EXPECT_TRUE(fits({.page_bytes = 512, .pages_per_sector = 8, .sectors = 10}));
  EXPECT_FALSE(fits({.page_bytes = 513, .pages_per_sector = 8, .sectors = 10}));
  EXPECT_TRUE(fits({.page_bytes = 256, .pages_per_sector = 4, .sectors = 20}));
  EXPECT_FALSE(fits({.page_bytes = 256, .pages_per_sector = 3, .sectors = 40}));
  // Sixteen pages of 256 bytes for a record of 3956, and a sector of the ledger, three times.
  EXPECT_TRUE(fits({.page_bytes = 256, .pages_per_sector = 8, .sectors = 9}));
  EXPECT_FALSE(fits({.page_bytes = 256, .pages_per_sector = 8, .sectors = 8}));
}

TEST(StoreReadsBack, and_enters_no_record_of_which_a_page_came_out_otherwise) {
  RamMemory memory;
  RecordStore store(memory);
  ASSERT_TRUE(store.open());
  begin(store, 1);
  Result<bool> done = false;
  bool spoilt = false;
  while (done && !*done) {
    done = store.step();
    std::uint8_t& byte = memory.bytes[RamMemory::kFirstRecord];
    if (!spoilt && byte != hal::kErasedByte) {
      byte ^= 1;
      spoilt = true;
    }
  }
  ASSERT_TRUE(spoilt);
  EXPECT_EQ(test::failure_of(done), Error::kRecordCorrupt);
  EXPECT_FALSE(store.active());
}

TEST(StoreReadsBack, and_says_where_it_cannot) {
  RamMemory memory;
  RecordStore store(memory);
  ASSERT_TRUE(store.open());
  begin(store, 1);
  Result<bool> done = false;
  while (done && !*done) {
    done = store.step();
    if (memory.bytes[RamMemory::kFirstRecord] != hal::kErasedByte) memory.reads_left = 0;
  }
  EXPECT_EQ(test::failure_of(done), Error::kStorageFault);
}

TEST(StoreOpens, as_a_new_one_where_one_page_is_torn_and_not_where_two_are_in_any_bank) {
  for (std::size_t bank = 0; bank < kStoreBanks; ++bank) {
    RamMemory memory;
    RecordStore store(memory);
    spoil(memory, 3 * bank, 0);
    EXPECT_TRUE(store.open()) << bank;
    EXPECT_FALSE(store.active());
    spoil(memory, 3 * bank, 1);
    EXPECT_EQ(test::failure_of(store.open()), Error::kRecordCorrupt) << bank;
  }
}

// The first use of a memory begins in the first bank: a loss of power in it spoils no other.
TEST(StoreOpens, as_a_new_one_where_a_record_cannot_be_read_in_the_first_bank_alone) {
  for (std::size_t bank = 0; bank < kStoreBanks; ++bank) {
    RamMemory memory;
    memory.unreadable_sector = 3 * bank + 1;
    RecordStore store(memory);
    EXPECT_EQ(store.open().has_value(), bank == 0) << bank;
    EXPECT_FALSE(store.active());
  }
}

TEST(StoreOpens, with_nothing_active_only_where_nothing_is_lost) {
  RamMemory memory;
  RecordStore store(memory);
  ASSERT_TRUE(store.open());
  ASSERT_TRUE(write(store, 1));
  memory.bytes[RamMemory::kFirstRecord + 100] ^= 1;
  EXPECT_EQ(test::failure_of(store.open()), Error::kRecordCorrupt);
  EXPECT_FALSE(store.active());
}

TEST(StoreOpens, with_the_trouble_that_there_is_now) {
  RamMemory memory;
  RecordStore store(memory);
  ASSERT_TRUE(store.open());
  ASSERT_TRUE(write(store, 1));
  ASSERT_TRUE(write(store, 2));
  const auto active = *store.active();
  std::uint8_t& byte =
      memory.bytes[(3 * active.bank + 1) * RamMemory::kLayout.sector_bytes() + 100];
  byte ^= 1;
  ASSERT_TRUE(store.open());
  EXPECT_EQ(store.trouble(), Error::kRecordCorrupt);
  EXPECT_NE(store.active(), active) << "the former is in its place";
  byte ^= 1;
  ASSERT_TRUE(store.open());
  EXPECT_EQ(store.trouble(), std::nullopt);
  EXPECT_EQ(store.active(), active);
}

// An entry that a loss of power left unsettled is entered anew behind it, in two pages.
TEST(StoreOpens, and_settles_what_was_entered_while_its_ledger_has_two_pages_left) {
  for (const std::size_t torn : {1U, 2U}) {
    RamMemory memory(kFewPages);
    RecordStore store(memory);
    ASSERT_TRUE(store.open());
    ASSERT_TRUE(write(store, 1));
    const auto active = store.active();
    const std::size_t ledger = active->bank * (store.sectors() / kStoreBanks);
    for (std::size_t page = 1; page <= torn; ++page) spoil(memory, ledger, page);
    ASSERT_TRUE(store.open());
    EXPECT_EQ(store.active(), active);
    EXPECT_EQ(store.trouble(), torn == 1 ? std::nullopt : std::optional(Error::kStorageFull));
  }
}

TEST(StoreOpens, and_says_that_it_could_not_settle_what_was_entered) {
  RamMemory memory;
  RecordStore store(memory);
  ASSERT_TRUE(store.open());
  ASSERT_TRUE(write(store, 1));
  spoil(memory, std::size_t{3} * store.active()->bank, 1);
  memory.refusal = Error::kStorageFault;
  ASSERT_TRUE(store.open());
  EXPECT_TRUE(store.active());
  EXPECT_EQ(store.trouble(), Error::kStorageFault);
}

TEST(StoreOpens, without_trouble_after_a_loss_of_power_in_its_first_entries) {
  RamMemory memory(kFewPages);
  {
    RecordStore store(memory);
    ASSERT_TRUE(store.open());
    // The sector is erased and the first page written, the second one in part.
    memory.bytes_left = kFewPages.sector_bytes() + kFewPages.page_bytes + 16;
    EXPECT_EQ(test::failure_of(write(store, 1)), Error::kStorageFault);
  }
  memory.bytes_left.reset();
  RecordStore store(memory);
  ASSERT_TRUE(store.open());
  EXPECT_EQ(store.trouble(), std::nullopt);
  EXPECT_TRUE(write(store, 1));
}

TEST(StoreRollsBack, to_no_record_that_cannot_be_read) {
  RamMemory memory;
  RecordStore store(memory);
  ASSERT_TRUE(store.open());
  ASSERT_TRUE(write(store, 1));
  ASSERT_TRUE(write(store, 2));
  const std::size_t former =
      (3 * std::size_t{store.former()->bank} + 1) * RamMemory::kLayout.sector_bytes();
  memory.bytes[former + 100] ^= 1;
  EXPECT_EQ(test::failure_of(store.begin_rollback()), Error::kRecordCorrupt);
  EXPECT_FALSE(store.is_writing());
  memory.reads_left = 0;
  EXPECT_EQ(test::failure_of(store.begin_rollback()), Error::kStorageFault);
}

}  // namespace
}  // namespace armsig::controller
