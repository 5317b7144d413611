// SPDX-License-Identifier: MIT
// A signature as tables for a person and as an object for programs.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "core/signature.hpp"
#include "firmware/analysis/evaluation/comparison.hpp"

namespace armsig::tool {

// One line a sweep: arc, radius, points, residuals, scale of the reading. Empty for a signature not
// from sweeps.
[[nodiscard]] std::string sweep_table(const Signature& signature);

// Denavit-Hartenberg rows in degrees and millimetres, in the layout of the paper's Tables 1 and 2.
[[nodiscard]] std::string dh_table(const DhRows& rows);

// What to know about a distance d of metres, in words; empty where all axes are well apart from
// parallel.
[[nodiscard]] std::string near_parallel_note(const Signature& signature);

// The four indices with the ideal model and with the signature, and their ratios.
[[nodiscard]] std::string comparison_table(const evaluation::Comparison& comparison);

[[nodiscard]] nlohmann::ordered_json signature_json(const Signature& signature);
[[nodiscard]] nlohmann::ordered_json comparison_json(const evaluation::Comparison& comparison);

}  // namespace armsig::tool
