// SPDX-License-Identifier: MIT
// What one sweep says about one joint: section 3.1 of the paper, with its uncertainty.
//
// A revolute joint gives a plane of rotation and a centre of rotation, a prismatic one a line of
// translation. Either is written as the triad that link-frame construction (15)-(17) wants:
// direction of the axis, a point on it, and the direction towards the target at the first reading.
#pragma once

#include <cstddef>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::features {

enum class Method : std::uint8_t {
  kPaper,    // plane (13) and circle (14); the joint reading gives the sense only, and the gate
  kEncoder,  // the circle or line is followed by the joint reading: p = c + A cos(theta) + B
             // sin(theta)
};

// A target nearer than this to the axis of a revolute joint tells little about that axis, however
// far the joint turns.
inline constexpr double kNextToAxis_m = 0.02;

// Residuals and counts of one sweep.
struct SweepQuality {
  std::size_t used = 0;
  std::size_t rejected = 0;   // by the gate
  double lowest_reading = 0;  // of the accepted points; radians or metres
  double highest_reading = 0;
  // Revolute: distance from the plane (13), from the circle (14), and what then remains about the
  // fit, around the circle, where the encoder's errors show. Prismatic: across the line (both
  // directions together), none, and along the line.
  double rms_normal_m = 0;
  double rms_radial_m = 0;
  double rms_tangential_m = 0;
  // What imposing a circle or unit scale removed: |A|/|B| of a revolute joint, |u| of a prismatic
  // one; 1 is ideal.
  double encoder_ratio = 1;
  double encoder_ratio_sigma = 0;  // its 1 sigma
  // 1 sigma per axis of a point, on which the covariance rests: as stated; or estimated where
  // nothing was stated, or where the residuals are significantly larger.
  double sigma_m = 0;
  bool sigma_is_estimated = false;

  [[nodiscard]] double arc() const { return highest_reading - lowest_reading; }
};

// Everything in the sensor frame S, at the signature configuration of the other joints.
struct JointFeature {
  JointType type = JointType::kRevolute;
  Vector3 axis_S = Vector3::UnitZ();  // unit; positive sense of the joint reading
  Vector3 point_S =
      Vector3::Zero();  // centre of rotation; prismatic: the target at the reference reading
  Vector3 radial_S = Vector3::UnitX();  // unit, perpendicular to axis_S; towards the target at the
                                        // reference reading
  double radius_m = 0;                  // 0 for a prismatic joint
  double reference_reading = 0;         // the first accepted reading of the sweep
  // 1-sigma squares and products of (point_S [m], rotation vector of the triad in S [rad], radius
  // [m]); a prismatic joint has zero rows for the rotation about its axis and for the radius.
  Eigen::Matrix<double, 7, 7> covariance = Eigen::Matrix<double, 7, 7>::Zero();
  SweepQuality quality;

  // Where the target is at joint reading `reading`, in the sensor frame.
  [[nodiscard]] Vector3 target_at(double reading) const;
  // Its 1-sigma squares and products, by propagation of `covariance`.
  [[nodiscard]] Matrix3 target_covariance_at(double reading) const;
};

}  // namespace armsig::features
