// SPDX-License-Identifier: MIT
// The speed of sound as the ranges themselves tell it: four receivers or more that hear one target
// tell by which factor all their ranges are too long. The factor may change from row to row, as it
// does where the air grows warm and the thermometer does not.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "firmware/formats/measurements.hpp"
#include "firmware/formats/sensor_file.hpp"

namespace armsig::tool {

// Ranges are measured (1 + excess) times too long, by a polynomial in the order of the rows.
struct RangeScale {
  std::array<double, 3> coefficients{};  // of the Legendre polynomials over the lines, -1 to 1
  std::size_t first_line = 0;
  std::size_t last_line = 0;
  // Logarithms of likelihood ratios: for one factor of all rows against none, and for one that
  // changes against that.
  double evidence = 0;
  double evidence_of_drift = 0;
  double first_air_c = 0;  // as stated; that of a usual workshop where no row states it
  double last_air_c = 0;

  [[nodiscard]] double excess(std::size_t line) const;
  [[nodiscard]] bool drifts() const;
  // By how much the air is warmer than the ranges were computed for [K].
  [[nodiscard]] double warmer_k(std::size_t line) const;
  // "the ranges of each row are too long by +0 ppm (line 2) to -5231 ppm (line 185), as in air ..."
  [[nodiscard]] std::string in_words() const;
};

// One factor for all rows, whether or not it is one: 1 + excess.
struct CommonRangeScale {
  double excess = 0;
  double sigma = 0;
};

class RangeScaleFit {
 public:
  explicit RangeScaleFit(const SensorDescription& sensor) : sensor_(sensor) {}

  // A row of the file, its ranges to be multiplied by `scale`; passed over where fewer than four
  // receivers heard the target, or where no factor makes their ranges meet.
  void add(const MeasurementRow& row, double scale);

  // Nothing of fewer than a dozen rows, and where no factor has evidence or explains them.
  [[nodiscard]] std::optional<RangeScale> result() const;

  // Nothing of fewer than a dozen rows.
  [[nodiscard]] std::optional<CommonRangeScale> common() const;

 private:
  struct RowScale {
    std::size_t line = 0;
    double excess = 0;
    double sigma = 0;
  };
  void thin();

  SensorDescription sensor_;
  std::vector<RowScale> rows_;
  std::size_t first_line_ = 0;
  std::size_t last_line_ = 0;
  std::optional<double> first_air_c_;
  std::optional<double> last_air_c_;
  // One of so many rows is kept, so that memory does not grow with the file.
  std::size_t stride_ = 1;
  std::size_t passed_ = 0;
};

}  // namespace armsig::tool
