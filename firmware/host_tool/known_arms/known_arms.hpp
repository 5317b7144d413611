// SPDX-License-Identifier: MIT
// Arm descriptions that come with the command: `--arm ur10e` instead of a file.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "firmware/formats/arm_file.hpp"

namespace armsig::tool {

struct KnownArm {
  std::string_view name;  // that --arm takes: lower case, no suffix
  std::string_view text;  // arm/1, its source in the comment before the first key
};

// In alphabetical order.
[[nodiscard]] std::span<const KnownArm> known_arms();

// Where the dimensions of `arm` come from: the comment before its first key, as one line.
[[nodiscard]] std::string source_of(const KnownArm& arm);

// The known arm called `name`, small or capital; null where there is none.
[[nodiscard]] const KnownArm* find_known_arm(std::string_view name);

// What to expect instead of a name that is not known: the one spelt most like it, or `otherwise`.
[[nodiscard]] std::string known_arm_like(std::string_view name, std::string_view otherwise);

// The arm description in the file `file_or_name`; where there is no such file, the known arm of
// that name, small or capital. Problems are those of read_arm_file(); of a name that is neither,
// with the known arm that is spelt most like it.
[[nodiscard]] Read<ArmDescription> read_arm(const std::string& file_or_name);

}  // namespace armsig::tool
