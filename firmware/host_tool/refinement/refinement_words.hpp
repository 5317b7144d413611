// SPDX-License-Identifier: MIT
// What the refinement found and why it refuses, in words.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "core/calibration/refined.hpp"
#include "firmware/analysis/starts/reading_suspicion.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/host_tool/refinement/calibration_run.hpp"

namespace armsig::tool {

// "joints 3 to 7 stood still: ...". Precondition: `joints`, from 0, rise, and there is one.
[[nodiscard]] std::string still_in_words(std::span<const std::size_t> joints);

// "joint 6: rotation about its own axis is not determined by this target".
[[nodiscard]] std::string in_words(const calibration::Undetermined& open,
                                   const Signature& signature);

// Why a refinement of `file` was refused, and what is missing.
[[nodiscard]] Problem refinement_problem(const Refusal& refusal, const std::string& file);

// "joint 3 seems to follow joint 2, ...", for the end of a message.
[[nodiscard]] std::string in_words(const calibration::ReadingSuspicion& suspicion);

// "joint 5 follows joint 4 by +0.00500 ± 0.00004 of its reading, which the arm description does not
// say"; "with it rows left out are predicted to ..."; and what to write there.
[[nodiscard]] std::string in_words(const FoundCoupling& found);
// "geometry, gravity, joint error maps but of joint 6, backlash".
[[nodiscard]] std::string in_words(const TriedModel& model);
[[nodiscard]] std::string evidence_in_words(const FoundCoupling& found);
[[nodiscard]] std::string remedy_for(const FoundCoupling& found);

// What to put into the arm description.
[[nodiscard]] std::string remedy_for(const calibration::ReadingSuspicion& suspicion);

}  // namespace armsig::tool
