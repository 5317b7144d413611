// SPDX-License-Identifier: MIT
// The one way in for measurements at a workstation: every command reads its rows here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/formats/foreign_columns.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/formats/origin.hpp"
#include "firmware/formats/sensor_file.hpp"

namespace armsig::tool {

// What a person says of the rows on the command line.
struct RowSource {
  std::string measurements;  // the file
  std::string columns;       // mapping of the columns of other software; empty: they are ours
  std::string sensor;        // sensor description, for ranges to receivers; empty: none
};

struct OpenRows {
  RowSource source;
  Arm drawing;  // of the arm that was measured
  JointTypes types;
  std::optional<SensorDescription> sensor;
  std::optional<std::uint32_t> sensor_crc32;  // of the content of its file
  std::optional<MappedTable> mapped;          // by `source.columns`
};

// Reads the sensor description and maps the columns, and says on standard error which of theirs
// became which of ours. Refuses receivers that cannot locate a target,
// and what the two readers refuse.
[[nodiscard]] Read<OpenRows> open_rows(const RowSource& source, const Arm& drawing,
                                       const NamedJoints& joints);

// A reader of them from the first row on. Refuses what the reader of measurements refuses.
[[nodiscard]] Read<MeasurementReader> open_reader(const OpenRows& rows);

// A row, and what its ranges are to be multiplied by for the air in which they were measured.
using TakeRow = std::function<Read<void>(const MeasurementRow& row, double scale)>;

struct RowReading {
  const char* progress = nullptr;  // what is said of progress; null: nothing
  std::size_t remembered;          // a copy is found so many rows back
};

struct RowsRead {
  std::size_t rows = 0;               // given to `take`
  std::size_t copies = 0;             // to the last digit, not given
  std::vector<std::uint64_t> hashes;  // a set, of the rows whose target was seen
};

// Gives every row but copies to `take`, which may stop with a problem of its own. Refuses what the
// reader of measurements refuses, ranges without the sensor or the air that they need, and a file
// with a reading that its joint cannot have (beyond_limits.hpp), none of whose rows is given.
[[nodiscard]] Read<RowsRead> read_rows(const OpenRows& rows, const RowReading& reading,
                                       const TakeRow& take);

// A sensor description whose receivers can locate a target, or what is wrong with it.
[[nodiscard]] Read<SensorDescription> read_checked_sensor(const std::string& path);

// What a signature states of the rows that it was found from, but for `arm` and `options`;
// `fitted`: the hashes of those that the method used, in any order.
[[nodiscard]] Origin origin_of(const OpenRows& rows, const RowsRead& read,
                               std::vector<std::uint64_t> fitted);

// How rows go together with those that a signature was found from.
struct OriginMatch {
  bool stated = false;       // the signature says where it comes from
  bool same_rows = false;    // these rows, all of them and no others
  bool same_sensor = false;  // by the sensor description of then, or by none then and now
  std::size_t rows = 0;      // different ones
  std::size_t told = 0;      // of them: whether they were fitted is known
  std::size_t fitted = 0;    // of those

  [[nodiscard]] bool is_origin() const { return same_rows && same_sensor; }
  [[nodiscard]] bool all_fitted() const { return told > 0 && fitted == told; }
};
[[nodiscard]] OriginMatch match_of(const std::optional<Origin>& origin, const OpenRows& rows,
                                   const RowsRead& read);

// "12 of the 30 rows"; of a sample "12 of 30 rows of which it is known".
[[nodiscard]] std::string fitted_in_words(const OriginMatch& match);

}  // namespace armsig::tool
