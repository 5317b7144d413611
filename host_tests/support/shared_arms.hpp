// SPDX-License-Identifier: MIT
// The arm descriptions of the shared data folder, which stand there under their own licences. A
// program that uses them skips its tests where the folder is absent.
#pragma once

#include <string>

#include "core/base/arm.hpp"

namespace armsig::test {

// arms/`name`.yaml.
[[nodiscard]] Arm shared_arm(const std::string& name);

}  // namespace armsig::test
