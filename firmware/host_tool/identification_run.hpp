// SPDX-License-Identifier: MIT
// Measured rows in, arm signature out: what `armsig identify` and `armsig demo` run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/identification.hpp"
#include "core/measurement/receivers.hpp"
#include "firmware/host_tool/formats/measurements.hpp"
#include "firmware/host_tool/formats/sensor_file.hpp"
#include "firmware/host_tool/refinement_run.hpp"
#include "firmware/host_tool/sweeps.hpp"

namespace armsig::tool {

struct RowCounts {
  std::size_t rows = 0;
  std::size_t missing = 0;          // no position, or fewer than three ranges
  std::size_t inconsistent = 0;     // ranges that do not meet in a point
  std::size_t excluded_ranges = 0;  // single ranges not believed, their rows used without them
  std::size_t mixed = 0;            // rows with sweep 0, which features do not use
};

struct Identified {
  Signature signature;
  RowCounts counts;
  std::optional<double> air_celsius;  // mean over the rows that state it
  std::vector<std::string> warnings;
};

enum class KeepLog : bool { kNo, kYes };

class IdentificationRun {
 public:
  // `file` names the measurements in problems; a sensor is needed where they are ranges.
  // Precondition: the receivers of `sensor` have passed measurement::check.
  // The refinement needs the log; without it memory does not grow with the rows.
  IdentificationRun(const Arm& nominal, std::optional<SensorDescription> sensor, std::string file,
                    KeepLog keep_log = KeepLog::kNo);

  [[nodiscard]] Read<void> take(const MeasurementRow& row);
  // Where a row has its target, by its ranges where it has those; nothing where it says too little.
  [[nodiscard]] Read<std::optional<LocatedRow>> located(const MeasurementRow& row);
  // By the features of the sweeps alone.
  [[nodiscard]] Read<Identified> finish(features::Method method) const;
  // By everything measured, started from the features, or from the drawing where the sweeps give
  // none. Precondition: the log was kept.
  [[nodiscard]] Read<std::pair<Identified, RefinementOutcome>> finish_refined();

 private:
  [[nodiscard]] Read<std::optional<LocatedRow>> located_by_ranges(const MeasurementRow& row,
                                                                  LocatedRow result);
  [[nodiscard]] Read<double> range_scale(const MeasurementRow& row) const;
  [[nodiscard]] Read<Signature> signature_from(const SweptArm& swept) const;
  void add_targets_of_mixed_poses(Signature& signature) const;
  [[nodiscard]] Problem mirrored(const IdentificationFailure& failure) const;

  Arm nominal_;
  std::optional<SensorDescription> sensor_;
  std::string file_;
  SweepSet sweeps_;
  std::optional<MeasurementLog> log_;
  RowCounts counts_;
  double air_sum_c_ = 0;
  std::size_t air_count_ = 0;
};

// The receivers of a sensor description, as core wants them.
[[nodiscard]] measurement::ReceiverArray receivers_of(const SensorDescription& sensor);

}  // namespace armsig::tool
