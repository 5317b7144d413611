// SPDX-License-Identifier: MIT
#include "firmware/formats/foreign_mapping.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "firmware/formats/foreign_header.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {

std::vector<std::string> fields_of(std::string_view line, char separator) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == separator && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  for (std::string& field : fields) field = std::string(trimmed(field));
  return fields;
}

Read<Wanted> wanted_of(std::string_view mapping) {
  Wanted wanted;
  for (const std::string& entry : fields_of(mapping, ',')) {
    const std::size_t equals = entry.find('=');
    if (entry == "auto") {
      wanted.automatic = true;
    } else if (equals != std::string::npos && equals > 0 && equals + 1 < entry.size()) {
      wanted.entries.push_back({std::string(trimmed(entry.substr(0, equals))),
                                std::string(trimmed(entry.substr(equals + 1)))});
    } else {
      return std::unexpected(Problem{"--columns", 0, 0, in_quotes(entry) + " is no mapping",
                                     "auto, x_mm=THEIR NAME, or target=#1 for every row"});
    }
  }
  return wanted;
}

std::optional<Places> places_in(const std::vector<std::string>& header, const Wanted& wanted,
                                const JointTypes& types, std::vector<MappedColumn>& columns) {
  columns = wanted.entries;
  Places places;
  for (const MappedColumn& entry : wanted.entries) {
    if (entry.theirs.starts_with('#')) {
      places.emplace_back();
      continue;
    }
    const auto place = std::ranges::find(header, entry.theirs);
    if (place == header.end()) return std::nullopt;
    places.emplace_back(static_cast<std::size_t>(place - header.begin()));
  }
  if (!wanted.automatic) return places;
  std::size_t found = 0;
  for (std::size_t k = 0; k < header.size(); ++k) {
    if (std::ranges::find(places, k) != places.end()) continue;
    const auto ours = our_name_of(header[k], types);
    if (!ours) continue;
    const auto same = [&](const MappedColumn& column) {
      return quantity_of(column.ours) == quantity_of(*ours);
    };
    if (std::ranges::any_of(columns, same)) continue;
    columns.push_back({*ours, header[k]});
    places.emplace_back(k);
    ++found;
  }
  // A table of an arm has at least its joints and a position.
  if (columns.size() < types.size() + 3 || (found == 0 && wanted.entries.empty())) {
    return std::nullopt;
  }
  return places;
}

std::optional<Problem> contradiction(const std::string& path, const MappedMeasurements& mapped,
                                     const JointTypes& types) {
  for (const MappedColumn& column : mapped.columns) {
    const auto stated = our_name_of(column.theirs, types);
    if (!stated || *stated == column.ours || quantity_of(*stated) != quantity_of(column.ours)) {
      continue;
    }
    return Problem{path, static_cast<int>(mapped.header_line), 0,
                   fmt::format("{} is to come from {}", column.ours, in_quotes(column.theirs)),
                   *stated};
  }
  return std::nullopt;
}

std::optional<Problem> ambiguity(const std::string& path, const MappedMeasurements& mapped,
                                 const Wanted& wanted, const JointTypes& types) {
  for (std::size_t c = wanted.entries.size(); c < mapped.columns.size(); ++c) {
    const MappedColumn& taken = mapped.columns[c];
    for (const std::string& theirs : mapped.ignored) {
      const auto ours = our_name_of(theirs, types);
      if (!ours || quantity_of(*ours) != quantity_of(taken.ours)) continue;
      return Problem{path, static_cast<int>(mapped.header_line), 0,
                     fmt::format("{} may come from {} or from {}", quantity_of(taken.ours),
                                 in_quotes(taken.theirs), in_quotes(theirs)),
                     theirs == taken.theirs ? std::string("another name for one of the two columns")
                                            : fmt::format("--columns auto,{}={}, or {}={}",
                                                          taken.ours, taken.theirs, *ours, theirs)};
    }
  }
  return std::nullopt;
}

}  // namespace armsig::tool
