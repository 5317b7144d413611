// SPDX-License-Identifier: MIT
// The uncertain estimate behind a signature file.
#pragma once

#include <memory>
#include <string>

#include "firmware/host_tool/formats/problem.hpp"
#include "firmware/host_tool/formats/signature_record.hpp"
#include "firmware/host_tool/refinement_run.hpp"

namespace armsig::tool {

// The signature with its covariance as the refinement left it; `file` names it in problems.
[[nodiscard]] Read<std::unique_ptr<refinement::Refined>> estimate_of(const SignatureRecord& record,
                                                                     const std::string& file);

}  // namespace armsig::tool
