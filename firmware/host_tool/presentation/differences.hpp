// SPDX-License-Identifier: MIT
// What is different about the arm of a signature, joint by joint, in the words of a person.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/calibration/refined.hpp"
#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

// One line: what is different, by how much, and what that does to the tool.
struct DifferenceLine {
  std::size_t joint = 0;        // from 1
  std::string kind;             // tilt, shift, zero, scale, once-a-turn, twice-a-turn, map, gravity
  std::string words;            // "tilt towards the direction of axis 1"
  std::string unit;             // rad, m, or 1
  double value = 0;             // in that unit; of a map and gravity the largest anywhere
  std::optional<double> sigma;  // likewise, 1 sigma; nothing where it is not known
  double effect_rms_m = 0;
  double adds_m = 0;
};

struct DifferenceTable {
  std::vector<DifferenceLine> lines;
  double total_rms_m = 0;  // of the drawing with base and tool fitted: the sum of all adds_m
};

// `estimate`: what is behind the record, or nullptr. Nothing where the signature has no target on
// the last link, or is of another arm than its drawing.
[[nodiscard]] std::optional<DifferenceTable> difference_table(const SignatureRecord& record,
                                                              const calibration::Refined* estimate);
// The same with the estimate of the record's own covariance.
[[nodiscard]] std::optional<DifferenceTable> difference_table(const SignatureRecord& record);

// As a table for a terminal, heading and note included.
[[nodiscard]] std::string in_words(const DifferenceTable& table, std::size_t joints);
[[nodiscard]] nlohmann::ordered_json json_of(const DifferenceTable& table);

}  // namespace armsig::tool
