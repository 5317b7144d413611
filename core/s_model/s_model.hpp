// SPDX-License-Identifier: MIT
// The S-Model of Stone, Sanderson and Neuman: six parameters a joint, (4), from a general transform
// B_i by Paul's backward multiplication (section 3.2.3).
#pragma once

#include "core/base/arm.hpp"
#include "core/base/error.hpp"
#include "core/base/pose.hpp"

namespace armsig::s_model {

// B = Rot(z, beta) Trans(0, 0, d) Trans(a, 0, 0) Rot(x, alpha) Rot(z, gamma) Trans(0, 0, b), (4).
struct Parameters {
  double beta_rad = 0;
  double d_m = 0;
  double a_m = 0;
  double alpha_rad = 0;
  double gamma_rad = 0;
  double b_m = 0;
};

}  // namespace armsig::s_model
