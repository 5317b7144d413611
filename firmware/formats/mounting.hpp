// SPDX-License-Identifier: MIT
// How an arm is bolted down, as files tell it, and what it comes too near to, in words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/clearance/clearance.hpp"
#include "firmware/formats/yaml_map.hpp"

namespace armsig::tool {

// Appends the keys `mounted`, `floor` and `link_radius` to those of a map.
void add_mounting_keys(std::vector<std::string>& known);

// `mounted: floor | ceiling | wall`, or `mounted: {gravity: [x, y, z]}`: which way gravity pulls in
// the base frame, of any length; floor and link radius with a unit. Absent: on the floor, at its
// mounting plane; the usual radius. Refuses a gravity of no length, and lengths below zero.
[[nodiscard]] Read<clearance::Mounting> read_mounting(const YamlMap& map);

// The lines that read_mounting() reads; none where all is by default.
[[nodiscard]] std::string mounting_text(const clearance::Mounting& mounting);

// The unit in which a file tells lengths.
struct LengthWords {
  std::string_view unit = "mm";
  double per_m = 1e3;
};

// "link 4 and the floor" of an arm of `joints`.
[[nodiscard]] std::string limit_in_words(const clearance::Room& room, std::size_t joints);

// "link 4 is 12 mm beyond the mounting plane; it ends at 300, 0, -12 mm of the base frame".
[[nodiscard]] std::string room_in_words(const clearance::Room& room, std::size_t joints,
                                        const LengthWords& words = {});

// What holds: "nothing below the mounting plane z = 0; links of 55 mm radius; ...".
[[nodiscard]] std::string surroundings_in_words(const clearance::Surroundings& around,
                                                const LengthWords& words = {});

}  // namespace armsig::tool
