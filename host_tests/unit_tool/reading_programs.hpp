// SPDX-License-Identifier: MIT
// What the tests of the readers of robot programs have in common.
#pragma once

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "firmware/host_tool/programs/readers.hpp"

namespace armsig::tool {

// The flange as tool, the base as frame.
inline ProgramFrames flange() {
  ProgramFrames frames;
  EXPECT_TRUE(frames.tools.add("--tool", "0,0,0,0,0,0"));
  EXPECT_TRUE(frames.frames.add("--frame", "0,0,0,0,0,0"));
  return frames;
}

// `what` is said of the line.
inline ::testing::AssertionResult is_left(const Program& program, int line,
                                          const std::string& what) {
  std::string all;
  for (const LeftAsItIs& one : program.left) {
    if (one.line == line && one.what.find(what) != std::string::npos) {
      return ::testing::AssertionSuccess();
    }
    all += "\n" + std::to_string(one.line) + ": " + one.what;
  }
  return ::testing::AssertionFailure() << "line " << line << ": " << what << "; left:" << all;
}

// It is the only thing left.
inline void expect_left(const Program& program, int line, const std::string& what) {
  EXPECT_EQ(program.left.size(), 1U);
  EXPECT_TRUE(is_left(program, line, what));
}

// Nothing but this is left, and nothing is corrected.
inline void expect_none(const Program& program, int line, const std::string& what) {
  EXPECT_TRUE(program.targets.empty());
  expect_left(program, line, what);
}

}  // namespace armsig::tool
