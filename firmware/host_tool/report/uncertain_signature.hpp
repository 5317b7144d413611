// SPDX-License-Identifier: MIT
// What the covariance of a signature means for anything computed from it.
#pragma once

#include <memory>

#include <Eigen/Core>

#include "core/calibration/refined.hpp"
#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

// The estimate behind a record: by its covariance, or by that of its sweeps; null where it has
// neither.
[[nodiscard]] std::unique_ptr<calibration::Refined> estimate_behind(const SignatureRecord& record);

// The signature with its unknowns moved by `step`, in the order of the layout of `estimate`, its
// parameters derived anew.
[[nodiscard]] Signature moved(const calibration::Refined& estimate, const Arm& nominal,
                              const Eigen::VectorXd& step);

// 1 sigma of each pseudo Denavit-Hartenberg parameter.
[[nodiscard]] DhRows parameter_sigmas(const calibration::Refined& estimate, const Arm& nominal);

}  // namespace armsig::tool
