// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/sweep_picture.hpp"

#include <algorithm>

#include "core/features/sweep_estimator.hpp"

namespace armsig::tool {
namespace {

struct Directions {
  Vector3 radial;
  Vector3 normal;
  Vector3 tangential;
};

Directions directions_at(const features::JointFeature& feature, double reading) {
  if (feature.type == JointType::kPrismatic) {
    const Vector3 across = any_perpendicular(feature.axis_S);
    return {across, feature.axis_S.cross(across), feature.axis_S};
  }
  const Vector3 to_target = feature.target_at(reading) - feature.point_S;
  const Vector3 radial = (to_target - to_target.dot(feature.axis_S) * feature.axis_S).normalized();
  return {radial, feature.axis_S, feature.axis_S.cross(radial)};
}

void mark_rejected(std::vector<PointResidual>& points, std::size_t rejected) {
  std::vector<PointResidual*> furthest;
  furthest.reserve(points.size());
  for (PointResidual& point : points) furthest.push_back(&point);
  std::ranges::sort(furthest, std::greater{}, [](const PointResidual* point) {
    return Vector3(point->radial_m, point->normal_m, point->tangential_m).squaredNorm();
  });
  for (std::size_t k = 0; k < std::min(rejected, furthest.size()); ++k)
    furthest[k]->rejected = true;
}

}  // namespace

std::optional<SweepPicture> picture_of(const MeasuredSweep& sweep, JointType type,
                                       features::Method method) {
  features::SweepEstimator estimator({.type = type, .limits = {}, .method = method});
  for (const MeasuredPoint& point : sweep.points) {
    if (!estimator.add(point.reading, point.p_S, point.covariance_m2)) return std::nullopt;
  }
  const auto feature = estimator.estimate();
  if (!feature) return std::nullopt;

  SweepPicture picture{
      .joint = sweep.joint, .target = sweep.target, .feature = *feature, .points = {}, .wave = {}};
  for (const MeasuredPoint& point : sweep.points) {
    const Directions along = directions_at(*feature, point.reading);
    const Vector3 error = point.p_S - feature->target_at(point.reading);
    picture.points.push_back({.reading = point.reading,
                              .p_S = point.p_S,
                              .radial_m = error.dot(along.radial),
                              .normal_m = error.dot(along.normal),
                              .tangential_m = error.dot(along.tangential),
                              .rejected = false});
  }
  mark_rejected(picture.points, feature->quality.rejected);
  if (type == JointType::kRevolute) {
    std::vector<CircleResidual> residuals;
    for (const PointResidual& point : picture.points) {
      if (!point.rejected) {
        residuals.push_back({point.reading, point.radial_m, point.tangential_m});
      }
    }
    picture.wave = fit_encoder_wave(residuals, feature->radius_m);
  }
  return picture;
}

}  // namespace armsig::tool
