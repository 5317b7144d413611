// SPDX-License-Identifier: MIT
// Maximum-likelihood refinement of a signature over everything measured (section 5 of ALGORITHMS).
//
// Gauss-Newton on the axis lines, target points and, where asked for, corrections of the readings,
// range offsets and scale, over a log of any length: every iteration feeds the rows to a
// square-root information filter of fixed size, sweeps of one joint reduced to three rows
// beforehand. Huber weights and a gate keep gross outliers out. Weak priors about the start hold
// what the data do not determine.
#pragma once

#include <span>
#include <string_view>

#include "core/refinement/chain.hpp"
#include "core/refinement/observation.hpp"
#include "core/refinement/square_root_factor.hpp"

namespace armsig::refinement {

// 1 sigma about the start. Wide enough to leave alone whatever the data determine.
struct Prior {
  double direction_rad = 0.1;
  double position_m = 0.1;
  double target_m = 1.0;
  double gain = 0.01;
  double periodic_rad = 0.01;
  double receiver_offset_m = 0.05;
  // Relative. 0: nothing is known about the scale, and asking for it is refused unless the log
  // itself determines it (a prismatic joint, receivers at known distances).
  double scale = 0;
};

// The prior's 1 sigma of one unknown of a kind.
[[nodiscard]] double prior_sigma(const Prior& prior, ParameterKind kind);

struct RefinementConfig {
  ReadingModel readings;  // couplings of the arm; corrections to start from, or none
  ParameterRequest request;
  Receivers receivers;
  Prior prior;
  bool compress_sweeps = true;
};

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

// Refines `start` over `log`; `outcomes` (as long as the log) receives the verdict on every row.
// Preconditions: X_SL, configuration and targets of `start` are set; targets, receivers and joint
// numbers of the log exist; `start` is not `refined.signature`.
// Errors: kNotFinite (found: index of the row); kCapacityExceeded (unknowns, capacity);
// kTooFewPoints (measured scalars, unknowns, and 3 more to find a sigma that was not stated);
// kJointDidNotMove (no joint moved in any row);
// kTooManyOutliers (rows rejected, rows allowed); kScaleUndetermined; kSingular; kNotConverged
// (last step in sigma, bound).
[[nodiscard]] std::expected<void, Refusal> refine(const Signature& start,
                                                  std::span<const Observation> log,
                                                  const RefinementConfig& config,
                                                  std::span<RowOutcome> outcomes, Refined& refined);

}  // namespace armsig::refinement
