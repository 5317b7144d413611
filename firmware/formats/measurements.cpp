// SPDX-License-Identifier: MIT
#include "firmware/formats/measurements.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kSweep = 0;
constexpr std::size_t kTarget = 1;

std::vector<Quantity> quantities_for(const JointTypes& types) {
  std::vector<Quantity> quantities{{"sweep", Dimension::kInteger}, {"target", Dimension::kInteger}};
  for (Quantity& joint : joint_quantities(types)) quantities.push_back(std::move(joint));
  for (const char* axis : {"x", "y", "z"}) {
    quantities.push_back({axis, Dimension::kLength, false, true});
  }
  quantities.push_back({"air", Dimension::kTemperature, false, true});
  quantities.push_back({"sigma", Dimension::kLength, false, true});
  for (std::size_t j = 1; j <= kMaxRangeColumns; ++j) {
    quantities.push_back({fmt::format("r{}", j), Dimension::kLength, false, true});
  }
  return quantities;
}

// Where no column is like one of ours the table is another program's, and a list of ours no help.
Problem with_cure(Problem problem) {
  if (!problem.what.starts_with("unknown column") || !problem.expected.contains(" out of ")) {
    return problem;
  }
  problem.expected =
      "--columns auto, which reads tables of other programs, or columns like "
      "sweep,target,q1_deg,x_mm,y_mm,z_mm";
  return problem;
}

std::optional<double> present(double value) {
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

}  // namespace

MeasurementReader::MeasurementReader(CsvTable table, std::size_t joints)
    : table_(std::move(table)),
      joints_(joints),
      x_(q_ + joints),
      air_(x_ + 3),
      sigma_(air_ + 1),
      r_(sigma_ + 1) {}

Read<MeasurementReader> MeasurementReader::over(LineReader lines, const JointTypes& types) {
  auto table = CsvTable::open(std::move(lines), quantities_for(types));
  if (!table) return std::unexpected(with_cure(std::move(table).error()));
  MeasurementReader reader(*std::move(table), types.size());
  if (auto columns = reader.check_columns(); !columns) {
    return std::unexpected(std::move(columns).error());
  }
  return reader;
}

Read<MeasurementReader> MeasurementReader::over(std::string_view text, std::string_view file,
                                                const JointTypes& types, std::size_t first_line) {
  return over(LineReader::over(text, file, first_line), types);
}

Read<MeasurementReader> MeasurementReader::open(const std::string& path, const JointTypes& types) {
  ARMSIG_TRY(lines, LineReader::open(path));
  return over(std::move(lines), types);
}

// Either all of x, y, z or receivers r1 ... rk without a gap.
Read<void> MeasurementReader::check_columns() {
  std::size_t axes = 0;
  std::size_t missing_axis = x_;
  for (std::size_t axis = x_; axis < x_ + 3; ++axis) {
    if (table_.has(axis)) {
      ++axes;
    } else {
      missing_axis = axis;
    }
  }
  std::size_t ranges = 0;
  for (std::size_t j = 0; j < kMaxRangeColumns; ++j) {
    if (!table_.has(r_ + j)) continue;
    ++ranges;
    receivers_ = j + 1;
  }
  if (axes > 0 && ranges > 0) {
    return table_.problem("there are columns for positions (x, y, z) and for ranges (r)",
                          "one of the two");
  }
  if (axes > 0 && axes < 3) {
    const std::string axis(1, static_cast<char>('x' + (missing_axis - x_)));
    return table_.problem("there is no column for " + axis,
                          any_of(names_of(axis, Dimension::kLength)));
  }
  if (axes == 0 && ranges == 0) {
    return table_.problem("there is no column for the target",
                          "x_mm, y_mm, z_mm, or ranges r1_mm, r2_mm, ... (or _m)");
  }
  if (ranges < receivers_) {
    std::size_t gap = 0;
    while (table_.has(r_ + gap)) ++gap;
    const std::string name = fmt::format("r{}", gap + 1);
    return table_.problem("there is no column for " + name,
                          any_of(names_of(name, Dimension::kLength)));
  }
  return {};
}

Read<void> MeasurementReader::read_target(MeasurementRow& row) const {
  row.p_S.reset();
  row.ranges_m.clear();
  for (std::size_t j = 0; j < receivers_; ++j) {
    const auto range_m = present(table_.value(r_ + j));
    if (range_m && !(*range_m > 0)) {
      return table_.problem(
          r_ + j,
          fmt::format("range r{}: {} is not positive", j + 1, in_quotes(table_.field(r_ + j))),
          "a distance above 0, or nothing where the receiver heard nothing");
    }
    row.ranges_m.push_back(range_m);
  }
  if (receivers_ > 0) return {};
  const Vector3 p_S(table_.value(x_), table_.value(x_ + 1), table_.value(x_ + 2));
  const Eigen::Index missing = p_S.array().isNaN().count();
  if (missing == 0) row.p_S = p_S;
  if (missing == 1 || missing == 2) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!std::isnan(p_S[static_cast<Eigen::Index>(axis)])) continue;
      return table_.problem(
          x_ + axis, fmt::format("{} is empty, the rest of the position is not", "xyz"[axis]),
          "all of x, y and z, or none of them");
    }
  }
  return {};
}

Read<void> MeasurementReader::count_target(int number) {
  if (std::ranges::find(targets_, number) != targets_.end()) return {};
  if (targets_.full()) {
    return table_.problem(kTarget, fmt::format("target {} is one too many", number),
                          fmt::format("at most {} targets", kMaxTargets));
  }
  targets_.push_back(number);
  return {};
}

Read<bool> MeasurementReader::next(MeasurementRow& row) {
  ARMSIG_TRY(more, table_.next());
  if (!more) {
    if (rows_ > 0) return false;
    return table_.problem("the file ends after its header", "rows of measurements");
  }
  ++rows_;
  const double sweep = table_.value(kSweep);
  if (sweep < 0 || sweep > static_cast<double>(joints_)) {
    return table_.problem(kSweep, fmt::format("sweep: joint {} is outside the arm", sweep),
                          fmt::format("1 to {}, or 0 for a pose", joints_));
  }
  row.line = table_.line();
  row.sweep = static_cast<std::size_t>(sweep);
  row.target = static_cast<int>(table_.value(kTarget));
  if (auto counted = count_target(row.target); !counted) {
    return std::unexpected(std::move(counted).error());
  }
  row.q.resize(joints_);
  for (std::size_t i = 0; i < joints_; ++i) row.q[i] = table_.value(q_ + i);
  if (auto target = read_target(row); !target) return std::unexpected(std::move(target).error());
  row.air_c = present(table_.value(air_));
  row.sigma_m = present(table_.value(sigma_));
  if (row.sigma_m && !(*row.sigma_m > 0)) {
    return table_.problem(sigma_,
                          fmt::format("sigma: {} is not positive", in_quotes(table_.field(sigma_))),
                          "a standard deviation above 0, or nothing");
  }
  return true;
}

Problem MeasurementReader::problem_of_reading(std::size_t joint, std::string what) const {
  return table_.problem(q_ + joint, std::move(what), "").error();
}

Read<std::size_t> read_measurements(const std::string& path, const JointTypes& types,
                                    const std::function<Read<void>(const MeasurementRow&)>& take) {
  ARMSIG_TRY(reader, MeasurementReader::open(path, types));
  std::size_t rows = 0;
  for (MeasurementRow row;; ++rows) {
    ARMSIG_TRY(more, reader.next(row));
    if (!more) return rows;
    if (auto taken = take(row); !taken)
      return std::unexpected(in_file(path, std::move(taken)).error());
  }
}

}  // namespace armsig::tool
