// SPDX-License-Identifier: MIT
#include "firmware/fleet/journal/journal.hpp"

#include <algorithm>
#include <cstring>

#include "core/base/check.hpp"
#include "core/base/crc32.hpp"

namespace armsig::fleet {
namespace {

constexpr std::uint64_t kHeadMark = 0x6A6F75726E616C31;
constexpr std::size_t kHeadSize = 64;
constexpr std::array<std::uint64_t, 2> kHeadsAt{0, 512};
constexpr std::uint64_t kBlock = 256;              // numbers reserved at once
constexpr std::uint64_t kAcknowledgedAtOnce = 64;  // written to the head only so often
constexpr std::size_t kRowAt = 44;

void put(std::span<std::byte> bytes, std::size_t at, std::uint64_t value, std::size_t size = 8) {
  for (std::size_t i = 0; i < size; ++i) {
    bytes[at + i] = static_cast<std::byte>(value >> (8 * i) & 0xFFU);
  }
}

std::uint64_t get(std::span<const std::byte> bytes, std::size_t at, std::size_t size = 8) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    value |= std::to_integer<std::uint64_t>(bytes[at + i]) << (8 * i);
  }
  return value;
}

// The last four bytes are the CRC of those before.
void seal(std::span<std::byte> bytes) {
  put(bytes, bytes.size() - 4, crc32(bytes.first(bytes.size() - 4)), 4);
}

bool is_sealed(std::span<const std::byte> bytes) {
  return get(bytes, bytes.size() - 4, 4) == crc32(bytes.first(bytes.size() - 4));
}

}  // namespace

Result<Journal> Journal::open(Storage& storage, std::uint64_t slots, std::uint64_t random) {
  ARMSIG_CHECK(slots >= kLeastSlots && slots <= kMostSlots);
  Journal journal(storage);
  ARMSIG_TRY(head, journal.newest_head(slots));
  if (head) {
    journal.head_ = *head;
    journal.written_acknowledged_ = head->acknowledged;
    if (auto found = journal.find_rows(); !found) return std::unexpected(found.error());
  } else {
    journal.head_ = {.name = random, .slots = slots};
  }
  if (auto reserved = journal.reserve(); !reserved) return std::unexpected(reserved.error());
  return journal;
}

Result<std::optional<Journal::Head>> Journal::newest_head(std::uint64_t slots) {
  std::optional<Head> newest;
  int good = 0;
  for (const std::uint64_t at : kHeadsAt) {
    std::array<std::byte, kHeadSize> bytes{};
    if (auto read = storage_->read(at, bytes); !read) return std::unexpected(read.error());
    if (!is_sealed(bytes) || get(bytes, 0) != kHeadMark) continue;
    const Head head{.sequence = get(bytes, 8),
                    .name = get(bytes, 16),
                    .slots = get(bytes, 24),
                    .reserved = get(bytes, 32),
                    .acknowledged = get(bytes, 40)};
    if (head.slots != slots) continue;
    ++good;
    if (!newest || head.sequence > newest->sequence) newest = head;
  }
  // The other head may have been the newer one: it reserved one block more.
  if (newest && good < 2) newest->reserved += kBlock;
  return newest;
}

Result<void> Journal::write_head() {
  ++head_.sequence;
  std::array<std::byte, kHeadSize> bytes{};
  put(bytes, 0, kHeadMark);
  put(bytes, 8, head_.sequence);
  put(bytes, 16, head_.name);
  put(bytes, 24, head_.slots);
  put(bytes, 32, head_.reserved);
  put(bytes, 40, head_.acknowledged);
  seal(bytes);
  auto written = storage_->write(kHeadsAt[head_.sequence % 2], bytes);
  if (written) written = storage_->sync();
  if (written) written_acknowledged_ = head_.acknowledged;
  return written;
}

// Numbers go on above all that may have been used.
Result<void> Journal::reserve() {
  const std::uint64_t before = head_.reserved;
  next_ = std::max(next_, before);
  head_.reserved = next_ + kBlock;
  auto written = write_head();
  if (!written) head_.reserved = before;
  return written;
}

Result<void> Journal::find_rows() {
  for (std::uint64_t index = 0; index < head_.slots; ++index) {
    ARMSIG_TRY(found, slot(index));
    if (!found || found->place < place_) continue;
    place_ = found->place + 1;
    last_ = found->row.number;
    dropped_ = found->dropped;
  }
  next_ = last_ + 1;
  return {};
}

Result<std::optional<Journal::Slot>> Journal::slot(std::uint64_t index) {
  std::array<std::byte, kSlotSize> bytes{};
  if (auto read = storage_->read(kFirstSlotAt + index * kSlotSize, bytes); !read) {
    return std::unexpected(read.error());
  }
  const std::uint64_t size = get(bytes, 40, 4);
  if (!is_sealed(bytes) || get(bytes, 0) != head_.name || size > kLongestRow) return std::nullopt;
  Slot slot;
  slot.row.number = get(bytes, 8);
  slot.place = get(bytes, 16);
  slot.row.time_ms = get(bytes, 24);
  slot.dropped = get(bytes, 32);
  if (slot.row.number == 0 || slot.place % head_.slots != index) return std::nullopt;
  for (std::size_t i = 0; i < size; ++i) slot.row.bytes.push_back(bytes[kRowAt + i]);
  return slot;
}

Result<std::optional<Journal::Slot>> Journal::forward(std::uint64_t place, std::uint64_t end) {
  for (; place < end; ++place) {
    ARMSIG_TRY(found, slot(place % head_.slots));
    if (found && found->place == place) return *found;
  }
  return std::nullopt;
}

Result<std::optional<Journal::Slot>> Journal::backward(std::uint64_t place) {
  for (std::uint64_t next = place + 1; next > lowest_place(); --next) {
    ARMSIG_TRY(found, slot((next - 1) % head_.slots));
    if (found && found->place == next - 1) return *found;
  }
  return std::nullopt;
}

std::uint64_t Journal::lowest_place() const {
  return place_ > head_.slots ? place_ - head_.slots : 0;
}

Result<std::uint64_t> Journal::append(std::uint64_t time_ms, std::span<const std::byte> row) {
  if (row.size() > kLongestRow) return std::unexpected(Error::kCapacityExceeded);
  if (next_ >= head_.reserved) {
    if (auto reserved = reserve(); !reserved) return std::unexpected(reserved.error());
  }
  const std::uint64_t index = place_ % head_.slots;
  ARMSIG_TRY(oldest, slot(index));
  const bool drops =
      oldest && oldest->place + head_.slots == place_ && oldest->row.number > head_.acknowledged;
  const std::uint64_t number = next_++;
  std::array<std::byte, kSlotSize> bytes{};
  put(bytes, 0, head_.name);
  put(bytes, 8, number);
  put(bytes, 16, place_);
  put(bytes, 24, time_ms);
  put(bytes, 32, dropped_ + (drops ? 1 : 0));
  put(bytes, 40, row.size(), 4);
  std::ranges::copy(row, bytes.begin() + kRowAt);
  seal(bytes);
  auto written = storage_->write(kFirstSlotAt + index * kSlotSize, bytes);
  if (written) written = storage_->sync();
  if (!written) return std::unexpected(written.error());
  if (drops) ++dropped_;
  ++place_;
  last_ = number;
  return number;
}

// Numbers rise with the places: by halves, over the slots that are damaged.
Result<std::optional<Journal::Row>> Journal::after(std::uint64_t number) {
  std::uint64_t low = lowest_place();
  std::uint64_t high = place_;
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    ARMSIG_TRY(probe, forward(middle, high));
    if (probe && probe->row.number <= number) {
      low = probe->place + 1;
    } else {
      high = middle;
    }
  }
  ARMSIG_TRY(found, forward(low, place_));
  if (!found) return std::nullopt;
  Row row = found->row;
  if (found->place > lowest_place()) {
    ARMSIG_TRY(before, backward(found->place - 1));
    row.previous = before ? before->row.number : 0;
  }
  return row;
}

Result<void> Journal::acknowledge(std::uint64_t number) {
  if (number == head_.acknowledged || number > last_) return {};
  const bool back = number < head_.acknowledged;
  head_.acknowledged = number;
  // What is not written yet is only sent once more after a restart.
  if (!back && number - written_acknowledged_ < kAcknowledgedAtOnce) return {};
  return write_head();
}

}  // namespace armsig::fleet
