// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/refinement_words.hpp"

#include <fmt/core.h>

#include "firmware/host_tool/refinement/corrections_option.hpp"

namespace armsig::tool {

std::string in_words(const calibration::Undetermined& open, const Signature& signature) {
  const std::string phrase(calibration::describe(open.open));
  switch (open.open) {
    case calibration::Open::kTarget:
      return fmt::format("target {}: {}", signature.targets[open.index].number, phrase);
    case calibration::Open::kReceiverOffset:
      return fmt::format("receiver {}: {}", open.index + 1, phrase);
    default:
      return fmt::format("joint {}: {}", open.index + 1, phrase);
  }
}

std::string still_in_words(std::span<const std::size_t> joints) {
  std::string numbers;
  for (std::size_t k = 0; k < joints.size();) {
    std::size_t last = k;
    while (last + 1 < joints.size() && joints[last + 1] == joints[last] + 1) ++last;
    if (last < k + 2) last = k;
    if (k > 0) numbers += last + 1 == joints.size() ? " and " : ", ";
    numbers += std::to_string(joints[k] + 1);
    if (last > k) numbers += fmt::format(" to {}", joints[last] + 1);
    k = last + 1;
  }
  const bool one = joints.size() == 1;
  return fmt::format(
      "{} {} stood still: nothing measured tells {} parameters, which stay nominal; the predicted "
      "tool error is for all readings of {}",
      one ? "joint" : "joints", numbers, one ? "its" : "their", one ? "it" : "them");
}

Problem refinement_problem(const Refusal& refusal, const std::string& file) {
  const auto problem = [&](std::string what, std::string expected) {
    return Problem{file, 0, 0, std::move(what), std::move(expected)};
  };
  switch (refusal.error) {
    case Error::kTooFewPoints:
      return problem(fmt::format("{:.0f} measured numbers, and the unknowns need {:.0f}",
                                 refusal.found, refusal.needed),
                     "more rows: a position counts three numbers, a range one");
    case Error::kJointDidNotMove:
      return problem("no joint moves: all poses are equal", "rows at different joint readings");
    case Error::kCoincidentPoints:
      return problem("the joints move, and every row has the target at the same place",
                     "a target that the arm carries");
    case Error::kNotConverged:
      return problem("no arm near the description explains the measurements",
                     "the description of this arm; check the zeros and senses of the joints, "
                     "coupled joints, and the order and units of the columns");
    case Error::kTooManyOutliers:
      return problem(fmt::format("{:.0f} rows contradict the others, at most {:.0f} may",
                                 refusal.found, refusal.needed),
                     "rows of one arm and one rigid target; check for multipath, sigma_mm and the "
                     "numbers of the targets");
    case Error::kScaleUndetermined:
      return problem(
          "the scale of the lengths is asked for, and nothing in these rows has a known "
          "length: angles alone do not tell it",
          "a prismatic joint, ranges to receivers at known places, or no scale in "
          "--correct");
    case Error::kCapacityExceeded:
      return problem(
          fmt::format("{:.0f} unknowns, and at most {:.0f} fit", refusal.found, refusal.needed),
          "fewer targets, or fewer corrections");
    default:
      return problem(std::string(describe(refusal.error)), "consistent measurements");
  }
}

std::string in_words(const calibration::ReadingSuspicion& suspicion) {
  const JointCoupling& coupling = suspicion.coupling;
  const std::string evidence =
      fmt::format("then base and tool fit to {:.1f} mm instead of {:.1f} mm", 1e3 * suspicion.rms_m,
                  1e3 * suspicion.plain_rms_m);
  if (suspicion.reversed()) {
    return fmt::format("joint {} seems to turn against the sense of its reading: {}",
                       coupling.joint + 1, evidence);
  }
  if (coupling.ratio == 0) {
    return fmt::format("joint {} does not seem to follow joint {}: {}", coupling.joint + 1,
                       coupling.from + 1, evidence);
  }
  return fmt::format("joint {} seems to follow joint {}, {:+.4g} times its reading: {}",
                     coupling.joint + 1, coupling.from + 1, coupling.ratio, evidence);
}

std::string in_words(const FoundCoupling& found) {
  const std::string instead = found.drawn_ratio == 0
                                  ? "which the arm description does not say"
                                  : fmt::format("and not by {:+.5f}", found.drawn_ratio);
  return fmt::format("joint {} follows joint {} by {:+.5f} ± {:.5f} of its reading, {}",
                     found.coupling.joint + 1, found.coupling.from + 1, found.coupling.ratio,
                     found.sigma, instead);
}

std::string in_words(const TriedModel& model) {
  std::string words = "geometry";
  const std::string readings = corrections_in_words(model.readings);
  if (!readings.empty()) words += fmt::format(", corrected by {}", readings);
  if (model.parts.gravity) words += ", gravity";
  if (model.other_vertical) words += " along the vertical of the rows";
  if (model.parts.maps) words += ", joint error maps";
  std::string without;
  for (std::size_t j = 0; model.parts.maps && j < kMaxJoints; ++j) {
    if ((model.parts.without_map >> j & 1U) == 0) continue;
    without += fmt::format("{}{}", without.empty() ? " but of joint " : ", ", j + 1);
  }
  words += without;
  if (model.backlash) words += ", backlash";
  if (model.coupling) {
    words += fmt::format(", joint {} coupled to joint {}", model.coupling->joint + 1,
                         model.coupling->from + 1);
  }
  return words;
}

std::string evidence_in_words(const FoundCoupling& found) {
  return fmt::format(
      "with it validation rows are predicted to {:.3f} mm instead of {:.3f} mm, and {} rows are "
      "rejected instead of {}",
      1e3 * found.left_out_mean_m, 1e3 * found.left_out_mean_without_m, found.rejected,
      found.rejected_without);
}

std::string remedy_for(const FoundCoupling& found) {
  return fmt::format(
      "in the arm description \"coupling: [{{joint: {}, from: {}, ratio: {:.5f}}}]\"",
      found.coupling.joint + 1, found.coupling.from + 1, found.coupling.ratio);
}

std::string remedy_for(const calibration::ReadingSuspicion& suspicion) {
  const JointCoupling& coupling = suspicion.coupling;
  if (suspicion.reversed()) {
    return fmt::format("the reading of joint {} with the other sign", coupling.joint + 1);
  }
  if (coupling.ratio == 0) return "the arm description without that coupling";
  return fmt::format(
      "in the arm description \"coupling: [{{joint: {}, from: {}, ratio: {:.4g}}}]\"",
      coupling.joint + 1, coupling.from + 1, coupling.ratio);
}

}  // namespace armsig::tool
