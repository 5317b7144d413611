// SPDX-License-Identifier: MIT
// Why ranges to receivers give hardly any position: the sensor description is not the one of the
// sensor that measured. With as many unknowns as receivers nobody can tell which of them is wrong,
// so the slips that people make are tried in turn.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "firmware/host_tool/reading/range_scale.hpp"
#include "firmware/host_tool/reading/ranging.hpp"

namespace armsig::tool {

// What to do where the air has grown warm, or cold, while it was measured.
inline constexpr const char* kCureOfDrift =
    "air_c of every row where the sound goes, with calibrated_at_c of the sensor; or the sensor's "
    "own reference path";

class RangeHealth {
 public:
  explicit RangeHealth(std::optional<SensorDescription> sensor) : sensor_(std::move(sensor)) {
    if (sensor_) scale_.emplace(*sensor_);
  }

  // A row of the file, its ranges to be multiplied by `scale`.
  void add(const MeasurementRow& row, double scale);

  // Where fewer than half of the rows with ranges give a position: why, and the slip with which
  // most of them would. Nothing otherwise.
  [[nodiscard]] std::optional<Problem> problem(const std::string& file) const;

  // Where the ranges of most rows do not meet in a point: what no method may go on with, also one
  // that takes each range by itself. Nothing otherwise.
  [[nodiscard]] std::optional<Problem> contradiction(const std::string& file) const;

  // A factor on all ranges that changes from row to row, also where most rows meet in a point.
  [[nodiscard]] std::optional<RangeScale> drift() const;

  // Whether the ranges themselves tell that they are not `factor` times too long.
  [[nodiscard]] bool rules_out(double factor) const;

 private:
  struct Kept {
    MeasurementRow row;
    double scale = 1;
  };
  struct Slip {
    std::string words;
    std::string mend;
  };
  [[nodiscard]] Problem problem_of(Error why, std::size_t failed, const std::string& file) const;
  [[nodiscard]] std::size_t located_by(const SensorDescription& sensor, double factor) const;
  [[nodiscard]] std::size_t located_by(const RangeScale& scale) const;
  [[nodiscard]] std::optional<Slip> likeliest_slip() const;
  [[nodiscard]] std::string never_heard() const;

  std::optional<SensorDescription> sensor_;
  std::optional<RangeScaleFit> scale_;
  std::size_t rows_ = 0;  // with a range at least
  std::map<Error, std::size_t> failures_;
  std::array<std::size_t, kMaxReceivers> heard_{};
  std::vector<Kept> sample_;  // the first rows whose ranges do not meet
};

}  // namespace armsig::tool
