// SPDX-License-Identifier: MIT
// Writes measurements (CSV) row by row, in degrees and millimetres with 17 digits.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "firmware/formats/measurements.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/units.hpp"

namespace armsig::tool {

// The columns of a file.
struct MeasurementLayout {
  JointTypes types;
  std::size_t receivers = 0;  // ranges r1 ... rk; 0: positions x, y, z
  bool air = false;
  bool sigma = false;
  // For the head of the file; may have several lines. (Without {}, g++ calls it missing where it is
  // left out.)
  std::string_view comment = {};  // NOLINT(readability-redundant-member-init)
};

class MeasurementWriter {
 public:
  [[nodiscard]] static Read<MeasurementWriter> create(const std::string& path,
                                                      const MeasurementLayout& layout);

  // What the layout has and the row has not is left empty. The row must have a reading for every
  // joint, and no more ranges than receivers.
  void write(const MeasurementRow& row);

  // The file appears now. A failure to write any row is reported here, and a row with a number
  // that is not finite: no file is written then.
  [[nodiscard]] Read<void> commit();

 private:
  MeasurementWriter(AtomicFile file, std::string path, const MeasurementLayout& layout);
  void append(const Unit& unit, double value_si);

  AtomicFile file_;
  std::string path_;
  JointTypes types_;
  std::size_t receivers_;
  bool air_;
  bool sigma_;
  bool all_finite_ = true;
  std::string line_;
};

}  // namespace armsig::tool
