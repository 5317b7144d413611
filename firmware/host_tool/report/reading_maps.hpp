// SPDX-License-Identifier: MIT
// What a signature says beyond geometry, for the eye: the map of each joint's reading with its
// band, and what maps and gravity are worth at the tool.
#pragma once

#include <optional>
#include <vector>

#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

struct ReadingMapPoint {
  double reading = 0;  // rad or m
  double map = 0;      // what the joint turns or slides beyond it
  double sigma = 0;    // 1 sigma
  bool covered = false;
};

struct ReadingMapPicture {
  std::size_t joint = 0;
  JointType type = JointType::kRevolute;
  JointLimits covered;  // readings that were measured; the joint limits where that is not known
  // What the tool moves by, RMS over the readings covered, when the joint moves by 1 rad or m.
  double tool_m_per_unit = 0;
  double largest = 0;     // of the map, over the readings covered
  double tool_rms_m = 0;  // what the map moves the tool by, over the readings covered
  std::vector<ReadingMapPoint> points;
};

struct ReadingMaps {
  std::vector<ReadingMapPicture> joints;
  std::size_t gravity_terms = 0;
  // What the tool is moved by over the readings covered, RMS and at most.
  double gravity_rms_m = 0;
  double gravity_largest_m = 0;
  double maps_rms_m = 0;
};

// Nothing of a record without gravity and maps.
[[nodiscard]] std::optional<ReadingMaps> reading_maps(const SignatureRecord& record);

}  // namespace armsig::tool
