// SPDX-License-Identifier: MIT
// Why User-Mode Linux needs help on processors with a large extended state (AMX): the host takes
// PTRACE_SETREGSET of NT_X86_XSTATE only for a whole XSAVE area, 11 kB there, and Debian's binary
// hands over the 2.7 kB that it was built for.
#pragma once

#include <elf.h>
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/uio.h>

#include <array>
#include <cstddef>
#include <cstring>

namespace armsig::uml {

// What ptrace() is called with, and what it is, for a test to stand in.
struct PtraceCall {
  int request = 0;
  pid_t process = 0;
  void* address = nullptr;
  void* data = nullptr;
};
using Ptrace = long (*)(const PtraceCall& call);

// Larger than the XSAVE area of any processor there is.
inline constexpr std::size_t kLargestArea = std::size_t{64} * 1024;

// `call`, by `next`. Where it sets a part of an extended state, the whole one of the process is
// read, the part is laid over its beginning, and the whole is written back; every other call, and a
// part that is whole already, passes as it is.
inline long with_whole_xstate(const PtraceCall& call, Ptrace next) {
  const bool sets = call.request == PTRACE_SETREGSET &&
                    reinterpret_cast<std::size_t>(call.address) == NT_X86_XSTATE;
  if (!sets) return next(call);
  // Not on the stack: a kernel stack of User-Mode Linux is small, and it has one thread.
  alignas(64) static std::array<std::byte, kLargestArea> area;
  const iovec part = *static_cast<const iovec*>(call.data);
  iovec whole{.iov_base = area.data(), .iov_len = area.size()};
  const long read = next({PTRACE_GETREGSET, call.process, call.address, &whole});
  const bool partial = part.iov_len < whole.iov_len && whole.iov_len < area.size();
  if (read != 0 || !partial) return next(call);
  std::memcpy(area.data(), part.iov_base, part.iov_len);
  return next({PTRACE_SETREGSET, call.process, call.address, &whole});
}

}  // namespace armsig::uml
