// SPDX-License-Identifier: MIT
// How a process of the fleet begins and ends: `NAME [--check] CONFIGURATION`, and a signal to stop.
#pragma once

#include <csignal>
#include <cstdio>
#include <exception>
#include <string_view>

namespace armsig::fleet {

inline constexpr int kWrongUsage = 2;

// Set by SIGTERM and SIGINT.
inline volatile std::sig_atomic_t stop_asked = 0;

// Reads the arguments, looks for the signals, and runs `run(configuration, check only)`, whose exit
// status is the program's.
inline int run_program(const char* name, const char* version, int argc, char** argv,
                       int (*run)(const char* path, bool check_only)) {
  const std::string_view first = argc > 1 ? argv[1] : "";
  if (first == "--version") {
    std::printf("%s %s\n", name, version);
    return 0;
  }
  const bool check = first == "--check";
  if (argc != (check ? 3 : 2) || (!check && first.starts_with('-'))) {
    std::fprintf(stderr, "%s [--check] CONFIGURATION\n", name);
    return first == "--help" ? 0 : kWrongUsage;
  }
  const auto ask = [](int) { stop_asked = 1; };
  std::signal(SIGTERM, ask);
  std::signal(SIGINT, ask);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return run(argv[argc - 1], check);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
}

}  // namespace armsig::fleet
