// SPDX-License-Identifier: MIT
// Numbers and refusals of core in the words and units of a person.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/arm.hpp"
#include "core/base/error.hpp"
#include "core/base/tool_accuracy.hpp"

namespace armsig::tool {

// `1 pose`, `3 poses`: `what` is one of them.
[[nodiscard]] std::string counted(std::size_t count, std::string_view what);

// A joint reading: `12.345°` or `123.45 mm`.
[[nodiscard]] std::string reading_in_words(JointType type, double reading);

// What core refused, with the number found and the number needed.
[[nodiscard]] std::string refusal_in_words(const Refusal& refusal, JointType type);

// What the person can do about it.
[[nodiscard]] std::string remedy_in_words(Error error);

// `12, 17 to 20, 44`: the lines of a file, in rising order.
[[nodiscard]] std::string lines_in_words(const std::vector<std::size_t>& lines);

// `3 h 20 min`, `12 min 5 s`, `8 s`.
[[nodiscard]] std::string duration_in_words(double seconds);

// "the joint limits": a region of a predicted tool error.
[[nodiscard]] std::string region_in_words(PredictedRegion region);

}  // namespace armsig::tool
