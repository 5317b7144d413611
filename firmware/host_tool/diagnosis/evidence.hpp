// SPDX-License-Identifier: MIT
// What a diagnosis looks at: an arm as drawn, and the rows that were measured of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::tool {

// Multiples of it modulo 1 are spread evenly, without a period.
inline constexpr double kGoldenShare = 0.6180339887498949;

// Precondition: not empty.
[[nodiscard]] double median_of(std::vector<double> values);
// Rows that miss by less were computed, not measured: what is left of them is rounding and the
// curvature of what was linearised, and accuses nothing.
inline constexpr double kComputed_m = 1e-6;
// Rows whose squares are summed at once: three rows of a matrix at a time leave a processor
// waiting.
inline constexpr std::ptrdiff_t kRowsABatch = 64;

// 1 sigma per axis of errors in space of these lengths, by their median. Precondition: not empty.
[[nodiscard]] double sigma_by_median(std::vector<double> lengths);
// No measurement is believed to be better [m].
inline constexpr double kLeastSigma_m = 2e-6;
// Huber's weight of an error of this length, over the variance.
[[nodiscard]] double huber_weight(double length_m, double sigma_m);
// Beyond it an error in space is a blunder among errors of these lengths: so many times their
// median, which is 5.9 sigma. Precondition: not empty.
[[nodiscard]] double blunder_gate_m(std::vector<double> lengths_m);
// RMS of the smallest seven tenths of lengths. Precondition: not empty.
[[nodiscard]] double trimmed_rms(std::vector<double> lengths);

// Configurations over which an error of the tool is judged, as uncertainty::predicted_rms() does.
inline constexpr int kJudgedConfigurations = 200;
// Precondition: not empty.
[[nodiscard]] double rms_length(const std::vector<Vector3>& vectors);

// What of a row is of use to one that came after it.
struct EarlierRow {
  std::size_t sweep = 0;
  int target = 0;
  JointVector q;  // as read; empty: there was none
  Vector3 p_S = Vector3::Zero();
};

struct EvidenceRow {
  std::size_t line = 0;   // of the file, from 1
  std::size_t sweep = 0;  // joint number from 1; 0: any joint may have moved
  int target = 0;
  JointVector q;  // as read: couplings not applied; radians or metres
  Vector3 p_S = Vector3::Zero();
  // Of the position, by the sigma that the row states for it or for its ranges; zero where it
  // states none.
  Matrix3 covariance_m2 = Matrix3::Zero();
  bool moved = false;  // measured from the second of two places of the sensor
  // From which side each joint came, as calibration::ApproachDirection tells it.
  std::uint8_t sides = 0;
  std::uint8_t sided = 0;
  // The row before it in the file, and the one before that; also where those were thinned out.
  std::array<EarlierRow, 2> earlier = {};

  // 1 sigma per axis as stated (root mean square of the three); 0 where nothing was stated.
  [[nodiscard]] double sigma_m() const;
};

struct Evidence {
  Arm arm;
  std::vector<EvidenceRow> rows;  // in the order of the file
  bool located = false;           // positions and sigmas were computed from ranges, not stated
  // Factors that are not known, and are found with the rest: of all positions, and of the readings
  // of turning joints (a bit a joint, one factor for all of them).
  bool free_scale = false;
  std::uint32_t free_gain = 0;
};

// Every target number seen, with the link that it is on: the last for rows with sweep 0, otherwise
// that of the outermost joint that sweeps it.
struct SeenTarget {
  int number = 0;
  std::size_t link = 0;
};
[[nodiscard]] std::vector<SeenTarget> seen_targets(const Evidence& evidence);

// No row shows a gear or a coupling of a joint that stood still.
[[nodiscard]] bool has_moved(const Evidence& evidence, std::size_t joint);

// At most `most` of the rows, spread over all of them.
[[nodiscard]] Evidence thinned(const Evidence& evidence, std::size_t most);

// 1 sigma per axis that the rows state (their median), 0 where fewer than half state any.
[[nodiscard]] double stated_sigma_m(const Evidence& evidence);

// 1 sigma per axis that the sweeps themselves show, by whichever is smaller: what is left about
// the path of each sweep's target by its joint reading, or by the order of the rows. 0 without a
// sweep of eight rows.
[[nodiscard]] double noise_of_sweeps_m(const Evidence& evidence);

// The noise that the sweeps show, shared out to any row as the rows state their sigmas: a position
// from ranges is not as good everywhere.
class RowNoise {
 public:
  explicit RowNoise(const Evidence& evidence);

  // Expected square of the length of the error of a row's position [m^2]; 0 where no sweep tells.
  [[nodiscard]] double mean_square(const EvidenceRow& row) const;

 private:
  double of_sweeps_m_ = 0;  // 1 sigma per axis
  double over_stated_ = 0;  // that over what the rows of the sweeps state; 0 where they state none
};

}  // namespace armsig::tool
