// SPDX-License-Identifier: MIT
// The orientation of a pose in the columns of a table: a quaternion, or as makers of arms write it.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/pose.hpp"
#include "firmware/formats/csv_table.hpp"

namespace armsig::tool {

// The columns of every form, none of them required.
[[nodiscard]] std::vector<Quantity> orientation_quantities();

// The form that a table has, whose quantities begin at `first` in those of the table.
class OrientationColumns {
 public:
  // Refuses a table that has no form, two of them, or a part of one.
  [[nodiscard]] static Read<OrientationColumns> of(const CsvTable& table, std::size_t first);

  // Of the current row. Refuses a quaternion whose length is not 1 within 1e-3, and scales the
  // others to 1.
  [[nodiscard]] Read<Matrix3> rotation(const CsvTable& table) const;

 private:
  OrientationColumns(std::size_t form, std::size_t first) : form_(form), first_(first) {}

  std::size_t form_;
  std::size_t first_;  // quantity of the form
};

}  // namespace armsig::tool
