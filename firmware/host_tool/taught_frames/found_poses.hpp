// SPDX-License-Identifier: MIT
// Where the found arm has the controller's flange, and what the covariance of its signature makes
// of that (docs/model.md, section 14).
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/calibration/refined.hpp"
#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

// The frames that a controller computes with.
struct ControllerFrames {
  Arm nominal;
  Pose X_0C;  // its base in frame 0 of that model
  Pose X_nE;  // its flange in the last frame of that model
};

// An arm by its signature, as a controller with those frames sees it.
class FoundFlange {
 public:
  FoundFlange(const Signature& signature, const calibration::ReadingModel& readings,
              const ControllerFrames& controller);

  // X_CE at what the encoders read; with joint `joint` moved by `by` more, rad or m.
  [[nodiscard]] Pose pose(const JointVector& q, std::size_t joint = 0, double by = 0) const;
  // A target of the last link on the flange.
  [[nodiscard]] Vector3 target_E(const Target& target) const;

 private:
  Signature signature_;
  calibration::ReadingModel readings_;
  Pose X_CS_;
  Pose X_LE_;  // L: the last link's frame
};

// Derivatives of the poses of rows, 6 numbers each: origin, and turn about the axes of C.
struct PoseDerivatives {
  Eigen::MatrixXd covariance;       // of the unknowns of the signature
  Eigen::MatrixXd by_unknowns;      // 6 rows a row of the table
  Eigen::MatrixXd tip_by_unknowns;  // 3 rows, of the target that is the tip; zero without one
  // What the joint error maps leave open, joint by joint; none without maps.
  std::vector<Eigen::MatrixXd> by_motion;       // 6 rows a row of the table, a column a row
  std::vector<Eigen::MatrixXd> map_covariance;  // of the errors of the maps at the rows
  double unexplained_m = 0;                     // of a position beyond all that, 1 sigma per axis

  // Covariance of a frame whose derivatives by the rows and by the tip are these.
  [[nodiscard]] Eigen::Matrix<double, 6, 6> covariance_of(
      const Eigen::MatrixXd& by_rows, const Eigen::Matrix<double, 6, 3>& by_tip) const;
};

// By differences of a share of each sigma. `target`: the index of that which is the tip.
[[nodiscard]] PoseDerivatives pose_derivatives(const calibration::Refined& estimate,
                                               const ControllerFrames& controller,
                                               const std::vector<JointVector>& rows,
                                               std::optional<std::size_t> target);

}  // namespace armsig::tool
