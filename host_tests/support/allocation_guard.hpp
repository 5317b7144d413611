// SPDX-License-Identifier: MIT
// Shows in a test that nothing is taken from the heap.
#pragma once

#include <cstdint>

#include "hal/linux/heap_calls.hpp"

namespace armsig::test {

// Counts the allocations of this thread since its construction. Use:
//   const AllocationGuard guard;
//   ... code under test ...
//   const std::uint64_t allocations = guard.count();   // before any assertion, which may allocate
class AllocationGuard {
 public:
  [[nodiscard]] std::uint64_t count() const {
    return linux_hal::heap_calls_of_this_thread() - before_;
  }

 private:
  std::uint64_t before_ = linux_hal::heap_calls_of_this_thread();
};

}  // namespace armsig::test
