// SPDX-License-Identifier: MIT
// Assertions for our own mistakes; they stay in release builds, where stopping is safer than a
// wrong pose.
#pragma once

// ARMSIG_CHECK(condition): traps when a precondition that the caller owes is broken.
#define ARMSIG_CHECK(condition)         \
  do {                                  \
    if (!(condition)) __builtin_trap(); \
  } while (false)
