// SPDX-License-Identifier: MIT
// Touches of places as a fit wants them: what was read, and what is unknown.
#pragma once

#include <vector>

#include "core/base/arm.hpp"
#include "core/calibration/engine_data.hpp"
#include "core/calibration/model.hpp"
#include "firmware/formats/touches.hpp"
#include "firmware/host_tool/places/instrument_row.hpp"

namespace armsig::tool {

struct TouchRow {
  std::size_t line = 0;
  std::size_t place = 0;
  JointVector q;
  double length_m = 0;
};

struct SocketLength {
  std::size_t from = 0;  // places
  std::size_t to = 0;
  double length_m = 0;
  double sigma_m = 0;
};

struct PlaceTask {
  Arm nominal;
  Vector3 tool_F = Vector3::Zero();  // nominal
  std::vector<Instrument> instruments;
  std::vector<TouchedPlace> places;  // names and kinds, in the order of their first touch
  std::vector<TouchRow> touches;
  std::vector<SocketLength> lengths;  // those whose ends were both touched

  [[nodiscard]] bool has_wires() const;
  // Whether any place that was touched is of this instrument.
  [[nodiscard]] bool uses(std::size_t instrument) const;
  // Sockets that known lengths join are one placement, every other place is one of its own: the
  // placement of every place, numbered from 0.
  [[nodiscard]] std::vector<std::size_t> placements() const;
};

[[nodiscard]] PlaceTask place_task(const Arm& nominal, const InstrumentDescription& description,
                                   const std::vector<Touch>& touches);

// All unknowns as they stand. The base is the nominal one: its frame is that of the places.
struct PlaceState {
  calibration::ArmModel arm;
  calibration::ModelTarget tool;
  std::vector<TouchedPlace> places;
  std::vector<WireScale> scales;  // an instrument each

  // The tool at these readings.
  [[nodiscard]] Vector3 tool_at(const JointVector& q) const;
};

// The nominal arm with its gravity terms at zero, the nominal tool, places at the origin.
[[nodiscard]] PlaceState nominal_state(const PlaceTask& task);

// Tool and places by the nominal arm, from nothing: sockets and tool from one linear robust fit,
// planes by the least median of triples of touches, anchors from a linear fit of the squares.
void find_places(const PlaceTask& task, PlaceState& state);

}  // namespace armsig::tool
