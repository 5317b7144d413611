// SPDX-License-Identifier: MIT
// Where the joints were, kept in one sector: what a torn, worn, foreign or missing one leads to.
#include "firmware/controller/position_keeper.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "core/base/crc32.hpp"
#include "firmware/controller/store_ledger.hpp"
#include "host_tests/support/ram_memory.hpp"

namespace armsig::controller {
namespace {

constexpr std::size_t kSector = 6;
constexpr std::size_t kBegin = kSector * test::RamMemory::kLayout.sector_bytes();
constexpr std::size_t kImage = 116;

std::vector<double> at(double reading) { return std::vector<double>(6, reading); }
RestRecord readings_of(double reading) {
  return {.positions = JointVector(6, reading), .unreferenced = 5, .drives = DriveMarks(6, 9)};
}

void keep(test::RamMemory& memory, double reading) {
  PositionKeeper keeper(memory, kSector);
  (void)keeper.load(6);
  keeper.begin(readings_of(reading));
  for (int i = 0; i < 3 && keeper.is_writing(); ++i) keeper.step();
  EXPECT_FALSE(keeper.is_writing());
}

// None where there are none.
std::vector<double> kept(test::RamMemory& memory, std::size_t joints = 6) {
  const auto rest = PositionKeeper(memory, kSector).load(joints);
  if (!rest) return {};
  EXPECT_EQ(rest->unreferenced, 5);
  EXPECT_TRUE(std::ranges::equal(rest->drives, DriveMarks(6, 9)));
  return {rest->positions.begin(), rest->positions.end()};
}
const std::vector<double> kNone;

// Changes a byte of the first page and makes its CRC-32 that of what it then holds.
void reseal(test::RamMemory& memory, std::size_t offset, std::uint8_t value) {
  memory.bytes[kBegin + offset] = value;
  const std::uint32_t crc =
      crc32(std::as_bytes(std::span(memory.bytes).subspan(kBegin, kImage - 4)));
  for (std::size_t i = 0; i < 4; ++i) {
    memory.bytes[kBegin + kImage - 4 + i] = static_cast<std::uint8_t>(crc >> 8 * i);
  }
}

TEST(PositionKeeper, keeps_the_last_one_over_many_turns_of_its_sector) {
  test::RamMemory memory;
  EXPECT_EQ(kept(memory), kNone);
  for (int i = 1; i <= 30; ++i) {
    keep(memory, i);
    ASSERT_EQ(kept(memory), at(i)) << i;
  }
  for (std::size_t i = 0; i < kBegin; ++i) ASSERT_EQ(memory.bytes[i], hal::kErasedByte);
}

TEST(PositionKeeper, writes_nothing_where_the_arm_has_not_moved) {
  test::RamMemory memory;
  keep(memory, 1);
  const std::size_t changed = memory.changed;
  keep(memory, 1);
  EXPECT_EQ(memory.changed, changed);
}

TEST(PositionKeeper, that_was_torn_has_the_one_before_and_goes_on_after_it) {
  test::RamMemory memory;
  keep(memory, 1);
  memory.bytes_left = 50;
  keep(memory, 2);
  memory.bytes_left.reset();
  EXPECT_EQ(kept(memory), at(1));
  keep(memory, 3);
  EXPECT_EQ(kept(memory), at(3));
}

TEST(PositionKeeper, takes_no_image_with_a_byte_changed) {
  test::RamMemory memory;
  keep(memory, 1);
  for (std::size_t i = 0; i < kImage; ++i) {
    memory.bytes[kBegin + i] ^= 4;
    EXPECT_EQ(kept(memory), kNone) << i;
    memory.bytes[kBegin + i] ^= 4;
  }
  EXPECT_NE(kept(memory), kNone);
}

TEST(PositionKeeper, takes_none_of_another_version_of_too_many_joints_or_of_no_number) {
  for (const auto& [offset, value] : {std::pair{4, 3}, {6, 9}, {6, 255}, {19, 0x7F}}) {
    test::RamMemory memory;
    keep(memory, 1);
    ASSERT_NE(kept(memory), kNone);
    if (offset == 19) memory.bytes[kBegin + 18] = 0xF0;  // 0x7FF0...: infinite
    reseal(memory, static_cast<std::size_t>(offset), static_cast<std::uint8_t>(value));
    EXPECT_EQ(kept(memory), kNone) << offset << " " << value;
  }
}

TEST(PositionKeeper, has_nothing_for_an_arm_of_other_joints) {
  test::RamMemory memory;
  keep(memory, 1);
  EXPECT_EQ(kept(memory, 5), kNone);
  EXPECT_EQ(kept(memory, 7), kNone);
}

TEST(PositionKeeper, passes_over_a_page_that_cannot_be_read) {
  test::RamMemory memory;
  keep(memory, 1);
  keep(memory, 2);
  memory.reads_left = 1;
  EXPECT_EQ(kept(memory), at(1));
}

TEST(PositionKeeper, gives_up_where_the_memory_takes_no_change) {
  test::RamMemory memory;
  for (int i = 1; i <= 8; ++i) keep(memory, i);
  memory.refusal = Error::kStorageFault;
  keep(memory, 9);  // the sector is full, and its erasing fails
  EXPECT_EQ(kept(memory), at(8));
}

TEST(PositionKeeper, keeps_nothing_in_a_memory_without_its_sector) {
  test::RamMemory memory;
  PositionKeeper keeper(memory, test::RamMemory::kLayout.sectors);
  EXPECT_FALSE(keeper.load(6));
  keeper.begin(readings_of(1));
  EXPECT_FALSE(keeper.is_writing());
}

TEST(PositionKeeper, that_loads_again_knows_only_what_is_there_now) {
  test::RamMemory memory;
  keep(memory, 1);
  PositionKeeper keeper(memory, kSector);
  ASSERT_TRUE(keeper.load(6));
  ASSERT_TRUE(memory.erase_sector(kSector));
  EXPECT_FALSE(keeper.load(6));
}

TEST(PositionKeeper, neither_takes_nor_keeps_any_in_pages_too_small_or_too_large_for_it) {
  test::RamMemory good;
  keep(good, 1);
  for (const std::size_t page_bytes : {std::size_t{64}, kLargestPage + 1}) {
    test::RamMemory memory(
        {.page_bytes = page_bytes, .pages_per_sector = 8, .sectors = kSector + 1});
    const std::size_t begin = kSector * memory.layout().sector_bytes();
    std::copy_n(good.bytes.begin() + kBegin, kImage,
                memory.bytes.begin() + static_cast<std::ptrdiff_t>(begin));
    PositionKeeper keeper(memory, kSector);
    EXPECT_FALSE(keeper.load(6)) << page_bytes;
    keeper.begin(readings_of(2));
    EXPECT_FALSE(keeper.is_writing()) << page_bytes;
  }
}

TEST(PositionKeeper, keeps_what_became_known_of_an_arm_that_stands_where_it_stood) {
  test::RamMemory memory;
  keep(memory, 1);
  PositionKeeper keeper(memory, kSector);
  RestRecord confirmed = *keeper.load(6);
  confirmed.unreferenced = 0;
  keeper.begin(confirmed);
  EXPECT_TRUE(keeper.is_writing());
  confirmed = *keeper.load(6);
  confirmed.drives[5] = 10;
  keeper.begin(confirmed);
  EXPECT_TRUE(keeper.is_writing());
}

// Pages that a foreign tool has put in another order: the highest number is the last.
TEST(PositionKeeper, takes_the_highest_number_wherever_its_page_is) {
  test::RamMemory memory;
  keep(memory, 1);
  keep(memory, 2);
  const auto page = static_cast<std::ptrdiff_t>(test::RamMemory::kLayout.page_bytes);
  const auto first = memory.bytes.begin() + static_cast<std::ptrdiff_t>(kBegin);
  std::swap_ranges(first, first + page, first + page);
  EXPECT_EQ(kept(memory), at(2));
}

}  // namespace
}  // namespace armsig::controller
