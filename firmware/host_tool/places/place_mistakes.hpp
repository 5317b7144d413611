// SPDX-License-Identifier: MIT
// What goes wrong with sockets, planes and wires, found in the rows and named (docs/model.md,
// section 13).
#pragma once

#include <optional>
#include <vector>

#include "firmware/host_tool/places/place_fit.hpp"

namespace armsig::tool {

// A touch that was rejected: what it misses its place by, and the place that it fits instead.
struct RejectedTouch {
  std::size_t line = 0;
  std::size_t place = 0;
  double off_m = 0;
  std::optional<std::size_t> fits;
};
[[nodiscard]] std::vector<RejectedTouch> rejected_touches(const PlaceTask& task,
                                                          const PlaceFit& fit);

// A known length as the touches and the other lengths that are believed have it.
struct PredictedLength {
  double length_m = 0;
  double sigma_m = 0;
  double off = 0;  // known less predicted, in sigma of both
  bool believed = true;
};

// Beyond so many sigma a known length contradicts everything else.
inline constexpr double kContradictingLength = 4;

// Of every known length of `task`; `free` was fitted to the touches alone, without any. The one
// that contradicts the others most is not believed, as long as one does and another is left.
[[nodiscard]] std::vector<PredictedLength> predicted_lengths(const PlaceTask& task,
                                                             const PlaceFit& free);

// The base, or all places at once, moved between two touches.
struct BasePush {
  std::size_t line = 0;  // of the first touch after it
  double moved_m = 0;    // of the tool at the touches after it, RMS
};
// Where such a step explains the touches better than chance does, the most likely one: a turn and a
// shift of everything after it, judged by the covariance of the fit (docs/model.md, section 13).
[[nodiscard]] std::optional<BasePush> find_push(const PlaceTask& task, const PlaceFit& fit);

// The gain of a wire as all else has it: found less stated, in sigma of both; nothing for other
// instruments.
[[nodiscard]] std::optional<double> gain_off(const PlaceFit& fit, std::size_t instrument);

}  // namespace armsig::tool
