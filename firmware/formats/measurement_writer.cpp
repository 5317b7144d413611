// SPDX-License-Identifier: MIT
#include "firmware/formats/measurement_writer.hpp"

#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "core/base/check.hpp"
#include "core/base/error.hpp"
#include "firmware/formats/csv_text.hpp"

namespace armsig::tool {
namespace {

std::string header_of(const MeasurementLayout& layout) {
  std::string header = "sweep,target," + joint_header(layout.types);
  if (layout.receivers == 0) header += ",x_mm,y_mm,z_mm";
  for (std::size_t j = 1; j <= layout.receivers; ++j) header += fmt::format(",r{}_mm", j);
  if (layout.air) header += ",air_c";
  if (layout.sigma) header += ",sigma_mm";
  return header + "\n";
}

}  // namespace

MeasurementWriter::MeasurementWriter(AtomicFile file, std::string path,
                                     const MeasurementLayout& layout)
    : file_(std::move(file)),
      path_(std::move(path)),
      types_(layout.types),
      receivers_(layout.receivers),
      air_(layout.air),
      sigma_(layout.sigma) {}

Read<MeasurementWriter> MeasurementWriter::create(const std::string& path,
                                                  const MeasurementLayout& layout) {
  ARMSIG_CHECK(layout.receivers <= kMaxRangeColumns);
  ARMSIG_TRY(file, AtomicFile::create(path));
  file.write(comment_text(layout.comment));
  file.write(header_of(layout));
  return MeasurementWriter(std::move(file), path, layout);
}

void MeasurementWriter::append(const Unit& unit, double value_si) {
  all_finite_ = all_finite_ && std::isfinite(value_si);
  line_ += ',';
  line_ += text_in(unit, value_si);
}

void MeasurementWriter::write(const MeasurementRow& row) {
  ARMSIG_CHECK(row.q.size() == types_.size());
  ARMSIG_CHECK(row.ranges_m.size() <= receivers_);
  line_.clear();
  fmt::format_to(std::back_inserter(line_), "{},{}", row.sweep, row.target);
  for (std::size_t i = 0; i < types_.size(); ++i) append(unit_of(types_[i]), row.q[i]);
  if (receivers_ == 0) {
    if (row.p_S) {
      for (const double coordinate_m : *row.p_S) append(kMillimetre, coordinate_m);
    } else {
      line_ += ",,,";
    }
  }
  const auto append_optional = [&](const Unit& unit, const std::optional<double>& value_si) {
    if (value_si) {
      append(unit, *value_si);
    } else {
      line_ += ',';
    }
  };
  for (std::size_t j = 0; j < receivers_; ++j) {
    append_optional(kMillimetre, j < row.ranges_m.size() ? row.ranges_m[j] : std::nullopt);
  }
  if (air_) append_optional({"c", 1, 1}, row.air_c);
  if (sigma_) append_optional(kMillimetre, row.sigma_m);
  line_ += '\n';
  file_.write(line_);
}

Read<void> MeasurementWriter::commit() {
  if (!all_finite_) {
    return std::unexpected(
        Problem{path_, 0, 0, "a measurement to be written is not finite", "finite numbers"});
  }
  return file_.commit();
}

}  // namespace armsig::tool
