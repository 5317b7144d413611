// SPDX-License-Identifier: MIT
// What a fit to touches knows of the arm: of the tool after the best rigid motion, for the base's
// place among the places is no part of an arm's accuracy (docs/model.md, section 13).
#pragma once

#include <span>
#include <vector>

#include "core/calibration/signature_of_model.hpp"
#include "firmware/host_tool/places/place_fit.hpp"

namespace armsig::tool {

struct ToolKnowledge {
  double rms_m = 0;        // of the predicted tool error, 1 sigma
  double scale_sigma = 0;  // of the factor on all of the arm's lengths
  double by_scale_m = 0;   // what that moves the tool by, RMS: part of rms_m
  // The rigid motion (turn, shift) that is taken off, by the unknowns.
  Eigen::MatrixXd motion;
};

// Those that the other commands judge an arm by, spread evenly within `limits`.
[[nodiscard]] std::vector<JointVector> judged_configurations(
    const JointTypes& types, const FixedVector<JointLimits, kMaxJoints>& limits);

// The tool's derivatives by the unknowns at these configurations, 3 rows each, without what a rigid
// motion of them all explains. The mean square of the predicted tool error is the trace of
// L C L^T, over the number of configurations.
[[nodiscard]] Eigen::MatrixXd judged_tool(const PlaceFit& fit, std::span<const JointVector> judged);

// Over these configurations.
[[nodiscard]] ToolKnowledge tool_knowledge(const PlaceFit& fit,
                                           std::span<const JointVector> judged);

// The covariance of the engine's geometry block in the frame in which the base stands best, for a
// signature.
class PlaceCovariance final : public calibration::GeometryCovariance {
 public:
  PlaceCovariance(const PlaceFit& fit, const ToolKnowledge& knowledge);
  void times(std::array<double, calibration::kMaxGeometry>& b) const override;

 private:
  Eigen::MatrixXd covariance_;
};

// How many numbers of geometry and tool the touches determine better than the priors do, and how
// many gravity terms and map coefficients.
struct Determined {
  std::size_t geometry = 0;
  std::size_t of_geometry = 0;  // all of them: 5 a joint, 3 of the tool
  double gravity = 0;
  std::size_t of_gravity = 0;
  double maps = 0;
};
[[nodiscard]] Determined determined(const PlaceFit& fit);

}  // namespace armsig::tool
