// SPDX-License-Identifier: MIT
#include "firmware/analysis/starts/determination.hpp"

#include <algorithm>
#include <cmath>

#include "core/calibration/row.hpp"

namespace armsig::calibration {

namespace {

// A target that a moving joint moves by less than this (as a radius) is on its axis.
constexpr double kOnAxis_m = 0.02;

// What an unknown of each kind is when it is left open, and its 1 sigma before any row [rad, m, 1]:
// far beyond what is built; of a scale, that of an air temperature wrong by 30 K.
struct Unknown {
  Open open;  // of a scale none: an unknown scale is an error
  double wide_sigma;
};
const Unknown& unknown_of(ParameterKind kind) {
  static constexpr std::array<Unknown, 8> kUnknowns{{{Open::kAxisDirection, 0.1},
                                                     {Open::kAxisPosition, 0.1},
                                                     {Open::kReadingGain, 0.01},
                                                     {Open::kReadingFirst, 0.01},
                                                     {Open::kReadingSecond, 0.01},
                                                     {Open::kTarget, 1},
                                                     {Open::kReceiverOffset, 0.05},
                                                     {Open::kTarget, 0.05}}};
  return kUnknowns[static_cast<std::size_t>(kind)];
}

Open open_kind(const RowsAlone& alone, const Parameter& parameter) {
  // Targets and receivers are counted apart: only an axis is in the tables of the joints.
  if (parameter.kind == ParameterKind::kAxisDirection ||
      parameter.kind == ParameterKind::kAxisPosition) {
    if (alone.motion[parameter.index] == 0) return Open::kJointAtRest;
    if (alone.radius_m[parameter.index] < kOnAxis_m) return Open::kTargetOnAxis;
  }
  return unknown_of(parameter.kind).open;
}

}  // namespace

std::string_view describe(Open open) {
  static constexpr std::array<std::string_view, 9> kWords{
      "its axis is not determined, because the joint did not move",
      "rotation about its own axis is not determined by this target",
      "the direction of its axis is not determined",
      "the position of its axis is not determined",
      "the gain of its reading is not determined",
      "the error of its reading once a turn is not determined",
      "the error of its reading twice a turn is not determined",
      "the position of the target is not determined",
      "the offset of its range is not determined"};
  const auto number = static_cast<std::size_t>(open);
  return number < kWords.size() ? kWords[number] : "is not determined";
}

void set_wide_priors(const Layout& layout, SquareRootFactor& information) {
  information.reset(layout.size());
  for (std::size_t i = 0; i < layout.size(); ++i) {
    information.set_entry(i, i, 1 / unknown_of(layout.parameters[i].kind).wide_sigma);
  }
}

double parameter_sigma(const SquareRootFactor& information, std::size_t index) {
  StateVector unit{};
  unit[index] = 1;
  return std::sqrt(information.variance(unit, index));
}

void gather_rows(std::span<const Observation> log, std::span<const RowOutcome> outcomes,
                 const Receivers& receivers, double sigma_m, const Refined& estimate,
                 RowsAlone& alone) {
  ARMSIG_CHECK(outcomes.size() == log.size() && sigma_m > 0);
  alone.motion.fill(0);
  alone.radius_m.fill(0);
  set_wide_priors(estimate.layout, alone.information);
  const PoeChain chain(estimate.signature, estimate.readings);
  for (std::size_t k = 0; k < log.size(); ++k) {
    const Observation& row = log[k];
    if (row.use != RowUse::kFit || outcomes[k].rejected) continue;
    const Linearised at =
        absorb_row(estimate, receivers, chain, row, 1 / sigma_m, alone.information);
    for (std::size_t i = 0; i < estimate.signature.targets[row.target].link; ++i) {
      const double moved = at.motion.joints[i].moved;
      if (moved == 0) continue;
      alone.motion[i] = std::max(alone.motion[i], std::abs(moved));
      alone.radius_m[i] = std::max(alone.radius_m[i], at.jacobian.motion[i].norm());
    }
  }
}

void name_undetermined(const RowsAlone& alone, Refined& estimate) {
  estimate.undetermined.clear();
  for (std::size_t i = 0; i < estimate.layout.size(); ++i) {
    const Parameter& parameter = estimate.layout.parameters[i];
    if (parameter.kind == ParameterKind::kScale) continue;
    const double sigma = parameter_sigma(alone.information, i);
    if (sigma < kOpenShare * unknown_of(parameter.kind).wide_sigma) continue;
    const Undetermined found{open_kind(alone, parameter), parameter.index};
    // Unknowns of one joint and kind stand side by side.
    auto& open = estimate.undetermined;
    if (open.empty() || open.back() != found) open.push_back(found);
  }
}

}  // namespace armsig::calibration
