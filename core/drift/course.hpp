// SPDX-License-Identifier: MIT
// How an arm came to drift: at once, as after a collision or an exchange, or little by little, as
// by wear.
#pragma once

#include <span>

#include "core/base/error.hpp"
#include "core/base/pose.hpp"

namespace armsig::drift {

enum class Course : std::uint8_t {
  kUndecided,  // neither explains the checks more than 20 times better than the other
  kStep,       // the same shift from some check on
  kRamp,       // a shift that began at some check and grows by the same each time
};
[[nodiscard]] std::string_view describe(Course course);

struct CourseReport {
  Course course = Course::kUndecided;
  int step_checks = 0;  // of the best step: the last so many checks are shifted
  Vector3 step_m = Vector3::Zero();
  int ramp_checks = 0;  // of the best ramp: the last so many checks
  Vector3 ramp_m_per_check = Vector3::Zero();
  double evidence = 0;  // ln of the likelihoods' ratio; above zero for the step
};

// Judges the mean residuals of checks, oldest first, less the reference's. `sigma_m` is one sigma
// of a component; where checks are correlated by r it is best told larger by sqrt((1 + r)/(1 - r)).
// The work grows with the number of checks alone. Errors: kTooFewPoints (below three), kNotFinite,
// kNotPositive.
[[nodiscard]] Result<CourseReport> course_of(std::span<const Vector3> residuals_m, double sigma_m);

}  // namespace armsig::drift
