// SPDX-License-Identifier: MIT
// Which of two models predicts poses better that neither was fitted to.
#pragma once

#include "core/signature.hpp"
#include "firmware/controller/measurement_log.hpp"

namespace armsig::controller {

struct HeldOutReport {
  std::size_t poses = 0;
  double candidate_rms_m = 0;
  double active_rms_m = 0;

  [[nodiscard]] bool is_better() const { return poses > 0 && candidate_rms_m < active_rms_m; }
};

// Rewrites `active`, at any signature configuration and in any sensor frame, as a model to be
// compared with `candidate`: at its configuration, in its sensor frame, with its target where the
// candidate has it at the signature configuration, as it would be taught.
void lay_over(Signature& active, const Signature& candidate);

// The rows of `log` with sweep 0. Both have one target, on the hand.
[[nodiscard]] HeldOutReport compare(const Signature& candidate, const Signature& active,
                                    const MeasurementLog& log);

}  // namespace armsig::controller
