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

  // Residuals of the present estimate, into the outcomes.
  void evaluate();
  // The noise that these residuals show.
  [[nodiscard]] Noise noise() const;
  // Robust sum of squares of these residuals, priors included.
  [[nodiscard]] double cost(const Noise& noise) const;
  // From now on the unknowns named are held by a prior kHeldShare as wide, so that noise does not
  // move them where the data are silent.
  void hold(const std::array<bool, kMaxParameters>& open) { held_ = open; }
  void release() { held_.fill(false); }

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
  // Visits the three nodes of a sweep with how far the joints have moved there.
  template <typename Visit>
  void for_each_node(const CompressedSweep& sweep, const Chain& chain, Visit visit) const;
  // Rows: the target at the three nodes.
  [[nodiscard]] Matrix3 node_positions(const CompressedSweep& sweep, const Chain& chain) const;
  void add_sweep(const CompressedSweep& sweep, const Chain& chain, double weight);
  void add_priors();
  [[nodiscard]] double sigma_of_prior(std::size_t unknown) const;
  [[nodiscard]] double prior_squares() const;
  // How far an unknown is from its start.
  [[nodiscard]] double deviation(const Parameter& parameter) const;
  void note(const JointMotion& motion, std::size_t link, const PointJacobian& jacobian);
  template <typename Single, typename Sweep>
  void for_each_unit(Single single, Sweep sweep) const;

  const Signature& start_;
  std::span<const Observation> log_;
  const RefinementConfig& config_;
  std::span<RowOutcome> outcomes_;
  Refined& estimate_;
  FixedVector<CompressedSweep, kMaxSweeps> sweeps_;
  FixedVector<double, kMaxSweeps> sweep_squares_;  // of the present residuals
  std::array<bool, kMaxParameters> held_{};
  std::array<double, kMaxJoints> motion_{};
  std::array<double, kMaxJoints> radius_{};
};

}  // namespace armsig::refinement
