// SPDX-License-Identifier: MIT
#include "firmware/host_tool/reading/copied_rows.hpp"

#include <algorithm>
#include <bit>
#include <optional>

namespace armsig::tool {
namespace {

// FNV-1a over whole words, mixed once more: of a million rows no two differ and look alike.
class Digest {
 public:
  void add(std::uint64_t word) {
    hash_ = (hash_ ^ word) * 0x100000001B3U;
    hash_ ^= hash_ >> 29U;
  }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325U;
};

bool was_seen(const MeasurementRow& row) {
  return row.p_S || std::ranges::any_of(row.ranges_m, [](const std::optional<double>& range_m) {
           return range_m.has_value();
         });
}

std::uint64_t digest_of(const MeasurementRow& row) {
  Digest digest;
  digest.add(static_cast<std::uint64_t>(row.sweep));
  digest.add(static_cast<std::uint64_t>(row.target));
  for (const double reading : row.q) digest.add(reading);
  if (row.p_S) {
    for (const double coordinate : *row.p_S) digest.add(coordinate);
  }
  for (const std::optional<double>& range_m : row.ranges_m) digest.add(range_m.value_or(-1.0));
  digest.add(row.sigma_m.value_or(-1.0));
  return digest.value();
}

}  // namespace

bool CopiedRows::is_copy(const MeasurementRow& row) {
  if (!was_seen(row)) return false;
  const std::uint64_t digest = digest_of(row);
  if (!known_.insert(digest).second) {
    ++count_;
    return true;
  }
  if (order_.size() < remembered_) {
    order_.push_back(digest);
    return false;
  }
  known_.erase(order_[next_]);
  order_[next_] = digest;
  next_ = (next_ + 1) % remembered_;
  return false;
}

}  // namespace armsig::tool
