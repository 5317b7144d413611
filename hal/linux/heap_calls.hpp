// SPDX-License-Identifier: MIT
// Counts what is taken from the heap, to show that nothing is. A library of its own,
// armsig_heap_calls: who links it gets counting stand-ins of malloc and its kin, which operator new
// and Eigen use too; shared libraries come here as well.
#pragma once

#include <cstdint>

namespace armsig::linux_hal {

// Calls of malloc, calloc, realloc and the aligned ones since the process, or the calling thread,
// began.
[[nodiscard]] std::uint64_t heap_calls();
[[nodiscard]] std::uint64_t heap_calls_of_this_thread();

}  // namespace armsig::linux_hal
