// SPDX-License-Identifier: MIT
// Keeps of the rows of a file what a diagnosis needs, in bounded memory.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/calibration/approach_direction.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/formats/sensor_file.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

class EvidenceCollector {
 public:
  EvidenceCollector(const Arm& drawing, std::optional<SensorDescription> sensor);

  // A row without a position, or with ranges that give none, is passed over.
  void add(const MeasurementRow& row);
  [[nodiscard]] const Evidence& evidence() const { return evidence_; }

 private:
  std::optional<SensorDescription> sensor_;
  JointTypes types_;
  Evidence evidence_;
  calibration::ApproachDirection approach_;
  std::array<EarlierRow, 2> earlier_ = {};
  // One of every 2^thinning_ rows is kept, chosen without a period.
  std::uint32_t thinning_ = 0;
  double phase_ = 0;
};

}  // namespace armsig::tool
