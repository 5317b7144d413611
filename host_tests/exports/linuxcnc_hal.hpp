// SPDX-License-Identifier: MIT
// Just enough of LinuxCNC's hardware abstraction layer to load a kinematics module into a test and
// call its functions. Include once in an executable that exports its symbols: the module
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
  std::string printed;     // by rtapi_print_msg

  int add(const std::string& name, void** data) {
    memory.emplace_back();
    *data = pins[name] = &memory.back();
    return 0;
  }
  [[gnu::format(printf, 2, 0)]] int add(const char* format, std::va_list arguments, void** data) {
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
using Inverse = int (*)(const EmcPose*, double*, const void*, void*);

struct Module {
  int started = -1;  // what its rtapi_app_main said
  Forward forward = nullptr;
  Inverse inverse = nullptr;
};

// Sets parameters as `loadrt MODULE NAME=TEXT` does, and starts it. Null functions where there is
// no such file.
inline Module load_module(const std::string& path,
                          const std::map<std::string, const char*>& parameters = {}) {
  Module module;
  void* file =
      std::filesystem::exists(path) ? dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL) : nullptr;
  if (file == nullptr) return module;
  for (const auto& [name, text] : parameters) {
    void* address = dlsym(file, ("rtapi_info_address_" + name).c_str());
    *static_cast<const char**>(*static_cast<void**>(address)) = text;
  }
  module.started = reinterpret_cast<int (*)()>(dlsym(file, "rtapi_app_main"))();
  module.forward = reinterpret_cast<Forward>(dlsym(file, "kinematicsForward"));
  module.inverse = reinterpret_cast<Inverse>(dlsym(file, "kinematicsInverse"));
  return module;
}

// The module that Debian's package linuxcnc-uspace installs, or that toolchain/setup unpacks; null
// functions where neither is present.
inline const Module& genserkins() {
  static const Module module = [] {
    const std::string file = "/usr/lib/linuxcnc/modules/genserkins.so";
    const char* home = std::getenv("HOME");
    const std::string unpacked =
        std::string(home != nullptr ? home : "") + "/.cache/armsig/linuxcnc";
    return load_module(std::filesystem::exists(file) ? file : unpacked + file);
  }();
  return module;
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
// Of every type the same: C gives each a name, and no way to hand on what follows the format.
#define ARMSIG_PIN_NEWF(type)                                                       \
  [[gnu::used, gnu::format(printf, 4, 5)]] inline int hal_pin_##type##_newf(        \
      int /*direction*/, void** data, int /*component*/, const char* format, ...) { \
    std::va_list arguments;                                                         \
    va_start(arguments, format);                                                    \
    const int status = armsig::linuxcnc::hal().add(format, arguments, data);        \
    va_end(arguments);                                                              \
    return status;                                                                  \
  }
ARMSIG_PIN_NEWF(float)
ARMSIG_PIN_NEWF(s32)
ARMSIG_PIN_NEWF(u32)
ARMSIG_PIN_NEWF(bit)
#undef ARMSIG_PIN_NEWF
[[gnu::used]] inline int hal_pin_bit_new(const char* name, int /*direction*/, void** data,
                                         int /*component*/) {
  return armsig::linuxcnc::hal().add(name, data);
}
[[gnu::used]] inline int hal_pin_s32_new(const char* name, int /*direction*/, void** data,
                                         int /*component*/) {
  return armsig::linuxcnc::hal().add(name, data);
}
[[gnu::used]] inline void rtapi_print(const char* /*format*/, ...) {}
[[gnu::used, gnu::format(printf, 2, 3)]] inline void rtapi_print_msg(int /*level*/,
                                                                     const char* format, ...) {
  std::array<char, 256> text{};
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text.data(), text.size(), format, arguments);
  va_end(arguments);
  armsig::linuxcnc::hal().printed += text.data();
}
// NOLINTEND(cert-dcl50-cpp)
}
