// SPDX-License-Identifier: MIT
// Where a test writes: a path that no other process has, for tests run beside each other.
#pragma once

#include <unistd.h>

#include <string>

#include <gtest/gtest.h>

namespace armsig::test {

inline std::string temporary(const std::string& name) {
  return testing::TempDir() + "armsig_" + std::to_string(::getpid()) + "_" + name;
}

}  // namespace armsig::test
