// SPDX-License-Identifier: MIT
// The uncertain estimate behind a signature file, and back.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "core/calibration/refined.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

// The signature with its covariance as identification left it; `file` names it in problems.
[[nodiscard]] Read<std::unique_ptr<calibration::Refined>> estimate_of(const SignatureRecord& record,
                                                                      const std::string& file);

// Covariance of the unknowns, in the order of the layout.
[[nodiscard]] Eigen::MatrixXd covariance_of(const calibration::Refined& refined);

// Index of a target on the last link, whose position is what a tool error is about; nothing without
// one.
[[nodiscard]] std::optional<std::size_t> tool_target(const Signature& signature);

}  // namespace armsig::tool
