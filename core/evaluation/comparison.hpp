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
// each other by their joint axes. The tool is the target `tool` of the signature; the truth's own
// target of the same number, where it has one; where the signature has no target on its last link,
// the origin of the drawing's last frame. The drawing is told where the tool really is at the
// signature configuration, as an operator would teach it. Errors: kOutOfReach, kJointLimit,
// kNotConverged (a vertex that a model can't reach), kNotFinite. Preconditions: the same joint
// types in all three; limits for every joint of the drawing. Signature and truth turn by their
// readings as told: a drawing knows of no map and no gravity.
[[nodiscard]] Result<Comparison> compare(const Arm& drawing, const Signature& signature,
                                         const Signature& truth, const Grid& grid = {},
                                         const Turning& of_signature = {},
                                         const Turning& of_truth = {});

}  // namespace armsig::evaluation
