// SPDX-License-Identifier: MIT
// The rows of a log as the fit has them. Of a long log, as a tracker streams it, neighbours are
// merged (docs/refinement.md, Long logs).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/calibration/fit_row.hpp"
#include "firmware/analysis/evaluation/row_part.hpp"
#include "firmware/host_tool/refinement/fitting.hpp"

namespace armsig::tool {

// Up to so many rows, each is fitted by itself.
inline constexpr std::size_t kMostRowsUnmerged = 10'000;

// Whether neighbours of the log are merged: of more rows than that, all of them positions that
// state one sigma, or none.
[[nodiscard]] bool merges(std::span<const calibration::Observation> rows);

struct RowsToFit {
  std::vector<calibration::FitRow> rows;    // FitRow::index is their order here
  std::vector<calibration::RowPart> parts;  // of every row of the log; empty: each is a FitRow
};

// From which sides the joints came to a row, as in FitRow.
struct Sides {
  std::uint8_t sides = 0;
  std::uint8_t sided = 0;
};

// A log that merges(): `row_of(k)` is its row k as it is fitted by itself. Groups of neighbours
// become two rows or one. A group is of one target and sweep, and its joints came from the
// same sides. Its readings span a knot of the joint error map at most, and lie within a tenth of
// one of a line. Measured positions are taken relative to what the model of `start` has at their
// readings, which takes out their curvature. The two rows of a group have the readings and weights
// of a two-point Gauss rule over its readings along that line, and the values there of the line
// that fits the positions. A row further from that line than six times the scale of such distances
// stays by itself. Precondition: as many `sides` as rows.
[[nodiscard]] RowsToFit merged(std::span<const calibration::Observation> log,
                               std::span<const Sides> sides,
                               const std::function<calibration::FitRow(std::size_t)>& row_of,
                               const FitStart& start);

// Rows of one group are of one pose, so that they are left out together. Precondition:
// group_poses().
void join_groups(std::span<calibration::FitRow> rows, std::span<const calibration::RowPart> parts);

}  // namespace armsig::tool
