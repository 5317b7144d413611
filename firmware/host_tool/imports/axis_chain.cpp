// SPDX-License-Identifier: MIT
#include "firmware/host_tool/imports/axis_chain.hpp"

#include <array>
#include <cmath>

#include <fmt/core.h>

#include "core/pseudo_dh/pseudo_dh.hpp"
#include "core/s_model/s_model.hpp"

namespace armsig::tool {
namespace {

constexpr double kSmall = 1e-9;   // metres and radians: the rounding of a file
constexpr double kNoise = 1e-12;  // of sines and cosines, times an arm

// A frame at `point` with z along `direction`, its x as near that of `R` as it goes.
Pose frame_on(const Vector3& point, const Vector3& direction, const Matrix3& R) {
  const Vector3 z = direction.normalized();
  Vector3 x = R.col(0) - z * z.dot(R.col(0));
  x = x.norm() > kSmall ? Vector3(x.normalized()) : any_perpendicular(z);
  Pose X;
  X.R << x, z.cross(x), z;
  X.p = point;
  return X;
}

// Joint 1's frame: the base itself where it stands on the axis, else the nearest point of the axis.
Pose first_frame(const ChainAxis& axis) {
  const Vector3 z = axis.direction_B.normalized();
  const Vector3 nearest = axis.point_B - z * z.dot(axis.point_B);
  return frame_on(nearest.norm() < kSmall ? Vector3(Vector3::Zero()) : nearest, z,
                  Matrix3::Identity());
}

// Makes directions that are meant parallel exactly so.
void straighten(AxisChain& chain, std::vector<std::string>& notes) {
  Vector3 before = chain.axes[0].direction_B;
  for (std::size_t i = 1; i < chain.axes.size(); ++i) {
    Vector3& direction = chain.axes[i].direction_B;
    const double sine = before.cross(direction).norm();
    if (sine > 0 && sine < kMeantParallel_rad) {
      direction = before.dot(direction) > 0 ? before : Vector3(-before);
      if (sine > kSmall) {
        notes.push_back(fmt::format("axes {} and {} were {:.2g} rad from parallel; made parallel",
                                    i, i + 1, sine));
      }
    }
    before = direction;
  }
  const double sine = before.cross(chain.X_BT.R.col(2)).norm();
  if (sine > 0 && sine < kMeantParallel_rad) {
    const double sense = before.dot(chain.X_BT.R.col(2)) > 0 ? 1 : -1;
    if (sine > kSmall) {
      notes.push_back(fmt::format(
          "the z axis of the tip link was {:.2g} rad from parallel to axis {}; made parallel", sine,
          chain.axes.size()));
    }
    chain.X_BT = frame_on(chain.X_BT.p, sense * before, chain.X_BT.R);
  }
}

// Of the two rows that are the same transform the one with the smaller offset of the angle; the
// first where they are equal.
s_model::Parameters plainest(const Pose& B, double gamma_before_rad) {
  using s_model::Branch;
  const bool parallel = s_model::is_parallel(s_model::from_transform(B, Branch::kPositiveA));
  const std::array branches = parallel ? std::array{Branch::kPositiveA, Branch::kNegativeA}
                                       : std::array{Branch::kPositiveAlpha, Branch::kNegativeAlpha};
  const auto first = s_model::from_transform(B, branches[0]);
  const auto second = s_model::from_transform(B, branches[1]);
  const auto offset = [&](const s_model::Parameters& parameters) {
    return std::abs(wrap_angle(parameters.beta_rad + gamma_before_rad));
  };
  return offset(second) < offset(first) - kSmall ? second : first;
}

std::string place(const Pose& X) {
  const Vector3 turn = rotation_vector(X.R);
  return fmt::format("at ({:.6g}, {:.6g}, {:.6g}) m, turned by ({:.6g}, {:.6g}, {:.6g}) deg",
                     X.p.x(), X.p.y(), X.p.z(), degrees(turn.x()), degrees(turn.y()),
                     degrees(turn.z()));
}

bool is_identity(const Pose& X) {
  return X.p.norm() < kSmall && rotation_vector(X.R).norm() < kSmall;
}

// The value, or the number beside it from which it differs by the noise of sines and cosines only.
// Adding zero makes a negative zero positive.
double cleaned(double value, double beside) {
  return std::abs(value - beside) < kNoise ? beside + 0.0 : value;
}

double clean_angle(double angle_rad) {
  return cleaned(angle_rad, std::round(angle_rad / (kPi / 2)) * (kPi / 2));
}

double clean_length(double length_m) {
  constexpr double kMicrometres = 1e6;  // dividing by it rounds once, multiplying by 1e-6 twice
  return cleaned(length_m, std::round(length_m * kMicrometres) / kMicrometres);
}

// Rows without the noise of sines and cosines.
void clean(DhRows& rows) {
  for (DhJoint& row : rows) {
    row.theta_rad = clean_angle(row.theta_rad);
    row.alpha_rad = clean_angle(row.alpha_rad);
    row.d_m = clean_length(row.d_m);
    row.a_m = clean_length(row.a_m);
  }
}

}  // namespace

DrawnChain drawn(const AxisChain& given) {
  DrawnChain result;
  AxisChain chain = given;
  straighten(chain, result.notes);

  result.X_B0 = first_frame(chain.axes[0]);
  FixedVector<s_model::Parameters, kMaxJoints> parameters;
  JointTypes types;
  JointVector zero;
  Pose X_BL = result.X_B0;
  for (std::size_t i = 0; i < chain.axes.size(); ++i) {
    const bool last = i + 1 == chain.axes.size();
    const Pose X_next =
        last ? chain.X_BT
             : frame_on(chain.axes[i + 1].point_B, chain.axes[i + 1].direction_B, X_BL.R);
    parameters.push_back(
        plainest(X_BL.inverse() * X_next, i == 0 ? 0 : parameters[i - 1].gamma_rad));
    types.push_back(chain.axes[i].type);
    zero.push_back(0);
    X_BL = X_next;
  }
  result.arm.joints = pseudo_dh::from_s_model(parameters, types, zero);
  clean(result.arm.joints);
  for (const ChainAxis& axis : chain.axes) result.arm.limits.push_back(axis.limits);
  result.arm.couplings = chain.couplings;
  result.arm.up_0 = result.X_B0.R.transpose() * Vector3::UnitZ();
  result.X_FT = pseudo_dh::link_frame_in_dh_frame(parameters.back());
  if (!is_identity(result.X_B0)) {
    result.notes.push_back("frame 0 of the arm description stands in the base link " +
                           place(result.X_B0));
  }
  if (!is_identity(result.X_FT)) {
    result.notes.push_back("the tip link stands in the last frame of the arm description " +
                           place(result.X_FT));
  }
  return result;
}

}  // namespace armsig::tool
