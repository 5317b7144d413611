// SPDX-License-Identifier: MIT
#include "host_tests/support/allocation_guard.hpp"

#include <cerrno>
#include <cstdlib>

namespace {

thread_local std::size_t allocations = 0;

}  // namespace

#if defined(__SANITIZE_ADDRESS__)

// Of sanitizer/allocator_interface.h, which Debian does not install with g++.
// NOLINTNEXTLINE(bugprone-reserved-identifier): the sanitizer's name
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*on_allocation)(const volatile void*,
                                                                               std::size_t),
                                                         void (*on_release)(const volatile void*));

namespace {

// The sanitizer owns malloc and offers a hook instead.
void on_allocation(const volatile void* /*memory*/, std::size_t /*size*/) { ++allocations; }
void on_release(const volatile void* /*memory*/) {}
const int installed = __sanitizer_install_malloc_and_free_hooks(&on_allocation, &on_release);

}  // namespace

#else

// Replacements for glibc's own, which stay reachable under their internal names; operator new and
// Eigen come here too.
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): glibc's names
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
// NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  ++allocations;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
}

#endif

namespace armsig::testing {

AllocationGuard::AllocationGuard() : before_(allocations) {}

std::size_t AllocationGuard::count() const { return allocations - before_; }

}  // namespace armsig::testing
