// SPDX-License-Identifier: MIT
// The paper's task, touching a grid, before and after: with the drawing and with the signature.
#pragma once

#include <cstddef>
#include <optional>

#include "firmware/analysis/evaluation/comparison.hpp"
#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/report/uncertain_signature.hpp"

namespace armsig::tool {

struct GridTask {
  evaluation::Comparison comparison;
  // 0: on the arm itself, which is known. Otherwise the median over so many arms drawn from the
  // covariance: the arms that this signature may belong to. They have its corrections, maps and
  // gravity, which the signature knows of and the drawing does not; how uncertain those are is left
  // out, as a signature keeps the variances of a map and not their covariances.
  std::size_t drawn_arms = 0;
};

// Nothing where the grid can't be touched, and where neither truth nor estimate says how far the
// signature may be from the arm. `estimate` may be null.
[[nodiscard]] std::optional<GridTask> grid_task(const SignatureRecord& record,
                                                const calibration::Refined* estimate,
                                                const std::optional<SignatureRecord>& truth);

}  // namespace armsig::tool
