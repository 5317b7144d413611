// SPDX-License-Identifier: MIT
#include "hal/simulated/flash.hpp"

#include <algorithm>
#include <numeric>

#include "core/base/check.hpp"

namespace armsig::simulated {
namespace {

std::uint8_t target_of(const std::uint8_t* to, std::size_t i) {
  return to == nullptr ? hal::kErasedByte : to[i];
}

}  // namespace

Flash::Flash(const FlashConfiguration& configuration)
    : configuration_(configuration), random_(configuration.seed) {
  const hal::MemoryLayout& layout = configuration.layout;
  ARMSIG_CHECK(layout.bytes() <= kCapacity && layout.page_bytes <= kLargestPage &&
               layout.pages_per_sector * layout.sectors <= kMostPages);
  bytes_.fill(hal::kErasedByte);
}

void Flash::cut_power_after(std::size_t bytes, Tearing tearing) {
  left_ = bytes;
  configuration_.tearing = tearing;
}

void Flash::power_up() {
  powered_ = true;
  left_.reset();
  ++power_ups_;
}

// A linear congruential generator (Knuth, MMIX), of which the upper bits are good.
std::uint32_t Flash::random() {
  random_ = random_ * 6364136223846793005U + 1442695040888963407U;
  return static_cast<std::uint32_t>(random_ >> 33U);
}

Result<void> Flash::do_read(std::size_t address, std::span<std::uint8_t> into) {
  if (!powered_) return std::unexpected(Error::kStorageFault);
  const std::size_t page_bytes = configuration_.layout.page_bytes;
  for (std::size_t i = 0; i < into.size();) {
    const std::size_t at = address + i;
    const std::size_t count = std::min(into.size() - i, page_bytes - at % page_bytes);
    const PageState state = states_[at / page_bytes];
    if (state == kLost) return std::unexpected(Error::kStorageFault);
    const bool former = state == kInTurn && power_ups_ % 2 == 0;
    std::copy_n((former ? before_ : bytes_).begin() + static_cast<std::ptrdiff_t>(at), count,
                into.begin() + static_cast<std::ptrdiff_t>(i));
    for (std::size_t k = 0; state == kAtRandom && k < count; ++k) {
      if (random() % 2 == 0) into[i + k] = before_[at + k];
    }
    i += count;
  }
  return {};
}

Result<void> Flash::do_erase_sector(std::size_t sector) {
  if (powered_ && erases_[sector] >= configuration_.endurance) {
    return std::unexpected(Error::kStorageFault);
  }
  if (powered_) ++erases_[sector];
  const std::size_t bytes = configuration_.layout.sector_bytes();
  return change(sector * bytes, bytes, nullptr);
}

Result<void> Flash::do_program_page(std::size_t address, std::span<const std::uint8_t> page) {
  std::array<std::uint8_t, kLargestPage> present{};
  const auto old = std::span(present).first(page.size());
  if (auto read = do_read(address, old); !read) return read;
  if (!std::ranges::all_of(old, [](std::uint8_t byte) { return byte == hal::kErasedByte; })) {
    return std::unexpected(Error::kNotErased);
  }
  return change(address, page.size(), page.data());
}

Result<void> Flash::change(std::size_t address, std::size_t count, const std::uint8_t* to) {
  if (!powered_) return std::unexpected(Error::kStorageFault);
  const bool fails = fails_ && fails_->count-- == 0;
  const bool cut = left_ && *left_ < count;
  if (fails || cut) {
    const std::size_t done = std::min(count, cut ? *left_ : fails_->bytes);
    if (fails) fails_.reset();
    powered_ = !cut;
    changed_ += done;
    tear(address, count, to, done);
    return std::unexpected(Error::kStorageFault);
  }
  for (std::size_t i = 0; i < count; ++i) bytes_[address + i] = target_of(to, i);
  const std::size_t page_bytes = configuration_.layout.page_bytes;
  for (std::size_t at = address; to == nullptr && at < address + count; at += page_bytes) {
    states_[at / page_bytes] = kWhole;
  }
  changed_ += count;
  if (left_) *left_ -= count;
  return {};
}

void Flash::tear(std::size_t address, std::size_t count, const std::uint8_t* to, std::size_t done) {
  switch (configuration_.tearing) {
    case Tearing::kForward:
    case Tearing::kBackward:
    case Tearing::kAnyOrder:
    case Tearing::kPartialBits:
      tear_bytes(address, count, to, done);
      return;
    case Tearing::kUnreadable:
      tear_pages(address, count, to, done, kLost);
      return;
    case Tearing::kUnstable:
      tear_pages(address, count, to, done, kInTurn);
      return;
    case Tearing::kFlickering:
      tear_pages(address, count, to, done, kAtRandom);
      return;
    case Tearing::kWholeBlock:
      const hal::MemoryLayout& layout = configuration_.layout;
      const std::size_t pages = configuration_.block_sectors * layout.pages_per_sector;
      const std::size_t first = address / layout.page_bytes / pages * pages;
      const std::size_t all = layout.pages_per_sector * layout.sectors;
      std::fill_n(states_.begin() + static_cast<std::ptrdiff_t>(first),
                  std::min(pages, all - first), kLost);
  }
}

void Flash::tear_bytes(std::size_t address, std::size_t count, const std::uint8_t* to,
                       std::size_t done) {
  // A walk through all bytes whose step is prime to their number, which is a power of two times a
  // small factor: a large prime.
  constexpr std::size_t kStep = 7919;
  const std::size_t first = random() % count;
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t at = i;
    if (configuration_.tearing == Tearing::kBackward) at = count - 1 - i;
    if (configuration_.tearing == Tearing::kAnyOrder) at = (first + i * kStep) % count;
    std::uint8_t& byte = bytes_[address + at];
    if (i < done) {
      byte = target_of(to, at);
    } else if (configuration_.tearing == Tearing::kPartialBits) {
      const auto mask = static_cast<std::uint8_t>(random());
      byte = static_cast<std::uint8_t>((byte & ~mask) | (target_of(to, at) & mask));
    }
  }
}

// Pages wholly before `done` are done; an operation of which nothing was begun leaves none torn.
void Flash::tear_pages(std::size_t address, std::size_t count, const std::uint8_t* to,
                       std::size_t done, PageState state) {
  if (done == 0) return;
  const std::size_t page_bytes = configuration_.layout.page_bytes;
  for (std::size_t i = 0; i < count; i += page_bytes) {
    const bool whole = i + page_bytes <= done;
    for (std::size_t k = 0; k < page_bytes; ++k) {
      before_[address + i + k] = bytes_[address + i + k];
      bytes_[address + i + k] = target_of(to, i + k);
    }
    PageState& page = states_[(address + i) / page_bytes];
    if (!whole) page = state;
    if (whole && to == nullptr) page = kWhole;
  }
}

}  // namespace armsig::simulated
