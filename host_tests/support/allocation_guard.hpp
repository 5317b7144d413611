// SPDX-License-Identifier: MIT
// Counts what is taken from the heap, so that a test can show that nothing is.
#pragma once

#include <cstddef>

namespace armsig::testing {

// Counts the allocations of this thread since its construction: malloc and its kin, and with them
// operator new. Use:
//   const AllocationGuard guard;
//   ... code under test ...
//   const std::size_t allocations = guard.count();   // before any assertion, which may allocate
class AllocationGuard {
 public:
  AllocationGuard();
  [[nodiscard]] std::size_t count() const;

 private:
  std::size_t before_;
};

}  // namespace armsig::testing
