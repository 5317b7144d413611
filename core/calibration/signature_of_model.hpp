// SPDX-License-Identifier: MIT
// The geometry of a fitted model as a signature: axis lines and targets at a configuration, with
// their covariance.
#pragma once

#include "core/calibration/engine.hpp"
#include "core/calibration/refined.hpp"

namespace armsig::calibration {

// Moves the axis lines of `signature` and those of its targets that rows were of, whose
// configuration and link frames say where to put them, to those of the model; its S-Model and
// pseudo-DH parameters are then to be derived anew.
void axes_to_signature(const ArmModel& model, std::span<const ModelTarget> targets,
                       Signature& signature);

// The covariance of the geometry of a fit: base 6, target 3 each, deviations of the joints,
// corrections, in this order; gravity is no part of it.
class GeometryCovariance {
 public:
  // Replaces b by the covariance times b.
  virtual void times(std::array<double, kMaxGeometry>& b) const = 0;

 protected:
  ~GeometryCovariance() = default;
};

// Moves the axis lines and targets of `refined.signature`, whose configuration and link frames say
// where to put them, to those of the model, and sets the layout and information of `refined` to the
// covariance of the model: that of the geometry and of the corrections in `request`, which are
// those that the model was asked for. `scratch`: kMaxParameters squared numbers. Errors:
// kCapacityExceeded (unknowns, capacity); kSingular.
[[nodiscard]] Judged<void> geometry_to_signature(const ArmModel& model,
                                                 std::span<const ModelTarget> targets,
                                                 const GeometryCovariance& found, Refined& refined,
                                                 const ParameterRequest& request,
                                                 std::span<double> scratch);
// The same with the covariance that an engine found.
[[nodiscard]] Judged<void> geometry_to_signature(const ArmModel& model,
                                                 std::span<const ModelTarget> targets,
                                                 const Engine& engine, Refined& refined,
                                                 const ParameterRequest& request,
                                                 std::span<double> scratch);

}  // namespace armsig::calibration
