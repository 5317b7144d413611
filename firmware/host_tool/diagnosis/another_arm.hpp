// SPDX-License-Identifier: MIT
// Is a signature that of an arm built to this drawing?
#pragma once

#include <optional>
#include <string>

#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/diagnosis/near_fit.hpp"

namespace armsig::tool {

struct Farness {
  double times_allowed = 0;  // of the deviation that is largest against the limits
  std::string words;         // that deviation
};

// How far the arm of `record` is from `drawing`, found as `identify` does, from where the signature
// puts a tool all over the joint limits. Precondition: the same joint types in both.
[[nodiscard]] Farness farness_of(const SignatureRecord& record, const Arm& drawing,
                                 const ArmLimits& limits);

// Whether what is as far as `truth` is another arm than one that was found as far as `found`: what
// `identify` has accepted as far from its own drawing may have a truth that is as far.
[[nodiscard]] bool is_of_another_arm(const Farness& truth, const Farness& found);

}  // namespace armsig::tool
