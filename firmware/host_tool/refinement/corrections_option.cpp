// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/corrections_option.hpp"

#include <utility>

#include <fmt/core.h>

namespace armsig::tool {

Read<FurtherUnknowns> parse_corrections(const std::vector<std::string>& words,
                                        std::string_view method, bool has_receivers) {
  const auto mistake = [](std::string what, std::string expected) {
    return std::unexpected(Problem{"--correct", 0, 0, std::move(what), std::move(expected)});
  };
  FurtherUnknowns further;
  if (words.empty()) return further;
  if (method == "encoder" || method == "paper") {
    return mistake(fmt::format("the method is {}", method),
                   "--method refined, which can find corrections");
  }
  for (const std::string& word : words) {
    further.readings.gain |= word == "gain";
    further.readings.first |= word == "first-order";
    further.readings.second |= word == "second-order";
    further.choose_readings |= word == "readings-that-help";
    further.receiver_offsets |= word == "range-offsets";
    further.scale |= word == "scale";
    further.as_read |= word == "none";
  }
  if (further.as_read && words.size() > 1) {
    return mistake("none, and corrections beside it", "either of them");
  }
  if (further.receiver_offsets && !has_receivers) {
    return mistake("range-offsets without receivers",
                   "ranges, and --sensor with where the receivers stand");
  }
  return further;
}

std::string corrections_in_words(const calibration::ReadingTerms& terms) {
  std::string words;
  const auto add = [&](bool term, std::string_view word) {
    if (term) words += fmt::format("{}{}", words.empty() ? "" : ",", word);
  };
  add(terms.gain, "gain");
  add(terms.first, "first-order");
  add(terms.second, "second-order");
  return words;
}

}  // namespace armsig::tool
