// SPDX-License-Identifier: MIT
// The unknowns of the refinement and where each stands in the state vector.
//
// Everything is a small correction about the present estimate: axis lines in their own link frame
// (z along the axis, so that rotation about z and translation along z do nothing to the line),
// target points in the sensor frame at the signature configuration. Minimal: 4 per revolute axis, 2
// per prismatic one, 3 per target; nothing is a gauge.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/error.hpp"
#include "core/calibration/observation.hpp"
#include "core/calibration/parameter.hpp"
#include "core/signature.hpp"

namespace armsig::calibration {

// Largest number of unknowns: the packed square-root factor of that size takes 26 KiB. Enough for
// eight joints with every correction and one target, or with a target on each link.
inline constexpr std::size_t kMaxParameters = 80;

// Marks a quantity that is not among the unknowns.
inline constexpr std::size_t kNoColumn = ~std::size_t{0};

struct Layout {
  FixedVector<Parameter, kMaxParameters> parameters;
  std::array<std::size_t, kMaxJoints> axis{};     // first of 4 (revolute) or 2 (prismatic) columns
  std::array<std::size_t, kMaxJoints> gain{};     // or kNoColumn
  std::array<std::size_t, kMaxJoints> first{};    // first of 2, or kNoColumn
  std::array<std::size_t, kMaxJoints> second{};   // first of 2, or kNoColumn
  std::array<std::size_t, kMaxTargets> target{};  // first of 3, or kNoColumn: not observed
  std::size_t receiver_offsets = kNoColumn;       // first of as many as receivers
  std::size_t scale = kNoColumn;

  [[nodiscard]] std::size_t size() const { return parameters.size(); }
};

// The layout for the joints of `signature` and those of its targets for which `observed` is true.
// kCapacityExceeded with more than kMaxParameters unknowns.
[[nodiscard]] Judged<Layout> make_layout(const Signature& signature,
                                         const std::array<bool, kMaxTargets>& observed,
                                         const ParameterRequest& request,
                                         std::size_t receiver_count);

}  // namespace armsig::calibration
