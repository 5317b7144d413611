// SPDX-License-Identifier: MIT
// Which poses to measure next: greedily those that lower the mean predicted tool variance over the
// work volume most (A-optimal design; Fedorov, Theory of Optimal Experiments, 1972).
#pragma once

#include <limits>
#include <span>

#include "core/calibration/refined.hpp"
#include "core/clearance/clearance.hpp"

namespace armsig::uncertainty {

// Where the sensor sees the target, in the sensor frame.
struct Box {
  Vector3 lower_S = Vector3::Constant(-std::numeric_limits<double>::infinity());
  Vector3 upper_S = Vector3::Constant(std::numeric_limits<double>::infinity());

  [[nodiscard]] bool contains(const Vector3& p_S) const {
    return (p_S.array() >= lower_S.array()).all() && (p_S.array() <= upper_S.array()).all();
  }
};

struct SuggestionConfig {
  FixedVector<JointLimits, kMaxJoints> limits;  // one per joint
  Box box;
  // What the arm of the rows stays clear of, at every pose and on the straight way there from
  // `home`, which is clear itself. Empty rows: nothing is around.
  DhRows rows;
  clearance::Surroundings around;
  JointVector home;
  std::size_t target = 0;  // index into Signature::targets
  double sigma_m = 0;      // of the sensor, for the poses to come; 0: as in the refinement
  int candidates = 400;    // looked at for every pose
  int volume = 150;        // configurations that stand for the work volume
};

struct Suggestion {
  JointVector readings;
  double predicted_rms_m = 0;  // over the work volume, once this pose and those before are measured
};

// With P = (R^T R)^-1 the covariance of the unknowns and V the triangular factor of the work
// volume, V^T V the mean of J^T J over it, the mean tool variance is |V R^-1|^2, and measuring a
// pose with rows J lowers it by tr(S^-1 Z^T Z), Z = V P J^T, S = sigma^2 I + J P J^T. About 75 KiB:
// for the host, or a controller with memory to spare.
class SuggestionSearch {
 public:
  // Starts from what `refined` knows. kOutOfReach when no configuration is inside the box, and
  // clear.
  // Preconditions: `refined` outlives the search; its target is among the unknowns; one limit per
  // joint.
  [[nodiscard]] Result<void> start(const calibration::Refined& refined,
                                   const SuggestionConfig& config);

  // The accuracy expected of what is measured so far: after start(), of the log alone.
  [[nodiscard]] double predicted_rms_m() const;

  // Fills `suggestions`, in the order of their worth. kOutOfReach when no candidate is inside the
  // box.
  [[nodiscard]] Result<void> suggest(std::span<Suggestion> suggestions);

 private:
  // Whether the target is inside the box then; `rows`: its derivatives by the unknowns.
  [[nodiscard]] bool sees(const calibration::PoeChain& chain, const JointVector& readings,
                          calibration::RowBlock<3>& rows) const;
  // Whether the arm may be there, and whether it can go there from home.
  [[nodiscard]] bool has_room(const JointVector& readings) const;
  [[nodiscard]] bool is_clear(const JointVector& readings) const;
  // How much the mean tool variance falls by measuring a pose with these rows.
  [[nodiscard]] double gain(calibration::RowBlock<3> rows) const;
  [[nodiscard]] Result<JointVector> best_pose(const calibration::PoeChain& chain,
                                              const JointVector* present);
  void measure(const calibration::PoeChain& chain, const JointVector& readings);
  void climb(const calibration::PoeChain& chain, JointVector& readings, double& best_gain) const;

  const calibration::Refined* refined_ = nullptr;
  SuggestionConfig config_;
  int next_candidate_ = 0;
  calibration::SquareRootFactor information_;  // R
  calibration::SquareRootFactor volume_;       // V
};

}  // namespace armsig::uncertainty
