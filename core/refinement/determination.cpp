// SPDX-License-Identifier: MIT
#include "core/refinement/determination.hpp"

#include <algorithm>
#include <cmath>

#include "core/refinement/row.hpp"

namespace armsig::refinement {

namespace {

// A target that a moving joint moves by less than this (as a radius) is on its axis.
constexpr double kOnAxis_m = 0.02;
Open open_kind(const RowsAlone& alone, const Parameter& parameter) {
  // Targets and receivers are counted apart: only an axis is in the tables of the joints.
  const bool of_axis = parameter.kind == ParameterKind::kAxisDirection ||
                       parameter.kind == ParameterKind::kAxisPosition;
  const bool at_rest = of_axis && alone.motion[parameter.index] == 0;
  const bool on_axis = of_axis && alone.radius_m[parameter.index] < kOnAxis_m;
  switch (parameter.kind) {
    case ParameterKind::kAxisDirection:
      if (at_rest) return Open::kJointAtRest;
      return on_axis ? Open::kTargetOnAxis : Open::kAxisDirection;
    case ParameterKind::kAxisPosition:
      if (at_rest) return Open::kJointAtRest;
      return on_axis ? Open::kTargetOnAxis : Open::kAxisPosition;
    case ParameterKind::kReadingGain:
      return Open::kReadingGain;
    case ParameterKind::kReadingFirst:
      return Open::kReadingFirst;
    case ParameterKind::kReadingSecond:
      return Open::kReadingSecond;
    case ParameterKind::kReceiverOffset:
      return Open::kReceiverOffset;
    case ParameterKind::kTarget:
    case ParameterKind::kScale:  // never listed: an unknown scale is an error
      return Open::kTarget;
  }
  return Open::kTarget;
}

// 1 sigma of an unknown before any row [rad, m, 1]: far beyond what is built; of a scale, that of
// an air temperature wrong by 30 K.
double wide_sigma(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::kAxisDirection:
    case ParameterKind::kAxisPosition:
      return 0.1;
    case ParameterKind::kTarget:
      return 1;
    case ParameterKind::kReadingGain:
    case ParameterKind::kReadingFirst:
    case ParameterKind::kReadingSecond:
      return 0.01;
    case ParameterKind::kReceiverOffset:
    case ParameterKind::kScale:
      return 0.05;
  }
  return 1;
}

}  // namespace

std::string_view describe(Open open) {
  switch (open) {
    case Open::kJointAtRest:
      return "its axis is not determined, because the joint did not move";
    case Open::kTargetOnAxis:
      return "rotation about its own axis is not determined by this target";
    case Open::kAxisDirection:
      return "the direction of its axis is not determined";
    case Open::kAxisPosition:
      return "the position of its axis is not determined";
    case Open::kReadingGain:
      return "the gain of its reading is not determined";
    case Open::kReadingFirst:
      return "the error of its reading once a turn is not determined";
    case Open::kReadingSecond:
      return "the error of its reading twice a turn is not determined";
    case Open::kTarget:
      return "the position of the target is not determined";
    case Open::kReceiverOffset:
      return "the offset of its range is not determined";
  }
  return "is not determined";
}

void set_wide_priors(const Layout& layout, SquareRootFactor& information) {
  information.reset(layout.size());
  for (std::size_t i = 0; i < layout.size(); ++i) {
    information.set_entry(i, i, 1 / wide_sigma(layout.parameters[i].kind));
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
    if (sigma < kOpenShare * wide_sigma(parameter.kind)) continue;
    const Undetermined found{open_kind(alone, parameter), parameter.index};
    bool listed = false;
    for (const Undetermined& earlier : estimate.undetermined) {
      listed = listed || (earlier.open == found.open && earlier.index == found.index);
    }
    if (!listed) estimate.undetermined.push_back(found);
  }
}

}  // namespace armsig::refinement
