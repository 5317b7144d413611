// SPDX-License-Identifier: MIT
// A refined signature with its uncertainty: axis lines, targets and, where they were asked for,
// corrections of the readings, range offsets and scale (docs/model.md, section 5).
#pragma once

#include <span>
#include <string_view>

#include "core/calibration/chain.hpp"
#include "core/calibration/observation.hpp"
#include "core/calibration/square_root_factor.hpp"

namespace armsig::calibration {

// What the data leave open.
enum class Open : std::uint8_t {
  kJointAtRest,   // the joint did not move: nothing about its axis
  kTargetOnAxis,  // the joint moved, the target did not
  kAxisDirection,
  kAxisPosition,
  kReadingGain,
  kReadingFirst,
  kReadingSecond,
  kTarget,
  kReceiverOffset,
};
// A phrase to follow "joint 6: ", "target 2: " or "receiver 1: ", without a full stop.
[[nodiscard]] std::string_view describe(Open open);

struct Undetermined {
  Open open = Open::kAxisDirection;
  std::size_t index = 0;  // of the joint, target or receiver, from 0

  bool operator==(const Undetermined&) const = default;
};

struct FitQuality {
  std::size_t rows_used = 0;
  std::size_t rows_rejected = 0;
  std::size_t scalars = 0;  // measured numbers that entered
  int iterations = 0;
  double rms_m = 0;  // of the residual lengths of the rows used
  // 1 sigma of one measured scalar: found where nothing was stated, otherwise as stated (mean).
  double sigma_m = 0;
  bool sigma_is_estimated = false;
  // Square root of the residual sum over its expectation. Above what chance allows, the stated
  // sigma does not explain the residuals, and the covariance has been enlarged by its square.
  double noise_factor = 1;
  bool covariance_enlarged = false;
  // 1 sigma of a scalar that the residuals show beyond the stated sigma, where that was enlarged:
  // what the arm does and no axis line can say (gears, bending, warmth).
  double unexplained_m = 0;
  // Degrees of freedom that the noise was found with; 0 where it is what was stated.
  double noise_freedom = 0;
};

// The estimate with its uncertainty. About 50 KiB: keep it out of small stacks.
struct Refined {
  Signature signature;  // s_model, pseudo_dh are emptied: they follow from X_SL
  ReadingModel readings;
  std::array<double, kMaxReceivers> receiver_offsets_m{};
  double scale = 0;  // a measured length is (1 + scale) times the true one
  Layout layout;
  SquareRootFactor information;  // R with covariance (R^T R)^-1 of the unknowns of `layout`
  FixedVector<Undetermined, kMaxParameters> undetermined;
  FitQuality quality;
};

}  // namespace armsig::calibration
