// SPDX-License-Identifier: MIT
// From what a run found to what a signature file holds.
#pragma once

#include <string>

#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"
#include "firmware/host_tool/identification/identification_run.hpp"

namespace armsig::tool {

// `method` as in SignatureRecord; time and version are those of now and of this program.
[[nodiscard]] SignatureRecord record_of(const Identified& identified, const ArmDescription& arm,
                                        const std::string& method, const std::string& serial);

// What the refinement found beside the signature, and says of its own accuracy. Where sweeps alone
// leave open how the arm bends, that much more is stated, in `outcome` too; returns how many times
// what the fit says.
double add_refinement(SignatureRecord& record, RefinementOutcome& outcome, std::size_t receivers,
                      const Evidence& evidence);

// What the features say of their own accuracy; nothing where their covariances do not tell. Where
// poses of `evidence` that they do not use are missed by more, that much more is stated; returns
// how many times what the features say.
double add_features(SignatureRecord& record, const std::optional<CrossValidation>& validation,
                    const Evidence& evidence);

// A signature computed rather than measured (method "exact").
[[nodiscard]] SignatureRecord exact_record(const Signature& signature, const ArmDescription& arm);

}  // namespace armsig::tool
