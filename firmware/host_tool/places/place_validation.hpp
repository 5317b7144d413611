// SPDX-License-Identifier: MIT
// Validation by placement: how well the arm found without a placement predicts the touches of that
// placement, whose places alone are then fitted (docs/model.md, section 13). In closed form, at the
// scales of the fit to everything.
#pragma once

#include <optional>

#include "firmware/host_tool/places/place_fit.hpp"

namespace armsig::tool {

struct PlacementValidation {
  std::size_t placements = 0;
  std::size_t touches = 0;
  double mean_m = 0;  // of the lengths of their errors
  double rms_m = 0;
  double largest_m = 0;
  // By which the errors exceed what is stated for them, 1 at least.
  double factor = 1;
};

// Nothing where there are not two placements with more numbers than their places have unknowns.
[[nodiscard]] std::optional<PlacementValidation> validate_by_placement(const PlaceTask& task,
                                                                       const PlaceFit& fit);

}  // namespace armsig::tool
