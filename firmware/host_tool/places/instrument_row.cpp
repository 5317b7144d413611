// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/instrument_row.hpp"

#include <Eigen/Geometry>

namespace armsig::tool {
namespace {

// Two directions of the plane with this normal.
std::pair<Vector3, Vector3> plane_directions(const Vector3& normal) {
  const Vector3 first = normal.unitOrthogonal();
  return {first, normal.cross(first)};
}

// From `from` to `to`; none where both are one point.
Vector3 way_between(const Vector3& from, const Vector3& to) {
  const Vector3 way = to - from;
  const double length = way.norm();
  return length > 0 ? Vector3(way / length) : Vector3::Zero();
}

InstrumentRow socket_row(const TouchedPlace& place, const Vector3& p_B) {
  InstrumentRow row;
  row.residual = p_B - place.point_B;
  row.by_point = Matrix3::Identity();
  row.by_place = -Matrix3::Identity();
  return row;
}

InstrumentRow plane_row(const TouchedPlace& place, const Vector3& p_B) {
  InstrumentRow row;
  row.scalars = 1;
  row.residual[0] = place.point_B.dot(p_B) - place.distance_m;
  row.by_point.row(0) = place.point_B.transpose();
  const auto [first, second] = plane_directions(place.point_B);
  row.by_place.row(0) << first.dot(p_B), second.dot(p_B), -1;
  return row;
}

InstrumentRow wire_row(const TouchedPlace& place, const WireScale& scale, const Vector3& p_B,
                       double length_m) {
  InstrumentRow row;
  row.scalars = 1;
  row.residual[0] = (p_B - place.point_B).norm() - (1 + scale.gain) * length_m - scale.zero_m;
  const Vector3 u = way_between(place.point_B, p_B);
  row.by_point.row(0) = u.transpose();
  row.by_place.row(0) = -u.transpose();
  row.by_scale.row(0) << -length_m, -1;
  return row;
}

}  // namespace

InstrumentRow instrument_row(const TouchedPlace& place, const WireScale& scale, const Vector3& p_B,
                             double length_m) {
  switch (place.kind) {
    case InstrumentKind::kSocket:
      return socket_row(place, p_B);
    case InstrumentKind::kPlane:
      return plane_row(place, p_B);
    case InstrumentKind::kWire:
      break;
  }
  return wire_row(place, scale, p_B, length_m);
}

void move(TouchedPlace& place, const Vector3& step) {
  if (place.kind != InstrumentKind::kPlane) {
    place.point_B += step;
    return;
  }
  const auto [first, second] = plane_directions(place.point_B);
  place.point_B = (place.point_B + step.x() * first + step.y() * second).normalized();
  place.distance_m += step.z();
}

LengthRow length_row(const TouchedPlace& first, const TouchedPlace& second, double known_m) {
  return {(second.point_B - first.point_B).norm() - known_m,
          way_between(first.point_B, second.point_B)};
}

}  // namespace armsig::tool
