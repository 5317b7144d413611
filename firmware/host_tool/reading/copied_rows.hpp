// SPDX-License-Identifier: MIT
// Rows that are in a file twice, to the last digit: pasted twice, or written by a log that stood
// still. No second measurement is like that, and counted as one it makes everything look better
// known than it is.
#pragma once

#include <cstddef>
#include <unordered_set>
#include <vector>

#include "firmware/formats/measurements.hpp"

namespace armsig::tool {

// Of rows that are all kept in memory, so many are remembered.
inline constexpr std::size_t kRememberedInMemory = std::size_t{4} << 20U;

// Whether the row gives a position, or a range at least.
[[nodiscard]] bool was_seen(const MeasurementRow& row);

class CopiedRows {
 public:
  // Remembers the last `remembered` rows.
  explicit CopiedRows(std::size_t remembered) : remembered_(remembered) {}

  // Is `row`, whose target was seen, a copy of one before? It is remembered.
  [[nodiscard]] bool is_copy(const MeasurementRow& row);

  [[nodiscard]] std::size_t count() const { return count_; }  // of copies so far

 private:
  std::size_t remembered_;
  std::unordered_set<std::size_t> known_;
  std::vector<std::size_t> order_;  // a ring
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

}  // namespace armsig::tool
