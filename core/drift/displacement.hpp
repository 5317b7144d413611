// SPDX-License-Identifier: MIT
// What is known of an arm one of whose links may have been displaced since it was identified.
#pragma once

#include "core/calibration/refined.hpp"

namespace armsig::drift {

// Sets `factor` to the information about the unknowns of `refined` when everything from link `link`
// on (its axis and all beyond, its targets; 0: the whole arm) has since moved rigidly by a rotation
// about the link's frame and a shift, `size` [rad] and [m] 1 sigma per component. Right-hand sides
// are zero.
void displaced_prior(const calibration::Refined& refined, std::size_t link, double size,
                     calibration::SquareRootFactor& factor);

}  // namespace armsig::drift
