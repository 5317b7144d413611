// SPDX-License-Identifier: MIT
// Preloaded: the allocation with the number in ARMSIG_FAILING_ALLOCATION fails, counted from the
// first signal handler that the program installs, with which `armsig` begins; and how many there
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

}  // namespace

extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): glibc's names
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t items, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
// NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)

void* malloc(std::size_t size) { return fails() ? nullptr : __libc_malloc(size); }
void* calloc(std::size_t items, std::size_t size) {
  return fails() ? nullptr : __libc_calloc(items, size);
}
void* realloc(void* memory, std::size_t size) {
  return fails() ? nullptr : __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return fails() ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  *memory = fails() ? nullptr : __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}

int sigaction(int signal, const struct sigaction* action, struct sigaction* before) noexcept {
  using Sigaction = int (*)(int, const struct sigaction*, struct sigaction*);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): what dlsym is for
  static const auto next = reinterpret_cast<Sigaction>(::dlsym(RTLD_NEXT, "sigaction"));
  if (!counting.load()) {
    const char* number = std::getenv("ARMSIG_FAILING_ALLOCATION");
    failing = number == nullptr ? 0 : std::strtol(number, nullptr, 10);
    counting = true;
  }
  return next(signal, action, before);
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
