// SPDX-License-Identifier: MIT
// Table 3 of the paper for one arm: the grid-touching task with the ideal model and with the arm
// signature.
#pragma once

#include "core/evaluation/grid_touching.hpp"
#include "core/signature.hpp"

namespace armsig::evaluation {

struct Comparison {
  Indices ideal;           // through the drawing
  Indices with_signature;  // through the signature
  Grid grid;               // as touched; smaller than asked for where the arm has no room
};

// Improvement factors, ideal over with signature, in the order of Table 3: normal, perpendicular,
// radial, orientation. An index below half a step of the resolution counts as half a step.
[[nodiscard]] std::array<double, 4> improvement(const Comparison& comparison,
                                                const Resolution& resolution = {});

// The task on the arm `truth`. All three models stand in frames of their own; they are laid over
// each other by their joint axes. The tool is the signature's first target on its last link, and of
// the truth its own target of the same number, where it has one. Where the signature has no such
// target, the tool is the origin of the drawing's last frame. The drawing is told where the tool
// really is at the signature configuration, as an operator would teach it. `of_signature` and
// `of_truth` say how far their joints turn at a reading; those of a drawing turn as they read.
// Errors: kOutOfReach, kJointLimit, kNotConverged (a vertex that a model can't reach), kNotFinite.
// Preconditions: the same joint types in all three; limits for every joint of the drawing.
[[nodiscard]] Result<Comparison> compare(const Arm& drawing, const Signature& signature,
                                         const Signature& truth, const Grid& grid = {},
                                         const Turning& of_signature = {},
                                         const Turning& of_truth = {});

}  // namespace armsig::evaluation
