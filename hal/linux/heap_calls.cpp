// SPDX-License-Identifier: MIT
#include "hal/linux/heap_calls.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

namespace {

std::atomic<std::uint64_t> calls{0};
thread_local std::uint64_t calls_of_this_thread = 0;

void count() {
  calls.fetch_add(1, std::memory_order_relaxed);
  ++calls_of_this_thread;
}

}  // namespace

// GCC and clang say in different ways that a sanitizer is there.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ARMSIG_SANITIZED_HEAP
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define ARMSIG_SANITIZED_HEAP
#endif
#endif

#ifdef ARMSIG_SANITIZED_HEAP

// Of sanitizer/allocator_interface.h, which Debian does not install with g++.
// NOLINTNEXTLINE(bugprone-reserved-identifier): the sanitizer's name
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*on_allocation)(const volatile void*,
                                                                               std::size_t),
                                                         void (*on_release)(const volatile void*));

namespace {

// The sanitizer owns malloc and offers a hook instead.
void on_allocation(const volatile void* /*memory*/, std::size_t /*size*/) { count(); }
void on_release(const volatile void* /*memory*/) {}
const int installed = __sanitizer_install_malloc_and_free_hooks(&on_allocation, &on_release);

}  // namespace

#else

// Replacements for glibc's own, which stay reachable under their internal names.
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): glibc's names
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t items, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
// NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)

void* malloc(std::size_t size) {
  count();
  return __libc_malloc(size);
}
void* calloc(std::size_t items, std::size_t size) {
  count();
  return __libc_calloc(items, size);
}
void* realloc(void* memory, std::size_t size) {
  count();
  return __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  count();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  count();
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
}

#endif

namespace armsig::linux_hal {

std::uint64_t heap_calls() { return calls.load(std::memory_order_relaxed); }

std::uint64_t heap_calls_of_this_thread() { return calls_of_this_thread; }

}  // namespace armsig::linux_hal
