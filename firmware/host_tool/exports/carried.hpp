// SPDX-License-Identifier: MIT
// A signature as a format can carry it: with gravity and the joint error maps, with the maps,
// or as geometry alone, which is then the best there is without them.
#pragma once

#include "firmware/formats/problem.hpp"
#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

enum class Carries { kGeometry, kMaps, kEverything };

struct Carried {
  SignatureRecord record;
  double lost_rms_m = 0;  // by what is left out, over readings that the maps cover; 0: nothing is
  double lost_largest_m = 0;
};

// The record with its geometry fitted to what it says as a whole, over the readings that were
// measured, and its method saying so; as it is where nothing is left out. Refuses, in the name of
// `format`, where no geometry comes near.
[[nodiscard]] Read<Carried> carried_by(std::string_view format, Carries carries,
                                       const SignatureRecord& record);

}  // namespace armsig::tool
