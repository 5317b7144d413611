// SPDX-License-Identifier: MIT
// The unknowns of a fit to touches of places, where each stands, and the linearised rows
// (docs/model.md, section 13). The chain and its columns are the engine's.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/calibration/engine.hpp"
#include "firmware/host_tool/places/place_task.hpp"

namespace armsig::tool {

// What is unknown beside tool and places.
struct PlaceParts {
  bool geometry = true;  // deviations of every joint
  bool gravity = true;
  bool maps = true;
};

// Where the unknowns stand: tool 3; deviations of the joints, gravity terms; a map of every joint
// that moved; places 3 each; gain and zero of every wire.
struct PlaceColumns {
  PlaceColumns(const PlaceTask& task, const PlaceState& state, const PlaceParts& parts);

  // Of the engine's geometry block, base apart, those that are unknown here.
  [[nodiscard]] Eigen::Index place(std::size_t index) const {
    return places + 3 * static_cast<Eigen::Index>(index);
  }

  Eigen::Index geometry = 0;  // tool, deviations and gravity: the first so many
  Eigen::Index gravity = 0;   // the first gravity term
  std::vector<std::pair<std::size_t, Eigen::Index>> maps;  // joint, first column
  Eigen::Index places = 0;
  std::vector<Eigen::Index> scales;  // an instrument each; -1: it is no wire
  Eigen::Index size = 0;
};

// One number that was measured: its residual and its derivatives, most of which are zero.
struct PlaceScalar {
  std::size_t touch = 0;
  double residual = 0;
  std::vector<std::pair<int, double>> J;

  // J x.
  [[nodiscard]] double times(const Eigen::VectorXd& x) const;
};

class PlaceRows {
 public:
  // `state` is kept as a reference, as it moves.
  PlaceRows(const PlaceTask& task, PlaceState& state, const PlaceColumns& columns);

  // Of all touches; then a number for every known length, divided by its sigma.
  [[nodiscard]] std::vector<PlaceScalar> touches() const;
  [[nodiscard]] std::vector<PlaceScalar> lengths() const;
  // Derivatives of the tool's position at these readings, a row a coordinate.
  [[nodiscard]] std::array<PlaceScalar, 3> tool(const JointVector& q) const;
  // Residuals alone, as touches() and lengths() order them.
  [[nodiscard]] std::vector<double> touch_residuals() const;
  [[nodiscard]] std::vector<double> length_residuals() const;

  void move(const Eigen::VectorXd& step, double fraction);

 private:
  void add_tool(const calibration::ChainFrames& frames, const JointVector& q,
                const Matrix3& by_point, Eigen::Index scalars, PlaceScalar* rows) const;
  [[nodiscard]] InstrumentRow row_of(const TouchRow& touch, const Vector3& p_B) const;

  const PlaceTask& task_;
  PlaceState& state_;
  const PlaceColumns& columns_;
  std::vector<double> matrix_;
  std::unique_ptr<calibration::WorkspaceFor<kMaxJoints>> work_ =
      std::make_unique<calibration::WorkspaceFor<kMaxJoints>>();
  std::unique_ptr<calibration::Engine> engine_;  // for its columns alone
};

}  // namespace armsig::tool
