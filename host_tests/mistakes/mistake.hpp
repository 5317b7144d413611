// SPDX-License-Identifier: MIT
// What somebody got wrong, as what it does to a set of measurements.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "host_tests/mistakes/measured_set.hpp"

namespace armsig::mistakes {

struct Mistake {
  std::string name;
  std::function<void(Set&)> make;
  // A mistake of the person's readings, who will make it again when the arm is used; others are of
  // these measurements alone.
  bool lasts = false;
  std::string says = {};  // words that the refusal holds, on a Puma
};

using Edit = std::function<void(Row&)>;

inline std::function<void(Set&)> every(Edit edit) {
  return [edit = std::move(edit)](Set& set) {
    for (Row& row : set.rows) edit(row);
  };
}

inline std::function<void(Set&)> positions_times(double x, double y, double z) {
  return every([=](Row& row) {
    row.p[0] *= x;
    row.p[1] *= y;
    row.p[2] *= z;
  });
}

// Revolute readings of all joints, or of one.
inline std::function<void(Set&)> angles_times(double factor, std::optional<std::size_t> one = {}) {
  return [=](Set& set) {
    for (Row& row : set.rows) {
      for (std::size_t j = 0; j < set.size(); ++j) {
        if (set.revolute(j) && (!one || *one == j)) row.q[j] *= factor;
      }
    }
  };
}

inline std::function<void(Set&)> rows_from(double share, Edit edit) {
  return [=](Set& set) {
    const auto first = static_cast<std::size_t>(share * static_cast<double>(set.rows.size()));
    for (std::size_t k = first; k < set.rows.size(); ++k) edit(set.rows[k]);
  };
}

// Grows from the first row to the last.
inline std::function<void(Set&)> creeping(std::function<void(Row&, double share)> edit) {
  return [=](Set& set) {
    const auto last = static_cast<double>(set.rows.size() - 1);
    for (std::size_t k = 0; k < set.rows.size(); ++k) {
      edit(set.rows[k], static_cast<double>(k) / last);
    }
  };
}

// From the middle on, and ever after: poses that were held out come later.
inline std::function<void(Set&)> slipping(Edit edit) {
  return [=](Set& set) {
    const bool held_out = set.rows.front().sweep == 0;
    (held_out ? every(edit) : rows_from(0.5, edit))(set);
  };
}

inline void turn(Row& row, double degrees) {
  const double c = std::cos(radians(degrees));
  const double s = std::sin(radians(degrees));
  const double x = row.p[0];
  row.p[0] = c * x - s * row.p[1];
  row.p[1] = s * x + c * row.p[1];
}

inline std::function<void(Set&)> arm_by(std::function<void(DhJoint&)> edit) {
  return [edit = std::move(edit)](Set& set) {
    for (DhJoint& joint : set.joints()) edit(joint);
  };
}

inline void shift_positions(Set& set, std::size_t by) {
  for (std::size_t k = set.rows.size() - 1; k >= by; --k) {
    std::copy_n(set.rows[k - by].p, 3, set.rows[k].p);
  }
}

}  // namespace armsig::mistakes
