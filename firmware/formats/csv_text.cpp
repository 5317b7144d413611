// SPDX-License-Identifier: MIT
#include "firmware/formats/csv_text.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "firmware/formats/characters.hpp"

namespace armsig::tool {

std::string joint_header(const JointTypes& types) {
  std::string header;
  for (std::size_t i = 0; i < types.size(); ++i) {
    header += fmt::format("{}q{}_{}", i == 0 ? "" : ",", i + 1,
                          types[i] == JointType::kRevolute ? "deg" : "mm");
  }
  return header;
}

std::string comment_text(std::string_view comment) {
  std::string text;
  while (!comment.empty()) {
    const std::size_t stop = std::min(comment.find('\n'), comment.size());
    text += fmt::format("# {}\n", shown(comment.substr(0, stop)));
    comment.remove_prefix(std::min(stop + 1, comment.size()));
  }
  return text;
}

}  // namespace armsig::tool
