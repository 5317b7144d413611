// SPDX-License-Identifier: MIT
// The signature of an arm that was fitted to touches, as every other command takes it.
#pragma once

#include "firmware/host_tool/places/place_run.hpp"

namespace armsig::tool {

// Sets the outcome and the knowledge of a calibration whose fit is there. The tool is target 1, the
// sensor's frame that of the nominal base. Errors: those of geometry_to_signature();
// kNotConverged where the arm is not like its nominal model.
[[nodiscard]] Judged<void> add_signature(PlaceCalibration& found);

}  // namespace armsig::tool
