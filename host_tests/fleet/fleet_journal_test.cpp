// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/fleet/journal/file_storage.hpp"
#include "firmware/fleet/journal/journal.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::fleet {
namespace {

using test::failure_of;

constexpr std::uint64_t kSlots = 16;
constexpr std::uint64_t kName = 0x0123456789ABCDEF;

// Bytes in memory; the power goes after so many written bytes, in the middle of a write if need be.
struct Ram final : Storage {
  std::vector<std::byte> bytes;
  std::size_t left = SIZE_MAX;
  std::size_t written = 0;

 private:
  Result<void> do_read(std::uint64_t at, std::span<std::byte> to) override {
    for (std::size_t i = 0; i < to.size(); ++i) {
      to[i] = at + i < bytes.size() ? bytes[at + i] : std::byte{0};
    }
    return {};
  }
  Result<void> do_write(std::uint64_t at, std::span<const std::byte> from) override {
    const std::size_t count = std::min(left, from.size());
    if (bytes.size() < at + count) bytes.resize(at + count);
    std::memcpy(bytes.data() + at, from.data(), count);
    left -= count;
    written += count;
    if (count < from.size()) return std::unexpected(Error::kStorageFault);
    return {};
  }
  Result<void> do_sync() override {
    if (left == 0) return std::unexpected(Error::kStorageFault);
    return {};
  }
};

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::string text_of(const Journal::Row& row) {
  return {reinterpret_cast<const char*>(row.bytes.data()), row.bytes.size()};
}

Journal opened(Ram& ram, std::uint64_t name = kName) {
  auto journal = Journal::open(ram, kSlots, name);
  EXPECT_TRUE(journal);
  return *journal;
}

std::uint64_t appended(Journal& journal, const std::string& text, std::uint64_t time_ms = 1) {
  const auto number = journal.append(time_ms, bytes_of(text));
  EXPECT_TRUE(number);
  return number.value_or(0);
}

std::vector<Journal::Row> rows_after(Journal& journal, std::uint64_t number) {
  std::vector<Journal::Row> rows;
  for (std::size_t i = 0; i <= kSlots; ++i) {
    const auto row = journal.after(number);
    EXPECT_TRUE(row);
    if (!row || !*row) return rows;
    rows.push_back(**row);
    number = (*row)->number;
  }
  ADD_FAILURE() << "more rows than slots";
  return rows;
}

TEST(FleetJournal, RowsComeBackInTheirOrder) {
  Ram ram;
  Journal journal = opened(ram);
  EXPECT_EQ(journal.last(), 0U);
  EXPECT_TRUE(rows_after(journal, 0).empty());
  appended(journal, "one", 100);
  appended(journal, "two", 50);
  const auto rows = rows_after(journal, 0);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(text_of(rows[0]), "one");
  EXPECT_EQ(rows[0].number, 1U);
  EXPECT_EQ(rows[0].previous, 0U);
  EXPECT_EQ(rows[0].time_ms, 100U);
  EXPECT_EQ(text_of(rows[1]), "two");
  EXPECT_EQ(rows[1].number, 2U);
  EXPECT_EQ(rows[1].previous, 1U);
  EXPECT_EQ(rows[1].time_ms, 50U);
  EXPECT_EQ(journal.name(), kName);
}

TEST(FleetJournal, RestartKeepsRowsAndNameAndUsesNoNumberTwice) {
  Ram ram;
  std::set<std::uint64_t> numbers;
  std::uint64_t before = 0;
  for (int life = 0; life < 5; ++life) {
    Journal journal = opened(ram, kName + static_cast<std::uint64_t>(life));
    EXPECT_EQ(journal.name(), kName);
    for (int i = 0; i < 2; ++i) {
      const std::uint64_t number = appended(journal, std::to_string(life));
      EXPECT_TRUE(numbers.insert(number).second) << number;
      const auto row = journal.after(number - 1);
      ASSERT_TRUE(row && *row);
      EXPECT_EQ((*row)->previous, before);
      before = number;
    }
  }
  Journal journal = opened(ram);
  const auto rows = rows_after(journal, 0);
  ASSERT_EQ(rows.size(), 10U) << "restarts cost no rows";
  EXPECT_EQ(text_of(rows[9]), "4");
}

TEST(FleetJournal, FullRingLosesTheOldestAndCountsIt) {
  Ram ram;
  {
    Journal journal = opened(ram);
    for (int i = 1; i <= 4; ++i) appended(journal, std::to_string(i));
    ASSERT_TRUE(journal.acknowledge(4));
    for (int i = 5; i <= 20; ++i) appended(journal, std::to_string(i));
    EXPECT_EQ(journal.dropped(), 0U) << "what was acknowledged is not lost";
    for (int i = 21; i <= 23; ++i) appended(journal, std::to_string(i));
    EXPECT_EQ(journal.dropped(), 3U);
    const auto rows = rows_after(journal, 0);
    ASSERT_EQ(rows.size(), kSlots);
    EXPECT_EQ(text_of(rows[0]), "8");
    EXPECT_EQ(rows[0].previous, 0U) << "there is none before it any more";
    EXPECT_EQ(rows[1].previous, 8U);
  }
  EXPECT_EQ(ram.bytes.size(), Journal::kFirstSlotAt + kSlots * Journal::kSlotSize);
  EXPECT_EQ(opened(ram).dropped(), 3U);
}

TEST(FleetJournal, AcknowledgementIsKeptAndMayGoBack) {
  Ram ram;
  {
    Journal journal = opened(ram);
    for (int i = 1; i <= 100; ++i) appended(journal, "x");
    ASSERT_TRUE(journal.acknowledge(101));
    EXPECT_EQ(journal.acknowledged(), 0U) << "never appended";
    ASSERT_TRUE(journal.acknowledge(90));
  }
  Journal journal = opened(ram);
  EXPECT_EQ(journal.acknowledged(), 90U);
  ASSERT_TRUE(journal.acknowledge(86));
  EXPECT_EQ(journal.acknowledged(), 86U);
  EXPECT_EQ(opened(ram).acknowledged(), 86U);
}

TEST(FleetJournal, RowThatIsTooLongIsRefused) {
  Ram ram;
  Journal journal = opened(ram);
  const std::string longest(Journal::kLongestRow, 'x');
  EXPECT_EQ(failure_of(journal.append(1, bytes_of(longest + "x"))), Error::kCapacityExceeded);
  EXPECT_EQ(appended(journal, longest), 1U);
  EXPECT_EQ(text_of(rows_after(journal, 0).at(0)), longest);
}

TEST(FleetJournal, StorageOfAnotherSizeBeginsAnew) {
  Ram ram;
  {
    Journal journal = opened(ram);
    appended(journal, "old");
  }
  auto journal = Journal::open(ram, 2 * kSlots, 77);
  ASSERT_TRUE(journal);
  EXPECT_EQ(journal->name(), 77U);
  EXPECT_TRUE(rows_after(*journal, 0).empty());
}

// What a row must read, whatever happened: its text tells its number.
std::string told(std::uint64_t number) { return "row " + std::to_string(number); }

// Everything readable is what was written under that number, each number once and rising.
std::set<std::uint64_t> numbers_read(Journal& journal) {
  std::set<std::uint64_t> numbers;
  for (const Journal::Row& row : rows_after(journal, 0)) {
    EXPECT_EQ(text_of(row), told(row.number));
    EXPECT_LT(row.previous, row.number);
    EXPECT_TRUE(numbers.insert(row.number).second);
  }
  return numbers;
}

// Goes on until the power goes; the numbers whose append was confirmed.
void write_until_the_end(Journal& journal, int rows, std::set<std::uint64_t>& confirmed) {
  for (int i = 0; i < rows; ++i) {
    // The number is known only afterwards: it is the last one plus one within a block.
    const std::uint64_t expected = journal.last() + 1;
    const auto number = journal.append(1, bytes_of(told(expected)));
    if (!number) return;
    EXPECT_EQ(*number, expected);
    confirmed.insert(*number);
  }
}

TEST(FleetJournal, PowerMayGoAtEveryByte) {
  Ram whole;
  {
    Journal journal = opened(whole);
    std::set<std::uint64_t> confirmed;
    write_until_the_end(journal, 3, confirmed);
  }
  ASSERT_GT(whole.written, 3 * Journal::kSlotSize);
  for (std::size_t cut = 0; cut <= whole.written; ++cut) {
    Ram ram;
    ram.left = cut;
    std::set<std::uint64_t> confirmed;
    auto first = Journal::open(ram, kSlots, kName);
    if (first) write_until_the_end(*first, 3, confirmed);
    ram.left = SIZE_MAX;
    Journal journal = opened(ram, 99);
    const auto read = numbers_read(journal);
    for (const std::uint64_t number : confirmed) EXPECT_TRUE(read.contains(number)) << cut;
    EXPECT_EQ(journal.name(), first ? kName : journal.name()) << cut;
    const std::uint64_t next = appended(journal, "next");
    EXPECT_FALSE(read.contains(next)) << cut;
    EXPECT_FALSE(confirmed.contains(next)) << cut;
  }
}

TEST(FleetJournal, FileMayBeCutAtEveryByte) {
  Ram whole;
  std::set<std::uint64_t> used;
  {
    Journal journal = opened(whole);
    write_until_the_end(journal, 600, used);  // so many that the newest head is the second one
    ASSERT_TRUE(journal.acknowledge(40));
  }
  for (std::size_t cut = 0; cut <= whole.bytes.size(); ++cut) {
    Ram ram;
    ram.bytes.assign(whole.bytes.begin(), whole.bytes.begin() + static_cast<long>(cut));
    Journal journal = opened(ram, 99);
    const auto read = numbers_read(journal);
    const std::uint64_t next = appended(journal, "next");
    if (journal.name() == kName) {
      EXPECT_FALSE(used.contains(next)) << cut;
    } else {
      EXPECT_EQ(journal.name(), 99U);
      EXPECT_TRUE(read.empty()) << "no row under another name";
    }
  }
}

TEST(FleetJournal, DamagedByteCostsItsRowAlone) {
  Ram whole;
  std::set<std::uint64_t> used;
  {
    Journal journal = opened(whole);
    write_until_the_end(journal, 12, used);
  }
  for (std::size_t at = Journal::kFirstSlotAt; at < whole.bytes.size(); at += 7) {
    Ram ram;
    ram.bytes = whole.bytes;
    ram.bytes[at] ^= std::byte{0x10};
    Journal journal = opened(ram);
    EXPECT_GE(numbers_read(journal).size(), 11U) << at;
    EXPECT_FALSE(used.contains(appended(journal, "next"))) << at;
    std::uint64_t before = 0;
    for (const Journal::Row& row : rows_after(journal, 0)) {
      EXPECT_EQ(row.previous, before) << "the chain goes over the hole";
      before = row.number;
    }
  }
}

TEST(FleetJournal, FileIsTakenWholeAndByOneProcess) {
  const auto path =
      std::filesystem::temp_directory_path() / ("armsig-journal-" + std::to_string(::getpid()));
  std::filesystem::remove(path);
  {
    auto storage = FileStorage::open(path, 8192);
    ASSERT_TRUE(storage);
    EXPECT_EQ(std::filesystem::file_size(path), 8192U);
    EXPECT_EQ(failure_of(FileStorage::open(path, 8192)), Error::kStorageFault);
    auto journal = Journal::open(*storage, kSlots, kName);
    ASSERT_TRUE(journal);
    appended(*journal, "kept");
  }
  auto storage = FileStorage::open(path, 8192);
  ASSERT_TRUE(storage);
  auto journal = Journal::open(*storage, kSlots, 99);
  ASSERT_TRUE(journal);
  EXPECT_EQ(text_of(rows_after(*journal, 0).at(0)), "kept");
  std::filesystem::remove(path);
  EXPECT_EQ(failure_of(FileStorage::open("/proc/armsig-journal", 8192)), Error::kStorageFault);
}

}  // namespace
}  // namespace armsig::fleet
