// SPDX-License-Identifier: MIT
// Drift over time: the sum over many checks of one arm in which a change too small for any single
// check shows. Crosier, "Multivariate generalizations of cumulative sum quality-control schemes",
// Technometrics 30 (1988), section 3.
//
// A check is the mean residual of the tool over n stored poses, a vector e; with sigma_c, one sigma
// of one of its components, z = e / sigma_c (without a unit).
#pragma once

#include "core/base/error.hpp"
#include "core/base/pose.hpp"

namespace armsig::drift {

// One sigma of a component of the mean of `poses` residuals that scatter by `pose_sigma_m` each and
// independently. Precondition: poses >= 1.
[[nodiscard]] double check_sigma(double pose_sigma_m, int poses);

// The reference value k for a shift of `shift_m`: half of it, in sigma_c.
[[nodiscard]] double reference_value(double shift_m, double sigma_m);

// The sum after a check: C = |S + z|; 0 where C <= k, else (S + z)(1 - k / C).
[[nodiscard]] Vector3 crosier(const Vector3& sum, const Vector3& z, double reference);

struct Settings {
  double sigma_m = 0;    // sigma_c
  double reference = 0;  // k
  double threshold = 0;  // h: the arm is named where |S| > h; see threshold.hpp
};

struct State {
  Vector3 sum = Vector3::Zero();  // S, after `checks` checks
  int checks = 0;
  // Checks since the sum last was zero: about when the change began, as far as the sum can tell.
  int since = 0;
  bool named = false;  // |S| > h; stays until the state is begun anew
};

// `state` after one more check with the mean residual `residual_m` less the reference's. A check
// that is not finite changes nothing. Errors: kNotFinite, kNotPositive (sigma or threshold not
// above zero, reference below).
[[nodiscard]] Result<State> after_check(const State& state, const Vector3& residual_m,
                                        const Settings& settings);

}  // namespace armsig::drift
