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
#include "firmware/host_tool/reading/ranging.hpp"

namespace armsig::tool {

class RangeHealth {
 public:
  explicit RangeHealth(std::optional<SensorDescription> sensor) : sensor_(std::move(sensor)) {}

  // A row of the file, its ranges to be multiplied by `scale`.
  void add(const MeasurementRow& row, double scale);

  // Where fewer than half of the rows with ranges give a position: why, and the slip with which
  // most of them would. Nothing otherwise.
  [[nodiscard]] std::optional<Problem> problem(const std::string& file) const;

 private:
  struct Kept {
    MeasurementRow row;
    double scale = 1;
  };
  struct Slip {
    std::string words;
    std::string mend;
  };
  [[nodiscard]] std::size_t located_by(const SensorDescription& sensor, double factor) const;
  [[nodiscard]] std::optional<Slip> likeliest_slip() const;
  [[nodiscard]] std::string never_heard() const;

  std::optional<SensorDescription> sensor_;
  std::size_t rows_ = 0;  // with a range at least
  std::map<Error, std::size_t> failures_;
  std::array<std::size_t, kMaxReceivers> heard_{};
  std::vector<Kept> sample_;  // the first rows that failed
};

}  // namespace armsig::tool
