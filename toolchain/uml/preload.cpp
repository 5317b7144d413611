// SPDX-License-Identifier: MIT
// Preloaded for linux.uml alone (toolchain/uml_can): takes the place of the C library's ptrace().
// The processes of the guest do not see it.
#include <dlfcn.h>

#include <cstdarg>

#include "toolchain/uml/xstate_overlay.hpp"

namespace {

// The C library's own, which gives the value of PTRACE_PEEK* back as its result.
long next(const armsig::uml::PtraceCall& call) {
  using Function = long (*)(int, pid_t, void*, void*);
  static const auto function = reinterpret_cast<Function>(::dlsym(RTLD_NEXT, "ptrace"));
  return function(call.request, call.process, call.address, call.data);
}

}  // namespace

extern "C" long ptrace(__ptrace_request request, ...) noexcept {
  std::va_list arguments;
  va_start(arguments, request);
  armsig::uml::PtraceCall call{.request = request};
  call.process = va_arg(arguments, pid_t);
  call.address = va_arg(arguments, void*);
  call.data = va_arg(arguments, void*);
  va_end(arguments);
  return armsig::uml::with_whole_xstate(call, next);
}
