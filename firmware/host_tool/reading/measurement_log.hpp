// SPDX-License-Identifier: MIT
// Everything measured, kept: what the refinement goes through several times.
#pragma once

#include <map>
#include <vector>

#include "core/calibration/refined.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/formats/sensor_file.hpp"

namespace armsig::tool {

struct DisbelievedReceiver {
  std::size_t number = 0;  // from 1
  std::size_t rejected = 0;
  std::size_t ranges = 0;  // rejected or not
};

class MeasurementLog {
 public:
  // `scale` multiplies the row's ranges (speed of sound). A row with neither position nor range is
  // not kept. Precondition: range_scale() has accepted the row.
  void add(const MeasurementRow& row, const std::optional<SensorDescription>& sensor, double scale);

  // Where the ranges of the row added last put its target: a start for what has no other.
  void add_located(const Vector3& p_S);

  // Observations name their target by its number until `index_targets` puts in the index into
  // `targets`. Returns the number of a target that is not among them, if any.
  [[nodiscard]] std::optional<int> index_targets(const FixedVector<Target, kMaxTargets>& targets);

  // Every target measured, on the link that it is fixed to: the last for rows with sweep 0,
  // otherwise that of the outermost joint that sweeps it. Positions are not known.
  [[nodiscard]] std::vector<Target> targets(std::size_t joints) const;

  // The first row that gives the position of a target, measured or located; null where none does.
  [[nodiscard]] const calibration::Observation* first_position(int target) const;

  // Positions to start from: those located where the log holds ranges, otherwise the log itself.
  [[nodiscard]] const std::vector<calibration::Observation>& positions() const {
    return located_.empty() ? observations_ : located_;
  }

  // No row holds ranges.
  [[nodiscard]] bool positions_only() const { return located_.empty() && !ranges_; }

  [[nodiscard]] std::vector<calibration::Observation>& observations() { return observations_; }
  [[nodiscard]] const std::vector<calibration::Observation>& observations() const {
    return observations_;
  }
  // The lines whose observations were rejected, each once.
  [[nodiscard]] std::vector<std::size_t> rejected_lines(
      const std::vector<calibration::RowOutcome>& outcomes) const;
  // The receivers of which most ranges were rejected.
  [[nodiscard]] std::vector<DisbelievedReceiver> disbelieved_receivers(
      const std::vector<calibration::RowOutcome>& outcomes) const;
  // Line of the file that observation k came from.
  [[nodiscard]] std::size_t line(std::size_t k) const { return lines_[k]; }

 private:
  std::vector<calibration::Observation> observations_;
  std::vector<std::size_t> lines_;
  std::vector<int> target_numbers_;
  std::vector<calibration::Observation> located_;
  std::vector<int> located_numbers_;
  bool ranges_ = false;
  std::map<int, std::size_t> outermost_sweep_;  // 0: seen in a row with sweep 0
};

}  // namespace armsig::tool
