// SPDX-License-Identifier: MIT
// The S-Model of Stone, Sanderson and Neuman: six parameters a joint, (4), from a general transform
// B_i by Paul's backward multiplication (section 3.2.3 of the paper; docs/model.md, section 3).
#pragma once

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::s_model {

// B = Rot(z, beta) Trans(0, 0, d) Trans(a, 0, 0) Rot(x, alpha) Rot(z, gamma) Trans(0, 0, b), (4).
struct Parameters {
  double beta_rad = 0;
  double d_m = 0;
  double a_m = 0;
  double alpha_rad = 0;
  double gamma_rad = 0;
  double b_m = 0;
};

// (beta, a, alpha, gamma) and (beta + pi, -a, -alpha, gamma + pi) are the same transform; the
// branch says which of the two is meant.
enum class Branch : std::uint8_t { kPositiveAlpha, kNegativeAlpha, kPositiveA, kNegativeA };

// The branch that a row of the drawing stands on: the sign of its alpha, or of its a where its axes
// are parallel within a milliradian (a drawing may say 3.1416). A row with neither is kPositiveA.
[[nodiscard]] Branch branch_of(const DhJoint& row);

// Axes with |sin alpha| below this are made parallel.
//
// Making them parallel turns a tool by up to 2 |sin alpha|, and moves it as much per metre (worst
// half a turn of the joint away). Keeping them puts the common normal 1 / |sin alpha| metres away,
// where d and b are rounded: the pseudo Denavit-Hartenberg product is then wrong by up to about
// 3.4e-16 / |sin alpha| per metre. The costs meet here, at 2.6e-8 m per metre, and nowhere is the
// product worse; it is right to 1e-9 m below 5e-10 and from 4e-7 on. The link frames themselves
// (core/kinematics/s_model_chain.hpp) are right throughout.
inline constexpr double kParallelSine = 1.3e-8;

// Axes that are parallel and closer than this are one axis: beta = 0 and a = 0 instead of the
// direction of a rounding error.
inline constexpr double kCoaxialMetres = 1e-12;

// The parameters of B, all angles in (-pi, pi]. Parallel axes get alpha = 0 or pi and b = 0; the
// tilt that this drops is below kParallelSine.
[[nodiscard]] Parameters from_transform(const Pose& B, Branch branch);

// B of the parameters, (4).
[[nodiscard]] Pose to_transform(const Parameters& parameters);

// True where from_transform made the axes parallel.
[[nodiscard]] bool is_parallel(const Parameters& parameters);

}  // namespace armsig::s_model
