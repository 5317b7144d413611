// SPDX-License-Identifier: MIT
// Measured rows in, arm signature out: what `armsig identify` and `armsig demo` run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/identification.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/formats/sensor_file.hpp"
#include "firmware/host_tool/identification/feature_validation.hpp"
#include "firmware/host_tool/reading/sweeps.hpp"
#include "firmware/host_tool/refinement/refinement_run.hpp"

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

// What the rows are taken for.
enum class Purpose : std::uint8_t {
  kFeatures,
  kValidatedFeatures,  // features, and how well they predict rows left out
  kRefinement,         // keeps every row
};

class IdentificationRun {
 public:
  // `file` names the measurements in problems; a sensor is needed where they are ranges.
  // Precondition: the receivers of `sensor` have passed measurement::check.
  IdentificationRun(const Arm& nominal, std::optional<SensorDescription> sensor, std::string file,
                    features::Method method, Purpose purpose = Purpose::kFeatures);

  [[nodiscard]] Read<void> take(const MeasurementRow& row);
  // By the features of the sweeps alone.
  [[nodiscard]] Read<Identified> finish() const;
  // By everything measured, started from the features, or from the drawing where the sweeps give
  // none. Purpose kRefinement, by the encoder's method.
  [[nodiscard]] Read<std::pair<Identified, RefinementOutcome>> finish_refined(
      const FurtherUnknowns& further);

  // Purpose kValidatedFeatures: after all rows were taken, settle_validation(), then
  // every row again into score(). False where rows are too few to leave some of them out.
  [[nodiscard]] bool settle_validation();
  void score(const MeasurementRow& row);
  [[nodiscard]] CrossValidation validation() const { return validation_->result(); }

 private:
  // Nothing, and counted, where the row gives no position.
  [[nodiscard]] std::optional<LocatedRow> located(const MeasurementRow& row, double scale,
                                                  RowCounts& counts) const;
  [[nodiscard]] Read<Signature> signature_from(const SweptArm& swept) const;
  void add_targets_of_mixed_poses(Signature& signature) const;
  [[nodiscard]] Problem mirrored(const IdentificationFailure& failure) const;

  Arm nominal_;
  std::optional<SensorDescription> sensor_;
  std::string file_;
  SweepSet sweeps_;
  std::optional<MeasurementLog> log_;
  std::optional<FeatureValidation> validation_;
  RowCounts counts_;
  double air_sum_c_ = 0;
  std::size_t air_count_ = 0;
};

}  // namespace armsig::tool
