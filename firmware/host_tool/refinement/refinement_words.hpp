// SPDX-License-Identifier: MIT
// What the refinement found and why it refuses, in words.
#pragma once

#include <optional>
#include <string>

#include "core/refinement/reading_suspicion.hpp"
#include "core/refinement/refined.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

// "joint 6: rotation about its own axis is not determined by this target".
[[nodiscard]] std::string in_words(const refinement::Undetermined& open,
                                   const Signature& signature);

// Why a refinement of `file` was refused, and what is missing.
[[nodiscard]] Problem refinement_problem(const Refusal& refusal, const std::string& file);

// "joint 3 seems to follow joint 2, ...", for the end of a message.
[[nodiscard]] std::string in_words(const refinement::ReadingSuspicion& suspicion);

// What to put into the arm description.
[[nodiscard]] std::string remedy_for(const refinement::ReadingSuspicion& suspicion);

}  // namespace armsig::tool
