// SPDX-License-Identifier: MIT
// Just enough of LinuxCNC's hardware abstraction layer to load its genserkins module into a test
// and call its forward function. Include once in an executable that exports its symbols: the module
// resolves the functions below against it.
#pragma once

#include <dlfcn.h>

#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <map>
#include <string>

namespace armsig::linuxcnc {

union Pin {
  double number = 0;
  std::int32_t whole;
};
struct Hal {
  std::map<std::string, Pin*> pins;
  std::deque<Pin> memory;  // the module keeps addresses into it

  int add(const std::string& name, void** data) {
    memory.emplace_back();
    *data = pins[name] = &memory.back();
    return 0;
  }
  int add(const char* format, std::va_list arguments, void** data) {
    std::array<char, 64> name{};
    // NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized): begun by the caller
    std::vsnprintf(name.data(), name.size(), format, arguments);
    return add(name.data(), data);
  }
};
inline Hal& hal() {
  static Hal the_hal;
  return the_hal;
}

// EmcPose: millimetres, and fixed-axis roll, pitch, yaw in degrees.
struct EmcPose {
  double x, y, z, a, b, c, u, v, w;
};
using Forward = int (*)(const double*, EmcPose*, const void*, void*);

// The forward function of the module that Debian's package linuxcnc-uspace installs, or that
// toolchain/setup takes out of it; null where neither is present.
inline Forward genserkins_forward() {
  static const Forward forward = [] {
    const char* home = std::getenv("HOME");
    const std::array<std::string, 2> places{
        "/usr/lib/linuxcnc/modules/genserkins.so",
        std::string(home != nullptr ? home : "") + "/.cache/armsig/genserkins.so"};
    for (const std::string& place : places) {
      if (!std::filesystem::exists(place)) continue;
      void* module = dlopen(place.c_str(), RTLD_NOW);
      if (module == nullptr) continue;
      const auto start = reinterpret_cast<int (*)()>(dlsym(module, "rtapi_app_main"));
      if (start == nullptr || start() != 0) continue;
      return reinterpret_cast<Forward>(dlsym(module, "kinematicsForward"));
    }
    return Forward{};
  }();
  return forward;
}

}  // namespace armsig::linuxcnc

extern "C" {
// NOLINTBEGIN(cert-dcl50-cpp): the interface is C's
inline constexpr int kArmsigComponent = 1;
[[gnu::used]] inline int hal_init(const char* /*name*/) { return kArmsigComponent; }
[[gnu::used]] inline int hal_exit(int /*component*/) { return 0; }
[[gnu::used]] inline int hal_ready(int /*component*/) { return 0; }
[[gnu::used]] inline void* hal_malloc(long size) {
  return std::calloc(1, static_cast<std::size_t>(size));
}
[[gnu::used]] inline int hal_pin_float_newf(int /*direction*/, void** data, int /*component*/,
                                            const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  const int status = armsig::linuxcnc::hal().add(format, arguments, data);
  va_end(arguments);
  return status;
}
[[gnu::used]] inline int hal_pin_s32_newf(int /*direction*/, void** data, int /*component*/,
                                          const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  const int status = armsig::linuxcnc::hal().add(format, arguments, data);
  va_end(arguments);
  return status;
}
[[gnu::used]] inline int hal_pin_u32_newf(int /*direction*/, void** data, int /*component*/,
                                          const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  const int status = armsig::linuxcnc::hal().add(format, arguments, data);
  va_end(arguments);
  return status;
}
[[gnu::used]] inline int hal_pin_bit_new(const char* name, int /*direction*/, void** data,
                                         int /*component*/) {
  return armsig::linuxcnc::hal().add(name, data);
}
[[gnu::used]] inline int hal_pin_s32_new(const char* name, int /*direction*/, void** data,
                                         int /*component*/) {
  return armsig::linuxcnc::hal().add(name, data);
}
[[gnu::used]] inline void rtapi_print(const char* /*format*/, ...) {}
[[gnu::used]] inline void rtapi_print_msg(int /*level*/, const char* /*format*/, ...) {}
// NOLINTEND(cert-dcl50-cpp)
}
