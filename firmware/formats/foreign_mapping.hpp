// SPDX-License-Identifier: MIT
// Which columns of a file of other software are to become which of ours.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/formats/foreign_columns.hpp"

namespace armsig::tool {

// The fields of a line, without quotes and the space about them.
[[nodiscard]] std::vector<std::string> fields_of(std::string_view line, char separator);

// What --columns says.
struct Wanted {
  bool automatic = false;
  std::vector<MappedColumn> entries;
};

[[nodiscard]] Read<Wanted> wanted_of(std::string_view mapping);

// Where each of our columns stands in the file; nothing for a constant.
using Places = std::vector<std::optional<std::size_t>>;

// Maps the columns of a line that may be the header. Nothing when a name is not among them.
[[nodiscard]] std::optional<Places> places_in(const std::vector<std::string>& header,
                                              const Wanted& wanted, const JointTypes& types,
                                              std::vector<MappedColumn>& columns);

// A stated unit that contradicts the mapping asked for.
[[nodiscard]] std::optional<Problem> contradiction(const std::string& path,
                                                   const MappedMeasurements& mapped,
                                                   const JointTypes& types);

// Two columns of the header that `auto` would take for the same: commanded and actual readings, or
// nominal and measured positions. Which is meant nobody can guess.
[[nodiscard]] std::optional<Problem> ambiguity(const std::string& path,
                                               const MappedMeasurements& mapped,
                                               const Wanted& wanted, const JointTypes& types);

}  // namespace armsig::tool
