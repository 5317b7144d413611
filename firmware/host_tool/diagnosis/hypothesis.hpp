// SPDX-License-Identifier: MIT
// What people get wrong, as transformations of what they gave: undone, the rest fits.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

struct Hypothesis {
  std::string cause;      // "the positions are in metres"
  std::string undoing;    // "times 1000": how they fit
  std::string mend;       // "name the columns x_m, y_m, z_m": what to change
  double surprise = 0;    // how much less usual than a wrong unit
  bool harmless = false;  // found as it is: a zero, which identification measures anyway
  std::function<void(Evidence&)> undo;
};

// Units and handedness of the positions; rows out of step; numbers of targets and sweeps.
[[nodiscard]] std::vector<Hypothesis> hypotheses_of_rows(const Evidence& evidence);
// Rows in which a position or a reading stood still while the arm moved on.
[[nodiscard]] std::vector<Hypothesis> hypotheses_of_frozen_rows(const Evidence& evidence);
// Units, senses, order, couplings and zeros of the joint readings.
[[nodiscard]] std::vector<Hypothesis> hypotheses_of_readings(const Evidence& evidence);
// As the arm description states it.
[[nodiscard]] std::string coupling_line(std::size_t joint, std::size_t from, double ratio);
// Units and conventions of the arm description.
[[nodiscard]] std::vector<Hypothesis> hypotheses_of_arm(const Evidence& evidence);

// What the columns show without any fit: one that never changes, one in rising order. Empty where
// there is nothing to say.
[[nodiscard]] std::string odd_columns(const Evidence& evidence);

}  // namespace armsig::tool
