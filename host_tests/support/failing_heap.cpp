// SPDX-License-Identifier: MIT
// Preloaded: the allocation with the number in ARMSIG_FAILING_ALLOCATION fails, counted from the
// first signal handler that the program installs, with which ours begin; and how many there
// were is written to ARMSIG_COUNTED_ALLOCATIONS.
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace {

std::atomic<bool> counting{false};
std::atomic<long> calls{0};
long failing = 0;

bool fails() {
  if (!counting.load(std::memory_order_relaxed)) return false;
  if (calls.fetch_add(1, std::memory_order_relaxed) + 1 != failing) return false;
  errno = ENOMEM;
  return true;
}

template <typename Function>
Function* next(const char* name) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): what dlsym is for
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {
// A program that counts its allocations has a malloc() of its own, which calls these.
// NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): glibc's names
void* __libc_malloc(std::size_t size) {
  static const auto allocate = next<void*(std::size_t)>("__libc_malloc");
  return fails() ? nullptr : allocate(size);
}
void* __libc_calloc(std::size_t items, std::size_t size) {
  static const auto allocate = next<void*(std::size_t, std::size_t)>("__libc_calloc");
  return fails() ? nullptr : allocate(items, size);
}
void* __libc_realloc(void* memory, std::size_t size) {
  static const auto allocate = next<void*(void*, std::size_t)>("__libc_realloc");
  return fails() ? nullptr : allocate(memory, size);
}
void* __libc_memalign(std::size_t alignment, std::size_t size) {
  static const auto allocate = next<void*(std::size_t, std::size_t)>("__libc_memalign");
  return fails() ? nullptr : allocate(alignment, size);
}

void* malloc(std::size_t size) { return __libc_malloc(size); }
void* calloc(std::size_t items, std::size_t size) { return __libc_calloc(items, size); }
void* realloc(void* memory, std::size_t size) { return __libc_realloc(memory, size); }
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
// NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)

int sigaction(int signal, const struct sigaction* action, struct sigaction* before) noexcept {
  static const auto install =
      next<int(int, const struct sigaction*, struct sigaction*)>("sigaction");
  if (!counting.load()) {
    const char* number = std::getenv("ARMSIG_FAILING_ALLOCATION");
    failing = number == nullptr ? 0 : std::strtol(number, nullptr, 10);
    counting = true;
  }
  return install(signal, action, before);
}
}

namespace {

// NOLINTNEXTLINE(cert-err58-cpp): nothing in it throws
const struct Teller {
  ~Teller() {
    counting = false;
    const char* path = std::getenv("ARMSIG_COUNTED_ALLOCATIONS");
    if (path == nullptr) return;
    const int file = ::open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    char text[24];
    const int length = std::snprintf(text, sizeof text, "%ld\n", calls.load());
    (void)!::write(file, text, static_cast<std::size_t>(length));
    (void)::close(file);
  }
} kTeller;

}  // namespace
