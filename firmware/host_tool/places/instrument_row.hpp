// SPDX-License-Identifier: MIT
// What a reading of an instrument says of the tool and of the place that it was at: a residual and
// its derivatives (docs/model.md, section 13).
#pragma once

#include <string>

#include <Eigen/Core>

#include "core/base/pose.hpp"
#include "firmware/formats/instrument_file.hpp"

namespace armsig::tool {

// A place in the frame of the nominal base, as far as known.
struct TouchedPlace {
  std::string name;
  std::size_t instrument = 0;  // its index
  InstrumentKind kind = InstrumentKind::kSocket;
  Vector3 point_B = Vector3::Zero();  // a socket's centre, a wire's anchor; a plane's unit normal
  double distance_m = 0;              // of a plane: normal times any of its points
};

// What a wire reads: a true length is (1 + gain) times the length read, plus zero.
struct WireScale {
  double gain = 0;
  double zero_m = 0;
};

// The unknowns of any place are three: its point's coordinates, or a plane's tilts about its first
// and second direction and its distance.
struct InstrumentRow {
  Eigen::Index scalars = 3;  // of the residual: 3 of a socket, 1 of the others
  Vector3 residual = Vector3::Zero();
  Matrix3 by_point = Matrix3::Zero();  // a row a scalar
  Matrix3 by_place = Matrix3::Zero();
  Eigen::Matrix<double, 3, 2> by_scale = Eigen::Matrix<double, 3, 2>::Zero();  // gain, zero
};

// Of a tool point p_B; `length_m` as read, of a wire.
[[nodiscard]] InstrumentRow instrument_row(const TouchedPlace& place, const WireScale& scale,
                                           const Vector3& p_B, double length_m);

// The place moved by a step of its unknowns.
void move(TouchedPlace& place, const Vector3& step);

// The distance between two sockets less the known one, and its derivative by the second of them;
// that by the first is the opposite.
struct LengthRow {
  double residual_m = 0;
  Vector3 by_second = Vector3::Zero();
};
[[nodiscard]] LengthRow length_row(const TouchedPlace& first, const TouchedPlace& second,
                                   double known_m);

}  // namespace armsig::tool
