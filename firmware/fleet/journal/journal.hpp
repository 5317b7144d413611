// SPDX-License-Identifier: MIT
// The rows of one cabinet in a ring of fixed size: written before they are sent, kept until the
// host has acknowledged them, found again after a power cut.
//
// A row is named by (journal, number): 64 random bits drawn with the storage, and a number that
// rises and is never used twice. Numbers are reserved in blocks, in a head that is written before
// the first of them is used; after a restart they go on with the next block. There are gaps
// therefore, and a reader goes from a row to the one before it that there is.
//
// Layout, little endian: two heads of 64 bytes at 0 and 512, the newer good one counts; from 4096
// on slots of 256 bytes, the n-th row ever appended at place n in slot n mod slots. The last four
// bytes of a head and of a slot are the CRC-32 of the others.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/fixed_vector.hpp"
#include "firmware/fleet/journal/storage.hpp"

namespace armsig::fleet {

class Journal {
 public:
  static constexpr std::size_t kSlotSize = 256;
  static constexpr std::size_t kLongestRow = 208;
  static constexpr std::uint64_t kFirstSlotAt = 4096;
  static constexpr std::uint64_t kLeastSlots = 16;
  static constexpr std::uint64_t kMostSlots = std::uint64_t{1} << 24U;

  struct Row {
    std::uint64_t number = 0;    // from 1
    std::uint64_t previous = 0;  // the number of the row before it that there is; 0: none
    std::uint64_t time_ms = 0;   // UTC
    FixedVector<std::byte, kLongestRow> bytes;
  };

  // Opens what is in `storage`, or begins anew under the name `random` where there is no good head
  // or it is of another number of slots. Reads every slot once. Preconditions: kLeastSlots to
  // kMostSlots slots; `storage` outlives the journal. Errors: those of the storage.
  [[nodiscard]] static Result<Journal> open(Storage& storage, std::uint64_t slots,
                                            std::uint64_t random);

  // The number of the new row, which is safe from a power cut. Where it takes the place of one that
  // nobody has acknowledged, that is counted. A number whose write failed is not used again.
  // Errors: kCapacityExceeded (bytes), those of the storage.
  [[nodiscard]] Result<std::uint64_t> append(std::uint64_t time_ms,
                                             std::span<const std::byte> bytes);

  // The first row above `number`; none: there is no later one. A row that fails its check is passed
  // over. Errors: kStorageFault.
  [[nodiscard]] Result<std::optional<Row>> after(std::uint64_t number);

  // The host has all rows up to `number` and none after. Lower than before where it was set back to
  // an earlier state: then the rows since are due again, as far as they are kept. A number that was
  // never appended changes nothing. Errors: those of the storage.
  [[nodiscard]] Result<void> acknowledge(std::uint64_t number);

  [[nodiscard]] std::uint64_t name() const { return head_.name; }
  [[nodiscard]] std::uint64_t acknowledged() const { return head_.acknowledged; }
  [[nodiscard]] std::uint64_t last() const { return last_; }  // appended; 0: none yet
  // Rows that went before they were acknowledged.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  struct Head {
    std::uint64_t sequence = 0;
    std::uint64_t name = 0;
    std::uint64_t slots = 0;
    std::uint64_t reserved = 1;  // numbers below may have been used
    std::uint64_t acknowledged = 0;
  };
  struct Slot {
    Row row;
    std::uint64_t place = 0;
    std::uint64_t dropped = 0;  // as of this row
  };

  explicit Journal(Storage& storage) : storage_(&storage) {}

  [[nodiscard]] Result<std::optional<Head>> newest_head(std::uint64_t slots);
  [[nodiscard]] Result<void> write_head();
  [[nodiscard]] Result<void> reserve();
  [[nodiscard]] Result<void> find_rows();
  [[nodiscard]] Result<std::optional<Slot>> slot(std::uint64_t index);
  // The first good row at `place` or after it, below `end`; the last at `place` or before.
  [[nodiscard]] Result<std::optional<Slot>> forward(std::uint64_t place, std::uint64_t end);
  [[nodiscard]] Result<std::optional<Slot>> backward(std::uint64_t place);
  [[nodiscard]] std::uint64_t lowest_place() const;

  Storage* storage_;
  Head head_;
  std::uint64_t next_ = 1;   // number of the row appended next
  std::uint64_t place_ = 0;  // and its place
  std::uint64_t last_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t written_acknowledged_ = 0;
};

}  // namespace armsig::fleet
