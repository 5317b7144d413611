// SPDX-License-Identifier: MIT
// What changed while the arm was measured: at once from one row on, or slowly from the first row to
// the last; or what was wrong all along: a sensor with axes of different scale, positions that were
// taken before the arm had come to rest. A score test: the residuals of an arm that stays as it is,
// against what each change would make of them, all that an unchanging arm could do about it taken
// out.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host_tool/diagnosis/near_fit.hpp"
#include "firmware/host_tool/diagnosis/unchanging_arm.hpp"

namespace armsig::tool {

struct Change {
  // kLengths: of the arm, from its base; kSight: all that is seen, from the sensor's origin.
  enum class Of {
    kSensor,
    kTarget,
    kSensorAndTarget,
    kZero,
    kZeros,
    kLink,
    kGear,
    kLoad,
    kLengths,
    kSight,
    kStrain,
    kLag,
  };
  Of of = Of::kSensor;
  std::size_t index = 0;       // of the joint, from 0, or the number of the target
  bool slow = false;           // grows from the first row to the last
  std::size_t first_line = 0;  // from which on
  std::size_t last_line = 0;
  // Turns and shifts, the number of each zero, a share of what was read or seen, or strains.
  Eigen::VectorXd size;
  Eigen::VectorXd sigma;        // of each of these
  double shift_m = 0;           // by which the rows are moved in the end, RMS
  std::vector<double> parts_m;  // the same by the sensor and by the target, or by each zero
  double before_m = 0;          // what an unchanging arm misses the rows by, RMS
  double after_m = 0;           // and what is left with the change
  double evidence = 0;          // logarithm of the ratio of likelihoods, the number tried counted
  // By which the unchanging arm is off from what was there before it, and in the end: unknowns of
  // the chain, then of the UnchangingArm beyond it.
  Eigen::VectorXd before_it;
  Eigen::VectorXd after_it;

  [[nodiscard]] double explains() const { return before_m / after_m; }
};

// Strains without growth, which is of all lengths: xx, yy, xy, xz, yz.
inline constexpr int kStrains = 5;
using Strains = Eigen::Matrix<double, kStrains, 1>;
[[nodiscard]] Matrix3 strain_of(const Strains& e);

// The change with the most evidence, for an arm like `chain`. `residuals_S`: of the arm that was
// found, a row each. Nothing for fewer than 24 rows, or where no change has evidence.
[[nodiscard]] std::optional<Change> likeliest_change(const Evidence& evidence,
                                                     const DeviatingChain& chain,
                                                     const std::vector<Vector3>& residuals_S,
                                                     Backlash backlash);

// How far a target on the last link is off if there was this change and nobody knew of it: of the
// unchanging arm from the one before it or the one after it, whichever is farther; at
// work_configuration()s 1 to kJudgedConfigurations. Empty without such a target.
[[nodiscard]] std::vector<Vector3> moved_by_change(const Change& change, const Evidence& evidence,
                                                   const DeviatingChain& chain);

// "from line 42 on target 1 is another point, 1.02 mm away", and what to do about it.
[[nodiscard]] std::string in_words(const Change& change, const Arm& arm);
[[nodiscard]] std::string mend_of(const Change& change);

}  // namespace armsig::tool
