// SPDX-License-Identifier: MIT
// The error of a call that must have failed. To ask an expected for its error when it holds a value
// is undefined: a test that did would pass or fail by what lies in memory.
#pragma once

#include <source_location>

#include <gtest/gtest.h>

namespace armsig::test {

// The error of `result`; where it holds a value instead, a failure of the test at the caller's
// line, and an empty error.
template <typename Expected>
[[nodiscard]] typename Expected::error_type failure_of(
    const Expected& result, const std::source_location caller = std::source_location::current()) {
  if (!result) return result.error();
  ADD_FAILURE_AT(caller.file_name(), static_cast<int>(caller.line())) << "did not fail";
  return {};
}

}  // namespace armsig::test
