// SPDX-License-Identifier: MIT
// Measurements (CSV): joint readings with the target's position, or with its ranges to the
// receivers; streamed, so that a million rows need no more memory than ten (docs/formats.md).
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/signature.hpp"
#include "firmware/formats/csv_table.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/text_file.hpp"

namespace armsig::tool {

inline constexpr std::size_t kMaxRangeColumns = 16;

// One row, in SI; S is the sensor frame.
struct MeasurementRow {
  std::size_t line = 0;   // of the file, from 1
  std::size_t sweep = 0;  // the joint swept, from 1; 0: any joint may have moved
  int target = 0;
  JointVector q;
  std::optional<Vector3> p_S;  // nothing where missing, and where the file gives ranges
  FixedVector<std::optional<double>, kMaxRangeColumns> ranges_m;  // a receiver each; may be missing
  std::optional<double> air_c;
  std::optional<double> sigma_m;  // 1 sigma per axis
};

// Reads a file row by row:
//   ARMSIG_TRY(reader, MeasurementReader::open(path, types));
//   for (MeasurementRow row;;) { ARMSIG_TRY(more, reader.next(row)); if (!more) break; ... }
class MeasurementReader {
 public:
  // Reads the header.
  [[nodiscard]] static Read<MeasurementReader> open(const std::string& path,
                                                    const JointTypes& types);
  // `first_line`: the number of the text's first line.
  [[nodiscard]] static Read<MeasurementReader> over(std::string_view text, std::string_view file,
                                                    const JointTypes& types,
                                                    std::size_t first_line = 1);

  // Fills `row`, or gives false at the end of the file. Refuses a file without any row, and one
  // with more than kMaxTargets targets.
  [[nodiscard]] Read<bool> next(MeasurementRow& row);

  // A problem with the reading of `joint` (from 0) in the row that was read last.
  [[nodiscard]] Problem problem_of_reading(std::size_t joint, std::string what) const;

  [[nodiscard]] std::size_t receiver_count() const { return receivers_; }  // 0: positions
  [[nodiscard]] bool has_air() const { return table_.has(air_); }
  [[nodiscard]] bool has_sigma() const { return table_.has(sigma_); }
  // The share of the file that has been read; nothing for a pipe.
  [[nodiscard]] std::optional<double> progress() const { return table_.progress(); }

 private:
  MeasurementReader(CsvTable table, std::size_t joints);
  [[nodiscard]] static Read<MeasurementReader> over(LineReader lines, const JointTypes& types);
  [[nodiscard]] Read<void> check_columns();
  [[nodiscard]] Read<void> read_target(MeasurementRow& row) const;
  [[nodiscard]] Read<void> count_target(int number);

  CsvTable table_;
  std::size_t joints_;
  std::size_t receivers_ = 0;
  std::size_t rows_ = 0;
  FixedVector<int, kMaxTargets> targets_;  // numbers seen
  // Indices of the quantities in the table; sweep and target are 0 and 1.
  std::size_t q_ = 2;
  std::size_t x_;
  std::size_t air_;
  std::size_t sigma_;
  std::size_t r_;
};

// Gives every row of `path` to `take`, which may stop with a problem of its own (it has row.line to
// blame). Returns the number of rows.
[[nodiscard]] Read<std::size_t> read_measurements(
    const std::string& path, const JointTypes& types,
    const std::function<Read<void>(const MeasurementRow&)>& take);

}  // namespace armsig::tool
