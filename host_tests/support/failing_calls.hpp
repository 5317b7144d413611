// SPDX-License-Identifier: MIT
// System calls of this program that fail on request: the nth that would have gone well, of those
// that this thread makes while they are counted. One file of a program includes this. What only
// looks (nothing to read, nobody to accept) is not counted.
#pragma once

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>

namespace armsig::test {

struct FailingCalls {
  bool counting = false;
  long failing = 0;  // counted from 1; 0: none
  long calls = 0;
  const char* failed = "none";  // the name of the call that did
};
inline thread_local FailingCalls failing_calls;

// Counts within its scope.
struct CountedCalls {
  CountedCalls() { failing_calls.counting = true; }
  ~CountedCalls() { failing_calls.counting = false; }
  CountedCalls(const CountedCalls&) = delete;
  CountedCalls& operator=(const CountedCalls&) = delete;
};

inline bool call_fails(const char* name, int number = EIO) {
  if (!failing_calls.counting || ++failing_calls.calls != failing_calls.failing) return false;
  failing_calls.failed = name;
  errno = number;
  return true;
}

template <typename Function>
Function* next_function(const char* name) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): what dlsym is for
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

// The call unless it is the one that fails.
template <typename Function, typename... Arguments>
auto call_or_fail(const char* name, Arguments... arguments) {
  if (call_fails(name)) return decltype(next_function<Function>(name)(arguments...))(-1);
  return next_function<Function>(name)(arguments...);
}

}  // namespace armsig::test

// NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): glibc's names
extern "C" {

int open(const char* path, int flags, ...) {
  mode_t mode = 0;
  if ((flags & (O_CREAT | O_TMPFILE)) != 0) {
    va_list rest;
    va_start(rest, flags);
    mode = va_arg(rest, mode_t);
    va_end(rest);
  }
  return armsig::test::call_or_fail<int(const char*, int, mode_t)>("open", path, flags, mode);
}
int mkostemp(char* path, int flags) {
  return armsig::test::call_or_fail<int(char*, int)>("mkostemp", path, flags);
}
ssize_t pread(int file, void* into, size_t size, off_t at) {
  return armsig::test::call_or_fail<ssize_t(int, void*, size_t, off_t)>("pread", file, into, size,
                                                                        at);
}
ssize_t __pread_chk(int file, void* into, size_t size, off_t at, size_t /*room*/) {
  return pread(file, into, size, at);
}
ssize_t pwrite(int file, const void* from, size_t size, off_t at) {
  return armsig::test::call_or_fail<ssize_t(int, const void*, size_t, off_t)>("pwrite", file, from,
                                                                              size, at);
}
int fdatasync(int file) { return armsig::test::call_or_fail<int(int)>("fdatasync", file); }
int fsync(int file) { return armsig::test::call_or_fail<int(int)>("fsync", file); }
int fstat(int file, struct stat* status) noexcept {
  return armsig::test::call_or_fail<int(int, struct stat*)>("fstat", file, status);
}
int stat(const char* path, struct stat* status) noexcept {
  return armsig::test::call_or_fail<int(const char*, struct stat*)>("stat", path, status);
}
int flock(int file, int how) noexcept {
  return armsig::test::call_or_fail<int(int, int)>("flock", file, how);
}
int fchmod(int file, mode_t mode) noexcept {
  return armsig::test::call_or_fail<int(int, mode_t)>("fchmod", file, mode);
}
int posix_fallocate(int file, off_t at, off_t size) {
  if (armsig::test::call_fails("posix_fallocate")) return ENOSPC;
  return armsig::test::next_function<int(int, off_t, off_t)>("posix_fallocate")(file, at, size);
}
int link(const char* from, const char* to) noexcept {
  return armsig::test::call_or_fail<int(const char*, const char*)>("link", from, to);
}
int socket(int domain, int type, int protocol) noexcept {
  return armsig::test::call_or_fail<int(int, int, int)>("socket", domain, type, protocol);
}
int bind(int file, const sockaddr* address, socklen_t size) noexcept {
  return armsig::test::call_or_fail<int(int, const sockaddr*, socklen_t)>("bind", file, address,
                                                                          size);
}
int listen(int file, int backlog) noexcept {
  return armsig::test::call_or_fail<int(int, int)>("listen", file, backlog);
}
ssize_t send(int file, const void* from, size_t size, int flags) {
  return armsig::test::call_or_fail<ssize_t(int, const void*, size_t, int)>("send", file, from,
                                                                            size, flags);
}
// What came is lost with the call, as on a connection that was reset.
ssize_t recv(int file, void* into, size_t size, int flags) {
  const ssize_t count = armsig::test::next_function<ssize_t(int, void*, size_t, int)>("recv")(
      file, into, size, flags);
  return count >= 0 && armsig::test::call_fails("recv", ECONNRESET) ? -1 : count;
}
ssize_t __recv_chk(int file, void* into, size_t size, size_t /*room*/, int flags) {
  return recv(file, into, size, flags);
}
int accept4(int file, sockaddr* address, socklen_t* size, int flags) {
  const int socket = armsig::test::next_function<int(int, sockaddr*, socklen_t*, int)>("accept4")(
      file, address, size, flags);
  if (socket < 0 || !armsig::test::call_fails("accept4", EMFILE)) return socket;
  ::close(socket);
  errno = EMFILE;
  return -1;
}

}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)
