// SPDX-License-Identifier: MIT
// The least-squares problem behind refine(): its residuals, its noise, its linear rows.
#pragma once

#include "core/refinement/compressed_sweep.hpp"
#include "core/refinement/refinement.hpp"

namespace armsig::refinement {

// Units of the residuals, found robustly from the residuals themselves.
struct Noise {
  double stated_factor =
      1;  // residuals of rows with a stated sigma are so many times that sigma, >= 1
  double unstated_m = 0;  // sigma of rows where none was stated
};

class Problem {
 public:
  static constexpr std::size_t kMaxSweeps = 16;

  // Keeps references to all of them. `estimate` holds layout and start.
  Problem(const Signature& start, std::span<const Observation> log, const RefinementConfig& config,
          std::span<RowOutcome> outcomes, Refined& estimate);

  // Residuals of the present estimate, into the outcomes. What follows is about that estimate:
  // whoever changes it calls this again.
  void evaluate();
  // The noise that these residuals show.
  [[nodiscard]] Noise noise() const;
  // Robust sum of squares of these residuals, priors included.
  [[nodiscard]] double cost(const Noise& noise) const;
  // From now on the unknowns named are held by a prior kHeldShare as wide, so that noise does not
  // move them where the data are silent.
  void hold(const std::array<bool, kMaxParameters>& open);
  void release() { hold({}); }

  // The factor of the problem linearised at the present estimate.
  void linearise(const Noise& noise);

  // Residuals and weights of every row, those inside sweeps and those held out too, and their
  // summary. Returns the sum of weighted squares over their variances.
  double judge_rows(const Noise& noise);

  // Largest motion of each joint in the rows used, and largest distance of a target from its axis
  // then.
  [[nodiscard]] const std::array<double, kMaxJoints>& largest_motion() const { return motion_; }
  [[nodiscard]] const std::array<double, kMaxJoints>& largest_radius() const { return radius_; }

 private:
  // [c; A; B] of a sweep (swept_path.hpp).
  [[nodiscard]] SweptPath path_of(const CompressedSweep& sweep) const;
  // Measured minus predicted coefficients of a sweep, times R; in the frame of its path, because
  // the noise is the same along every axis.
  [[nodiscard]] Matrix3 sweep_residual(const CompressedSweep& sweep, const SweptPath& path) const;
  void add_sweep(const CompressedSweep& sweep, double weight);
  void add_priors();
  [[nodiscard]] double sigma_of_prior(std::size_t unknown) const;
  void evaluate_priors();
  // How far an unknown is from its start.
  [[nodiscard]] double deviation(const Parameter& parameter) const;
  void note(std::size_t joint, double moved, double radius);
  template <typename Single, typename Sweep>
  void for_each_unit(Single single, Sweep sweep) const;

  const Signature& start_;
  std::span<const Observation> log_;
  const RefinementConfig& config_;
  std::span<RowOutcome> outcomes_;
  Refined& estimate_;
  Chain chain_;  // of the estimate
  FixedVector<CompressedSweep, kMaxSweeps> sweeps_;
  FixedVector<double, kMaxSweeps> sweep_squares_;  // of the present residuals
  std::array<bool, kMaxParameters> held_{};
  StateVector prior_residuals_;  // how far the unknowns are from their start, in sigma of the prior
  std::array<double, kMaxJoints> motion_{};
  std::array<double, kMaxJoints> radius_{};
};

}  // namespace armsig::refinement
