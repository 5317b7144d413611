// SPDX-License-Identifier: MIT
// Sizes of the types that pass between a program and the installed library, as the compiler of
// whoever includes this sees them. They must be those that the library was built with, whatever the
// flags of either.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "core/calibration/observation.hpp"
#include "core/identification.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/analysis/postures/cold_start.hpp"

namespace armsig {

struct TypeLayout {
  std::string_view name;
  std::size_t size = 0;
  std::size_t alignment = 0;

  bool operator==(const TypeLayout&) const = default;
};

namespace layout_detail {

template <typename T>
[[nodiscard]] consteval TypeLayout of(std::string_view name) {
  return {name, sizeof(T), alignof(T)};
}

}  // namespace layout_detail

// Not inline: each includer has its own.
constexpr std::array kLayout{
    layout_detail::of<Pose>("Pose"),
    layout_detail::of<PoseT<float>>("PoseT<float>"),
    layout_detail::of<JointVector>("JointVector"),
    layout_detail::of<Arm>("Arm"),
    layout_detail::of<Signature>("Signature"),
    layout_detail::of<features::JointFeature>("features::JointFeature"),
    layout_detail::of<s_model::Parameters>("s_model::Parameters"),
    layout_detail::of<Refusal>("Refusal"),
    layout_detail::of<IdentificationFailure>("IdentificationFailure"),
    layout_detail::of<kinematics::Chain>("kinematics::Chain"),
    layout_detail::of<kinematics::SModelChain<double>>("kinematics::SModelChain<double>"),
    layout_detail::of<kinematics::SModelChain<float>>("kinematics::SModelChain<float>"),
    layout_detail::of<kinematics::PoseAndJacobian>("kinematics::PoseAndJacobian"),
    layout_detail::of<kinematics::InverseOptions>("kinematics::InverseOptions"),
    layout_detail::of<kinematics::InverseSolution>("kinematics::InverseSolution"),
    layout_detail::of<kinematics::ClosedForm>("kinematics::ClosedForm"),
    layout_detail::of<kinematics::Solutions>("kinematics::Solutions"),
    layout_detail::of<calibration::Observation>("calibration::Observation"),
};

// kLayout as the library was built.
[[nodiscard]] std::span<const TypeLayout> library_layout();

}  // namespace armsig
