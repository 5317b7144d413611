// SPDX-License-Identifier: MIT
// What `armsig identify` makes of doubts in the arm that it has found, or has not.
#pragma once

#include <optional>
#include <string>

#include "firmware/formats/problem.hpp"
#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/diagnosis/gate.hpp"
#include "firmware/host_tool/presentation/identify_report.hpp"

namespace armsig::tool {

// `enlarged`: what the record states of its accuracy, over what the method itself predicts.
// `outcome`: of the refinement, null for another method.
[[nodiscard]] std::optional<Doubt> doubt_of(const Evidence& evidence, const ArmLimits& limits,
                                            const SignatureRecord& record, double enlarged,
                                            const RefinementOutcome* outcome);

// A refusal, with the mistake that explains it where one is found.
[[nodiscard]] Problem explained(Problem problem, const Evidence& evidence, const ArmLimits& limits);

[[nodiscard]] Problem problem_of(const Doubt& doubt, const std::string& file);

// Adds the doubt to the record as a warning. What it leaves open is part of what is stated.
void warn_of(const Doubt& doubt, std::string words, SignatureRecord& record, Found& found);

}  // namespace armsig::tool
