// SPDX-License-Identifier: MIT
// How well fits predict rows that they were not fitted to.
#pragma once

#include <cstddef>

namespace armsig::tool {

// Of the residual lengths of the rows left out, measured minus predicted; all of them, those too
// that a fit to everything rejects.
struct CrossValidation {
  std::size_t rows = 0;
  double mean_m = 0;
  double rms_m = 0;
  double largest_m = 0;
  // Without those that are far from the others of their sweep.
  std::size_t far_off = 0;
  double mean_kept_m = 0;
  double rms_kept_m = 0;
};

}  // namespace armsig::tool
