// SPDX-License-Identifier: MIT
// What the estimator works on and with: targets, the scales of its priors, its memory, and what it
// says of a fit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/pose.hpp"
#include "core/calibration/cyclic_band.hpp"
#include "core/numerics/robust.hpp"
#include "core/signature.hpp"

namespace armsig::calibration {

// Columns of the geometry block: eight joints with ten targets, or fewer with gravity.
inline constexpr std::size_t kMaxGeometry = 128;

struct ModelTarget {
  std::size_t link = 0;
  Vector3 p_L = Vector3::Zero();
  Vector3 start_L = Vector3::Zero();  // what its prior is about
  std::size_t rows = 0;
  std::size_t kept = 0;  // of the rows, not rejected
};

// What beside the geometry belongs to the model.
struct ModelParts {
  bool gravity = true;
  bool maps = true;
  // Bit j set: joint j gets no map all the same. One that stood still never does.
  std::uint8_t without_map = 0;
};

// Variances: of a row's error per axis [m^2], and of the priors over their unit standard
// deviations (2 mrad, 1 mm, 10 mrad; 1 mrad of a correction, per radian of a gain; map_unit() per
// metre of lever; map_unit()).
struct Scales {
  double sigma_squared = 0;
  double rotation = 1;
  double shift = 1;
  double zero = 1;
  double reading = 1;
  double gravity = 1;
  double play = 1;
  std::array<double, kMaxJoints> map{1, 1, 1, 1, 1, 1, 1, 1};
  // Rotation, shift and zero stay as they are: where the start was found from the same rows, how
  // near the fit comes to it says nothing of how near it is to be expected.
  bool geometry_is_held = false;
};

// Memory beside the rows, but for the matrix of the geometry block: a WorkspaceFor.
struct Workspace {
  std::span<CyclicBand> band;  // a joint; of the rows; after run(), of the covariance
  std::span<MapCoefficients> map_step;
  MapCoefficients map_gradient{};
  CyclicFactor factor;
  CyclicBand covariance{};         // of one map
  numerics::LogHistogram lengths;  // of the residuals
  std::array<double, kMaxGeometry> step{};
  std::array<double, kMaxGeometry> gradient{};

 protected:
  // Owned as what it is, a WorkspaceFor: not by a pointer to its part.
  Workspace() = default;
  ~Workspace() = default;
};
// For arms of up to kJoints joints: 39 kB for eight, 33 kB for six.
template <std::size_t kJoints>
struct WorkspaceFor : Workspace {
  WorkspaceFor() {
    band = bands_;
    map_step = map_steps_;
  }
  WorkspaceFor(const WorkspaceFor&) = delete;
  WorkspaceFor& operator=(const WorkspaceFor&) = delete;

 private:
  std::array<CyclicBand, kJoints> bands_{};
  std::array<MapCoefficients, kJoints> map_steps_{};
};
// Doubles of the geometry block's matrix.
[[nodiscard]] constexpr std::size_t matrix_size(std::size_t columns) {
  return columns * (columns + 1);
}

struct FitSummary {
  int rounds = 0;
  bool converged = false;       // the last step did not matter
  double degrees_of_model = 0;  // unknowns that the data determined
  std::size_t rows = 0;         // fitted
  std::size_t rejected = 0;
};

// Derivatives of a row's position by the geometry block.
struct GeometryColumns {
  std::array<std::array<double, kMaxGeometry>, 3> d;
};

// Unknowns whose prior has one scale: x^T Q x, tr(Q C), their number.
struct PriorGroup {
  double squares = 0;
  double trace = 0;
  double unknowns = 0;
};

}  // namespace armsig::calibration
