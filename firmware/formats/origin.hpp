// SPDX-License-Identifier: MIT
// The measurements that a signature was found from, so that they are known again, whatever the
// order, the units and the columns of the file that holds them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/formats/measurements.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/yaml_map.hpp"

namespace armsig::tool {

// Identifies a row by what was measured: readings to 1e-9 degrees or 1 nm, position or ranges to
// 1 nm. Sweep, target, sigma and air have no part in it. Nothing where the target was not seen.
[[nodiscard]] std::optional<std::uint64_t> row_hash(const MeasurementRow& row,
                                                    const JointTypes& types);

// In ascending order, each once: rows as a set.
void make_set(std::vector<std::uint64_t>& hashes);

// The CRC-32 of the hashes of a set, eight bytes each, the least significant first.
[[nodiscard]] std::uint32_t set_crc32(const std::vector<std::uint64_t>& set);

// A file keeps the hashes of so many fitted rows, the smallest: of a larger set a sample in which
// each row is as likely as any other.
inline constexpr std::size_t kMostRowHashes = 4096;

struct Origin {
  // As they stood on the command line; what is not printable is escaped.
  std::string arm;
  std::string measurements;
  std::string columns;                        // --columns; empty: none
  std::string sensor;                         // empty: none
  std::string options;                        // what else decides the result: "--method refined"
  std::optional<std::uint32_t> sensor_crc32;  // of its content, where there is a sensor
  std::size_t rows = 0;                       // different ones with a target that was seen
  std::uint32_t rows_crc32 = 0;               // of their set
  std::vector<std::uint64_t> fitted;          // of the rows fitted; a set, at most kMostRowHashes

  // Whether a row was fitted can be told, and whether it was.
  [[nodiscard]] bool tells_of(std::uint64_t hash) const;
  [[nodiscard]] bool has_fitted(std::uint64_t hash) const;
};

// The section `origin` of a signature file; empty where there is none.
[[nodiscard]] std::string origin_text(const std::optional<Origin>& origin);
// Reads it, where it is there.
[[nodiscard]] Read<std::optional<Origin>> read_origin_section(const YamlMap& root);

}  // namespace armsig::tool
