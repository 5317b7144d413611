// SPDX-License-Identifier: MIT
#include "firmware/host_tool/reading/copied_rows.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>

namespace armsig::tool {
namespace {

// Of a million rows no two differ and look alike.
std::size_t digest_of(const MeasurementRow& row) {
  std::string bytes;
  const auto add = [&](double number) {
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  add(static_cast<double>(row.sweep));
  add(static_cast<double>(row.target));
  std::ranges::for_each(row.q, add);
  if (row.p_S) std::ranges::for_each(*row.p_S, add);
  for (const std::optional<double>& range_m : row.ranges_m) add(range_m.value_or(-1.0));
  add(row.sigma_m.value_or(-1.0));
  return std::hash<std::string>{}(bytes);
}

}  // namespace

bool was_seen(const MeasurementRow& row) {
  return row.p_S || std::ranges::any_of(row.ranges_m, [](const std::optional<double>& range_m) {
           return range_m.has_value();
         });
}

bool CopiedRows::is_copy(const MeasurementRow& row) {
  if (!was_seen(row)) return false;
  const std::size_t digest = digest_of(row);
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
